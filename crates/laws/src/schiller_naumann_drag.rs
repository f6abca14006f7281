//! Drag on a single sphere: β = 3πμd f, f = 1 + 0.15 Re^0.687 up to Re = 1000, then f = 0.44 Re/24.
//!
//! The force on one grain is F = β (u − v) [N]; the void fraction plays no part. β coefficient [kg/s]; f
//! factor of the drag over that of Stokes, C_d = 24 f/Re; d diameter of the grain [m]; μ viscosity of the
//! fluid [Pa·s]; Re Reynolds number of the grain.
//! Range: Re < 3·10⁵; at Re = 1000 the two branches differ by 0.8 %, as published.
//! Source: Schiller & Naumann, Z. Ver. Dtsch. Ing. 77, 318 (1933), as in Crowe et al.,
//! *Multiphase Flows with Droplets and Particles*, 2nd ed., §4.
//!
//! ```
//! use amberfield_laws::schiller_naumann_drag::factor;
//! assert!((factor(100.0) - 4.549).abs() < 1e-3);
//! ```

use crate::particle_reynolds::Slip;
use crate::stokes_drag;

/// Reynolds number above which C_d is constant (Newton's regime).
const NEWTON: f64 = 1000.0;

/// Drag coefficient β [kg/s] of one grain.
#[must_use]
pub fn coefficient(slip: &Slip) -> f64 {
    stokes_drag::coefficient(slip.diameter, slip.viscosity) * factor(slip.reynolds())
}

/// Factor f for a Reynolds number: the drag over that of Stokes.
#[must_use]
pub fn factor(reynolds: f64) -> f64 {
    if reynolds < NEWTON { 1.0 + 0.15 * reynolds.powf(0.687) } else { 0.44 / 24.0 * reynolds }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stokes_is_the_limit() {
        assert!((factor(1e-9) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn branches_meet_as_well_as_published() {
        assert!((factor(NEWTON * (1.0 - 1e-12)) / factor(NEWTON) - 1.0).abs() < 8e-3);
        // C_d = 24 f/Re of a sphere at Re = 100: 1.09, as in standard drag curves.
        assert!((24.0 * factor(100.0) / 100.0 - 1.09).abs() < 5e-3);
    }

    #[test]
    fn grows_with_reynolds() {
        let steps = [0.1, 1.0, 10.0, 100.0, 999.0, 1e4];
        assert!(steps.windows(2).all(|pair| factor(pair[0]) < factor(pair[1])));
    }
}
