//! Magnus lift of a spinning grain: F = (π/8) ρ d³ (Ω − ω/2) × (v − u).
//!
//! F force on the grain [N]; Ω angular velocity of the grain [rad/s]; ω = ∇ × u vorticity of the fluid [1/s];
//! v − u velocity of the grain relative to the fluid [m/s]; d diameter [m]; ρ density of the fluid [kg/m³].
//! Range: Re of order 1 and below.
//! Source: Rubinow & Keller, J. Fluid Mech. 11, 447 (1961), F = πa³ρ Ω × V.
//!
//! ```
//! use amberfield_laws::magnus_lift::force;
//! use nalgebra::Vector3;
//! // A ball with backspin rises.
//! let f = force(Vector3::x(), Vector3::new(0.0, -1.0, 0.0), Vector3::zeros(), 0.1, 1.2);
//! assert!(f.z > 0.0);
//! ```

use nalgebra::Vector3;
use std::f64::consts::PI;

/// Lift force F [N] on a grain.
///
/// `relative` = v − u [m/s], `spin` = Ω [rad/s], `vorticity` = ω [1/s], diameter [m], density [kg/m³].
#[must_use]
pub fn force(
    relative: Vector3<f64>,
    spin: Vector3<f64>,
    vorticity: Vector3<f64>,
    diameter: f64,
    density: f64,
) -> Vector3<f64> {
    (spin - 0.5 * vorticity).cross(&relative) * (PI / 8.0 * density * diameter.powi(3))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_point() {
        let f = force(Vector3::x(), Vector3::z(), Vector3::zeros(), 2.0, 1.0 / PI);
        assert!((f - Vector3::y()).norm() < 1e-15);
    }

    #[test]
    fn grain_that_turns_with_the_fluid_feels_none() {
        let omega = Vector3::new(1.0, 2.0, 3.0);
        assert_eq!(force(Vector3::x(), 0.5 * omega, omega, 1e-3, 1.2), Vector3::zeros());
    }
}
