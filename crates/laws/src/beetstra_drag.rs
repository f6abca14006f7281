//! Drag in dense beds from lattice-Boltzmann simulations: β = 3πμd ε F(ε, Re), Re = ρ d ε|w|/μ.
//!
//! ```text
//! F(ε, Re) = 10(1−ε)/ε² + ε²(1 + 1.5√(1−ε))
//!          + (0.413 Re/(24 ε²)) (1/ε + 3ε(1−ε) + 8.4 Re^{−0.343})/(1 + 10^{3(1−ε)} Re^{−(1+4(1−ε))/2})
//! ```
//!
//! The force on one grain is F = β (u − v) [N], beside the force of the pressure gradient (model A). β drag
//! coefficient [kg/s]; ε void fraction; w = u − v velocity of the fluid less that of the grain [m/s]; d
//! diameter of the grain [m]; ρ density [kg/m³] and μ viscosity [Pa·s] of the fluid.
//! Range: Re < 1000, grains of one size.
//! Source: Beetstra, van der Hoef & Kuipers, AIChE J. 53, 489 (2007).
//!
//! ```
//! use amberfield_laws::beetstra_drag::factor;
//! assert!((factor(0.5, 0.0) - 20.515).abs() < 1e-3);
//! ```

use crate::particle_reynolds::Slip;
use crate::stokes_drag;

/// Drag coefficient β [kg/s] of one grain.
#[must_use]
pub fn coefficient(slip: &Slip) -> f64 {
    let stokes = stokes_drag::coefficient(slip.diameter, slip.viscosity);
    stokes * slip.void_fraction * factor(slip.void_fraction, slip.superficial_reynolds())
}

/// Factor F of void fraction ε and superficial Reynolds number Re: the drag over 3πμd ε|w|.
#[must_use]
pub fn factor(void_fraction: f64, reynolds: f64) -> f64 {
    let (eps, solid) = (void_fraction, 1.0 - void_fraction);
    let creeping = 10.0 * solid / (eps * eps) + eps * eps * (1.0 + 1.5 * solid.sqrt());
    // Re^{−0.343} is infinite at rest, though the inertial term vanishes there.
    if reynolds == 0.0 {
        return creeping;
    }

    let shape = 1.0 / eps + 3.0 * eps * solid + 8.4 * reynolds.powf(-0.343);
    let damped = 1.0 + 10_f64.powf(3.0 * solid) * reynolds.powf(-0.5 * (1.0 + 4.0 * solid));
    creeping + 0.413 * reynolds / (24.0 * eps * eps) * shape / damped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stokes_is_the_limit() {
        assert_eq!(factor(1.0, 0.0), 1.0);
        assert!((factor(1.0, 1e-9) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn near_the_kozeny_carman_limit_in_dense_beds() {
        // 10 (1 − ε)/ε² is 180 (1 − ε)/(18 ε²): Carman's constant 180.
        let eps = 0.4_f64;
        let carman = 180.0 * (1.0 - eps) / (18.0 * eps * eps);
        assert!((factor(eps, 0.0) / carman - 1.0).abs() < 0.01);
    }

    #[test]
    fn grows_with_reynolds_and_with_solids() {
        for eps in [0.4, 0.6, 0.9] {
            let steps = [0.0, 0.1, 1.0, 10.0, 100.0, 1000.0];
            assert!(steps.windows(2).all(|pair| factor(eps, pair[0]) < factor(eps, pair[1])), "{eps}");
        }
        assert!(factor(0.4, 10.0) > factor(0.6, 10.0));
    }
}
