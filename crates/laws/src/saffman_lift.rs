//! Saffman lift in a shear flow: F = 1.615 d² √(ρμ/|ω|) (w × ω) times Mei's factor.
//!
//! F force on the grain [N]; w = u − v velocity of the fluid less that of the grain [m/s]; ω = ∇ × u
//! vorticity of the fluid [1/s]; d diameter [m]; ρ density [kg/m³]; μ viscosity [Pa·s]. With Re = ρ d |w|/μ
//! and γ = d|ω|/(2|w|), Mei's factor is
//!
//! ```text
//! Re ≤ 40: (1 − 0.3314 √γ) exp(−Re/10) + 0.3314 √γ
//! Re > 40: 0.0524 √(γ Re)
//! ```
//!
//! Range: 0.005 < γ < 0.4, Re < 100.
//! Source: Saffman, J. Fluid Mech. 22, 385 (1965) and 31, 624 (1968); Mei, Int. J. Multiphase Flow 18, 145
//! (1992).
//!
//! ```
//! use amberfield_laws::saffman_lift::force;
//! use nalgebra::Vector3;
//! // u = (γz, 0, 0) has ω = (0, γ, 0); a grain that lags behind is lifted towards the faster fluid.
//! let f = force(Vector3::x(), Vector3::y(), 1e-3, 1.2, 1.8e-5);
//! assert!(f.z > 0.0 && f.x == 0.0);
//! ```

use nalgebra::Vector3;

/// Reynolds number at which Mei's factor changes its form.
const REYNOLDS: f64 = 40.0;

/// Lift force F [N] on a grain; zero without slip or vorticity.
///
/// `slip` = w [m/s], `vorticity` = ω [1/s], diameter [m], density [kg/m³], viscosity [Pa·s].
#[must_use]
pub fn force(
    slip: Vector3<f64>,
    vorticity: Vector3<f64>,
    diameter: f64,
    density: f64,
    viscosity: f64,
) -> Vector3<f64> {
    let (speed, rotation) = (slip.norm(), vorticity.norm());
    // Both stand in denominators, though the force vanishes with either.
    if speed == 0.0 || rotation == 0.0 {
        return Vector3::zeros();
    }

    let reynolds = density * diameter * speed / viscosity;
    let saffman = 1.615 * diameter * diameter * (density * viscosity / rotation).sqrt();
    slip.cross(&vorticity) * (saffman * factor(reynolds, 0.5 * diameter * rotation / speed))
}

/// Mei's factor for a Reynolds number Re and a dimensionless shear rate γ.
#[must_use]
pub fn factor(reynolds: f64, shear: f64) -> f64 {
    if reynolds > REYNOLDS {
        return 0.0524 * (shear * reynolds).sqrt();
    }
    let root = 0.3314 * shear.sqrt();
    (1.0 - root) * (-0.1 * reynolds).exp() + root
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn saffman_is_the_limit_of_mei() {
        assert!((factor(1e-12, 0.1) - 1.0).abs() < 1e-12);
        // The branches differ at Re = 40, as published.
        assert!((factor(REYNOLDS, 0.1) / factor(REYNOLDS * (1.0 + 1e-12), 0.1) - 1.0).abs() < 0.16);
    }

    #[test]
    fn across_slip_and_vorticity_and_odd_in_both() {
        let (w, omega) = (Vector3::new(0.1, 0.2, 0.0), Vector3::new(0.0, 3.0, 4.0));
        let f = force(w, omega, 1e-3, 1.2, 1.8e-5);
        assert!(f.dot(&w).abs() < 1e-20 && f.dot(&omega).abs() < 1e-18);
        assert_eq!(force(-w, omega, 1e-3, 1.2, 1.8e-5), -f);
        assert_eq!(force(w, -omega, 1e-3, 1.2, 1.8e-5), -f);
        assert_eq!(force(w, Vector3::zeros(), 1e-3, 1.2, 1.8e-5), Vector3::zeros());
    }

    #[test]
    fn lagging_grain_is_lifted_towards_the_faster_fluid() {
        // u = (γz, 0, 0): ω = (0, γ, 0). A grain slower than the fluid, w = +x, is lifted towards +z.
        let f = force(Vector3::x(), Vector3::new(0.0, 1.0, 0.0), 1e-3, 1.2, 1.8e-5);
        assert!(f.z > 0.0 && f.x == 0.0 && f.y == 0.0);
    }
}
