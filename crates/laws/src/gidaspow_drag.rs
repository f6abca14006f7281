//! Drag in a bed, by Ergun below a void fraction of 0.8 and by Wen and Yu above: F = β (u − v).
//!
//! ```text
//! ε < 0.8: β = V [150 (1 − ε) μ/(ε d²) + 1.75 ρ|w|/d]
//! ε ≥ 0.8: β = V (3/4) C_d ε ρ|w| ε^{−2.65}/d, C_d |w| from Schiller and Naumann at ε Re
//! ```
//!
//! The force on one grain is F = β (u − v) [N], beside the force of the pressure gradient (model A). β
//! coefficient [kg/s]; V = πd³/6 volume of the grain [m³]; ε void fraction; w = u − v velocity of the fluid
//! less that of the grain [m/s]; d diameter of the grain [m]; ρ density [kg/m³] and μ viscosity [Pa·s] of the
//! fluid. The two forms differ at ε = 0.8, as published. In a fixed bed the first form gives Ergun's pressure
//! drop, ∇p ε = −β (1 − ε) U/(V ε).
//! Range: beds of spheres.
//! Source: Gidaspow, *Multiphase Flow and Fluidization*, Academic Press, 1994, §2; Ergun, Chem. Eng. Prog.
//! 48, 89 (1952); Wen & Yu, Chem. Eng. Prog. Symp. Ser. 62, 100 (1966).
//!
//! ```
//! use amberfield_laws::{gidaspow_drag, particle_reynolds::Slip, stokes_drag};
//! let slip = Slip { speed: 0.0, void_fraction: 1.0, diameter: 1e-4, density: 1.2, viscosity: 1.8e-5 };
//! let over_stokes = gidaspow_drag::coefficient(&slip) / stokes_drag::coefficient(1e-4, 1.8e-5);
//! assert!((over_stokes - 1.0).abs() < 1e-12);
//! ```

use crate::particle_reynolds::Slip;
use crate::schiller_naumann_drag;
use std::f64::consts::PI;

/// Void fraction above which grains count as dispersed, no longer as a bed.
const DILUTE: f64 = 0.8;

/// Drag coefficient β [kg/s] of one grain.
#[must_use]
pub fn coefficient(slip: &Slip) -> f64 {
    if slip.void_fraction < DILUTE { ergun(slip) } else { wen_yu(slip) }
}

/// Drag coefficient β [kg/s] by Ergun, for dense beds.
fn ergun(slip: &Slip) -> f64 {
    let Slip { speed, void_fraction, diameter, density, viscosity } = *slip;
    let viscous = 150.0 * (1.0 - void_fraction) * viscosity / (void_fraction * diameter * diameter);
    let inertial = 1.75 * density * speed / diameter;
    PI / 6.0 * diameter.powi(3) * (viscous + inertial)
}

/// Drag coefficient β [kg/s] by Wen and Yu, for dispersed grains.
fn wen_yu(slip: &Slip) -> f64 {
    let Slip { void_fraction, diameter, viscosity, .. } = *slip;
    // (3/4) C_d ε ρ|w|/d = 18 μ f/d² with C_d = 24 f/(ε Re): no division by |w|, so finite at rest.
    let factor = schiller_naumann_drag::factor(slip.superficial_reynolds());
    PI / 6.0 * diameter * 18.0 * viscosity * factor * void_fraction.powf(-2.65)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_bed_has_ergun_pressure_drop() {
        let (u, eps, d, rho, mu) = (0.3_f64, 0.45_f64, 2e-3_f64, 1.2, 1.8e-5);
        let slip = Slip { speed: u / eps, void_fraction: eps, diameter: d, density: rho, viscosity: mu };
        // Model A: ε dp/dx = −β n w, n = (1 − ε)/V grains per volume.
        let grains = (1.0 - eps) / (PI / 6.0 * d.powi(3));
        let drop = coefficient(&slip) * grains * slip.speed / eps;
        let ergun = 150.0 * mu * (1.0 - eps).powi(2) * u / (eps.powi(3) * d * d)
            + 1.75 * rho * (1.0 - eps) * u * u / (eps.powi(3) * d);
        assert!((drop / ergun - 1.0).abs() < 1e-12, "{drop} {ergun}");
    }

    #[test]
    fn branches_are_those_of_their_void_fractions() {
        let slip = |void_fraction| Slip {
            speed: 0.5,
            void_fraction,
            diameter: 1e-3,
            density: 1.2,
            viscosity: 1.8e-5,
        };
        assert_eq!(coefficient(&slip(0.79)), ergun(&slip(0.79)));
        assert_eq!(coefficient(&slip(0.81)), wen_yu(&slip(0.81)));
        let alone = schiller_naumann_drag::coefficient(&slip(1.0));
        assert!((coefficient(&slip(1.0)) / alone - 1.0).abs() < 1e-12);
    }
}
