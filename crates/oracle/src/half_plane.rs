//! Point charge beside a grounded half plane without thickness.
//!
//! In cylindrical coordinates about the rim, the half plane at φ = 0 and 2π, the charge at (r', φ', z'):
//!
//! V = q/(4πε) (1/π) [ arccos(−cos((φ − φ')/2)/cosh(η/2))/R − arccos(−cos((φ + φ')/2)/cosh(η/2))/R* ],
//!
//! cosh η = (r² + r'² + (z − z')²)/(2 r r'), R and R* the distances to the charge and to its mirror image.
//! Source: Landau & Lifshitz, Electrodynamics of Continuous Media, 2nd ed., §3, problem 11 (Sommerfeld,
//! 1897).

use nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// Half plane x = 0, z < 0 at potential zero, and a charge beside it; 4πε = 1.
#[derive(Clone, Copy, Debug)]
pub struct GroundedHalfPlane {
    /// Charge.
    pub charge: f64,
    /// Position of the charge.
    pub at: Vector3<f64>,
}

impl GroundedHalfPlane {
    /// Angle about the rim from the face x > 0 of the half plane, from 0 to 2π.
    fn angle(point: &Vector3<f64>) -> f64 {
        let angle = point.x.atan2(-point.z);
        if angle < 0.0 { angle + TAU } else { angle }
    }

    /// One of the two terms: the angle between, and the distance to the charge or its image.
    fn term(&self, point: &Vector3<f64>, half_angle: f64, distance: f64) -> f64 {
        let (r, own) = (point.x.hypot(point.z), self.at.x.hypot(self.at.z));
        let cosh = (r * r + own * own + (point.y - self.at.y).powi(2)) / (2.0 * r * own);
        let half_cosh = (0.5 * (cosh + 1.0)).sqrt();
        (-half_angle.cos() / half_cosh).clamp(-1.0, 1.0).acos() / (PI * distance)
    }

    /// Potential at a point off the charge, less the charge's own.
    fn induced(&self, point: &Vector3<f64>) -> f64 {
        let image = Vector3::new(-self.at.x, self.at.y, self.at.z);
        let (here, there) = (Self::angle(point), Self::angle(&self.at));
        let distance = (point - self.at).norm();
        let direct = self.term(point, 0.5 * (here - there), distance) - 1.0 / distance;
        let mirrored = self.term(point, 0.5 * (here + there), (point - image).norm());
        self.charge * (direct - mirrored)
    }

    /// E at a point, without the charge's own field there, by central differences of fourth order.
    #[must_use]
    pub fn field(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let from_plate = |at: &Vector3<f64>| if at.z < 0.0 { at.x.abs() } else { at.x.hypot(at.z) };
        let step = 1e-2 * from_plate(point).min(from_plate(&self.at));
        let induced = Vector3::from_fn(|axis, _| {
            let at = |steps: f64| self.induced(&(point + Vector3::ith(axis, steps * step)));
            (8.0 * (at(-1.0) - at(1.0)) - (at(-2.0) - at(2.0))) / (12.0 * step)
        });
        let apart = point - self.at;
        let distance = apart.norm();
        let own = if distance > 0.0 { self.charge * apart / distance.powi(3) } else { Vector3::zeros() };
        induced + own
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn far_from_the_rim_it_is_a_grounded_plane() {
        let half = GroundedHalfPlane { charge: 2.0, at: Vector3::new(1.0, 0.0, -500.0) };
        let e = half.field(&half.at);
        assert!((e - Vector3::new(-0.5, 0.0, 0.0)).norm() < 1e-4, "{e}");
        let behind = half.field(&Vector3::new(-1.0, 0.0, -500.0));
        assert!(behind.norm() < 1e-4, "{behind}");
    }

    #[test]
    fn the_field_stands_on_the_plate() {
        let half = GroundedHalfPlane { charge: 1.0, at: Vector3::new(0.3, 0.1, -0.2) };
        for at in [Vector3::new(1e-9, 0.2, -0.5), Vector3::new(-1e-9, -0.3, -0.1)] {
            let potential = half.induced(&at) + 1.0 / (at - half.at).norm();
            assert!(potential.abs() < 1e-7, "{potential}");
        }
    }
}
