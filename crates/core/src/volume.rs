//! Volumes in which grains are made, appear or leave.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Simple volume; lengths in [m].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Volume {
    /// Box along the axes.
    Box {
        /// Lower corner.
        min: Vector3<f64>,
        /// Upper corner.
        max: Vector3<f64>,
    },
    /// Cylinder.
    Cylinder {
        /// Centre of the lower end.
        base: Vector3<f64>,
        /// Unit vector from the lower to the upper end.
        axis: Vector3<f64>,
        /// Radius.
        radius: f64,
        /// Length along the axis.
        length: f64,
    },
}

impl Volume {
    /// Lower and upper corner of the box around the volume [m].
    #[must_use]
    pub fn bounds(&self) -> [Vector3<f64>; 2] {
        match self {
            Self::Box { min, max } => [*min, *max],
            Self::Cylinder { base, axis, radius, length } => {
                let top = base + axis * *length;
                // A disc reaches R √(1 − a²) along each coordinate.
                let disc = axis.map(|a| radius * (1.0 - a * a).max(0.0).sqrt());
                [base.inf(&top) - disc, base.sup(&top) + disc]
            }
        }
    }

    /// Size [m³].
    #[must_use]
    pub fn size(&self) -> f64 {
        match self {
            Self::Box { min, max } => (max - min).product(),
            Self::Cylinder { radius, length, .. } => PI * radius * radius * length,
        }
    }

    /// Largest radius of a sphere that fits into it [m].
    #[must_use]
    pub fn inner_radius(&self) -> f64 {
        match self {
            Self::Box { min, max } => 0.5 * (max - min).min(),
            Self::Cylinder { radius, length, .. } => radius.min(0.5 * length),
        }
    }

    /// Whether a sphere of a radius [m], 0 for a point, lies in it as a whole.
    #[must_use]
    pub fn holds(&self, centre: &Vector3<f64>, inset: f64) -> bool {
        match self {
            Self::Box { min, max } => {
                (0..3).all(|a| centre[a] - inset >= min[a] && centre[a] + inset <= max[a])
            }
            Self::Cylinder { base, axis, radius, length } => {
                let along = (centre - base).dot(axis);
                let across = (centre - base - axis * along).norm();
                along >= inset && along + inset <= *length && across + inset <= *radius
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tilted_cylinder_has_its_size_bounds_and_points() {
        let axis = Vector3::new(0.6, 0.0, 0.8);
        let tube = Volume::Cylinder { base: Vector3::zeros(), axis, radius: 0.5, length: 2.0 };
        assert!((tube.size() - PI * 0.5).abs() < 1e-15 && tube.inner_radius() == 0.5);
        let [low, high] = tube.bounds();
        assert!((low - Vector3::new(-0.4, -0.5, -0.3)).norm() < 1e-15);
        assert!((high - Vector3::new(1.6, 0.5, 1.9)).norm() < 1e-15);
        let across = Vector3::new(0.8, 0.0, -0.6);
        assert!(tube.holds(&(axis + across * 0.499), 0.0) && !tube.holds(&(axis + across * 0.501), 0.0));
        assert!(tube.holds(&(axis * 1.9), 0.09) && !tube.holds(&(axis * 1.9), 0.11));
    }
}
