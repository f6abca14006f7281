//! Drag in a suspension: β = (π/8) C_d ρ d² |w| ε^{2−χ}.
//!
//! C_d = (0.63 + 4.8/√(ε Re))² drag coefficient; χ = 3.7 − 0.65 exp(−(1.5 − log₁₀(ε Re))²/2) exponent of the
//! voidage function.
//!
//! The force on one grain is F = β (u − v) [N], beside the force of the pressure gradient (model A). β
//! coefficient [kg/s]; ε void fraction; w = u − v velocity of the fluid less that of the grain [m/s]; d
//! diameter of the grain [m]; ρ density of the fluid [kg/m³]; Re Reynolds number of the grain.
//! Range: any ε and Re of sedimentation and fluidisation.
//! Source: Di Felice, Int. J. Multiphase Flow 20, 153 (1994), with C_d of Dalla Valle, *Micromeritics*
//! (1948).
//!
//! ```
//! use amberfield_laws::{di_felice_drag, particle_reynolds::Slip, stokes_drag};
//! let slip = Slip { speed: 1e-7, void_fraction: 1.0, diameter: 1e-4, density: 1.2, viscosity: 1.8e-5 };
//! let over_stokes = di_felice_drag::coefficient(&slip) / stokes_drag::coefficient(1e-4, 1.8e-5);
//! assert!((over_stokes - 0.96).abs() < 1e-3);
//! ```

use crate::particle_reynolds::Slip;
use std::f64::consts::PI;

/// Drag coefficient β [kg/s] of one grain.
#[must_use]
pub fn coefficient(slip: &Slip) -> f64 {
    // C_d |w| is written without a division by |w|: finite at rest.
    let reynolds = slip.superficial_reynolds();
    let root = (slip.void_fraction * slip.density * slip.diameter / slip.viscosity).sqrt();
    let resistance = (0.63 * slip.speed.sqrt() + 4.8 / root).powi(2);
    let voidage = slip.void_fraction.powf(2.0 - exponent(reynolds));
    PI / 8.0 * resistance * slip.density * slip.diameter * slip.diameter * voidage
}

/// Exponent χ of the voidage function for a superficial Reynolds number ε Re; 3.7 at rest.
#[must_use]
pub fn exponent(reynolds: f64) -> f64 {
    3.7 - 0.65 * (-0.5 * (1.5 - reynolds.log10()).powi(2)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slip(speed: f64, void_fraction: f64) -> Slip {
        Slip { speed, void_fraction, diameter: 1e-3, density: 1.2, viscosity: 1.8e-5 }
    }

    #[test]
    fn exponent_has_its_limits_and_its_least() {
        assert_eq!(exponent(0.0), 3.7);
        assert!((exponent(10_f64.powf(1.5)) - 3.05).abs() < 1e-14);
        assert!((exponent(1e12) - 3.7).abs() < 1e-14);
    }

    #[test]
    fn alone_it_is_dalla_valle_drag() {
        let slip = slip(2.0, 1.0);
        let drag = (0.63 + 4.8 / slip.reynolds().sqrt()).powi(2);
        let expected = PI / 8.0 * drag * 1.2 * 1e-6 * 2.0;
        assert!((coefficient(&slip) / expected - 1.0).abs() < 1e-14);
    }

    #[test]
    fn finite_at_rest_and_dense_beds_resist_more() {
        let rest = coefficient(&slip(0.0, 0.4));
        assert!(rest.is_finite() && (coefficient(&slip(1e-12, 0.4)) / rest - 1.0).abs() < 1e-5);
        assert!(coefficient(&slip(1.0, 0.4)) > coefficient(&slip(1.0, 0.8)));
    }
}
