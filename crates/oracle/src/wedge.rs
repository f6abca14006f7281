//! Point charge between two grounded half planes that meet in an edge at any angle β.
//!
//! In cylindrical coordinates about the edge, the faces at φ = 0 and φ = β, the charge at (r', φ', z'):
//!
//! V = q/(4πε) 1/(β √(2rr')) ∫_η^∞ [F(φ − φ') − F(φ + φ')] dζ/√(cosh ζ − cosh η),
//! F(ψ) = sinh(πζ/β)/(cosh(πζ/β) − cos(πψ/β)),  cosh η = (r² + r'² + (z − z')²)/(2rr').
//!
//! Source: Landau & Lifshitz, Electrodynamics of Continuous Media, 2nd ed., §3 (Macdonald, 1895).

use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Upper end of the integral over s = √(ζ − η), beyond which the integrand is below 1e-14, and its intervals.
const END: f64 = 8.0;
const INTERVALS: u32 = 4000;

/// Half planes at potential zero that meet in the z axis, the first at y = 0, x > 0; 4πε = 1.
#[derive(Clone, Copy, Debug)]
pub struct GroundedWedge {
    /// Angle between the faces, in which the charges are [rad].
    pub angle: f64,
}

impl GroundedWedge {
    /// E at a point between the faces of unit charges at places, without a charge's own field at its place,
    /// by central differences of fourth order.
    #[must_use]
    pub fn field(&self, point: &Vector3<f64>, charges: &[Vector3<f64>]) -> Vector3<f64> {
        charges.iter().map(|charge| self.field_of(point, charge)).sum()
    }

    fn field_of(&self, point: &Vector3<f64>, charge: &Vector3<f64>) -> Vector3<f64> {
        let step = 0.1 * self.depth(point).min(self.depth(charge));
        let induced = Vector3::from_fn(|axis, _| {
            let at = |steps: f64| self.induced(&(point + Vector3::ith(axis, steps * step)), charge);
            (8.0 * (at(-1.0) - at(1.0)) - (at(-2.0) - at(2.0))) / (12.0 * step)
        });
        let apart = point - charge;
        let distance = apart.norm();
        let own = if distance > 0.0 { apart / distance.powi(3) } else { Vector3::zeros() };
        induced + own
    }

    fn angle_of(point: &Vector3<f64>) -> f64 {
        let angle = point.y.atan2(point.x);
        if angle < 0.0 { angle + TAU } else { angle }
    }

    /// Distance of a point from the nearer face.
    fn depth(&self, point: &Vector3<f64>) -> f64 {
        let angle = Self::angle_of(point);
        let nearer = angle.min(self.angle - angle).min(FRAC_PI_2);
        point.x.hypot(point.y) * nearer.sin()
    }

    /// Potential at a point, less that of the unit charge alone.
    fn induced(&self, point: &Vector3<f64>, charge: &Vector3<f64>) -> f64 {
        let (r, own) = (point.x.hypot(point.y), charge.x.hypot(charge.y));
        let (here, there) = (Self::angle_of(point), Self::angle_of(charge));
        let apart = (r - own).powi(2) + (point.z - charge.z).powi(2);
        let eta = 2.0 * (apart / (4.0 * r * own)).sqrt().asinh();
        let order = PI / self.angle;
        let integrand = |s: f64| {
            let zeta = eta + s * s;
            let part = |psi: f64| 1.0 / (1.0 - (order * psi).cos() / (order * zeta).cosh());
            let kernel = (order * zeta).tanh() * (part(here - there) - part(here + there));
            // cosh ζ − cosh η without cancellation.
            let root = (2.0 * (eta + 0.5 * s * s).sinh() * (0.5 * s * s).sinh()).sqrt();
            if s > 0.0 { kernel * 2.0 * s / root } else { kernel * 2.0 / eta.sinh().sqrt() }
        };
        // Simpson's rule.
        let step = END / f64::from(INTERVALS);
        let inner: f64 = (1..INTERVALS)
            .map(|place| f64::from(2 + 2 * (place % 2)) * integrand(f64::from(place) * step))
            .sum();
        let whole = (integrand(0.0) + inner + integrand(END)) * step / 3.0;
        whole / (self.angle * (2.0 * r * own).sqrt()) - 1.0 / (point - charge).norm()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_corner_has_three_images() {
        let wedge = GroundedWedge { angle: FRAC_PI_2 };
        let charge = Vector3::new(1.0, 0.5, 0.0);
        let images = [(-1.0, [1.0, -0.5]), (-1.0, [-1.0, 0.5]), (1.0, [-1.0, -0.5])];
        for point in [charge, Vector3::new(0.4, 0.7, 0.6)] {
            let of_image = |(sign, [x, y]): &(f64, [f64; 2])| {
                let apart = point - Vector3::new(*x, *y, 0.0);
                *sign * apart / apart.norm().powi(3)
            };
            let apart: Vector3<f64> = point - charge;
            let own = if apart.norm() > 0.0 { apart / apart.norm().powi(3) } else { Vector3::zeros() };
            let exact = images.iter().map(of_image).sum::<Vector3<f64>>() + own;
            let found = wedge.field(&point, &[charge]);
            assert!((found - exact).norm() < 2e-3 * exact.norm(), "{found} {exact}");
        }
    }

    #[test]
    fn half_plane_is_sommerfelds() {
        let wedge = GroundedWedge { angle: TAU };
        let half = crate::GroundedHalfPlane { charge: 1.0, at: Vector3::new(0.6, 0.0, -0.3) };
        // The half plane x = 0, z < 0 is the wedge's y = 0, x > 0.
        let turned = |v: &Vector3<f64>| Vector3::new(-v.z, v.x, v.y);
        for point in [half.at, Vector3::new(-0.5, 0.3, 0.4)] {
            let found = wedge.field(&turned(&point), &[turned(&half.at)]);
            let exact = turned(&half.field(&point));
            assert!((found - exact).norm() < 3e-3 * exact.norm(), "{found} {exact}");
        }
    }
}
