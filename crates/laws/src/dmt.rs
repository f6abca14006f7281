//! Adhesion of Derjaguin, Muller and Toporov: F = (4/3) Y*√R* δ^{3/2} − F_c, F_c = 2π w R*, while δ > 0.
//!
//! δ overlap [m]; Y* effective modulus [Pa]; R* effective radius (at a wall that of the grain) [m]; w work of
//! adhesion [J/m²], see [`crate::work_of_adhesion`]; F_c pull-off force [N]. F > 0 pushes the bodies apart.
//! The contact has Hertz's radius √(R*δ); making and breaking it at δ = 0 costs nothing.
//! Range: small, hard grains, μ_T = (R* w²/(Y*² z₀³))^{1/3} ≪ 1 with z₀ a distance of atoms (Tabor's number).
//! Source: Derjaguin, Muller & Toporov, J. Colloid Interface Sci. 53, 314 (1975); Maugis, J. Colloid
//! Interface Sci. 150, 243 (1992).
//!
//! ```
//! use amberfield_laws::dmt::pull_off;
//! assert!((pull_off(0.1_f64, 5e-5) - 3.1416e-5).abs() < 1e-9);
//! ```

use std::f64::consts::PI;

use nalgebra::SimdRealField;

/// Pull-off force F_c = 2π w R* [N] of a work of adhesion [J/m²] and an effective radius [m].
#[inline(always)]
#[must_use]
pub fn pull_off<T: SimdRealField<Element = f64> + Copy>(work: T, radius: T) -> T {
    work * radius * T::splat(2.0 * PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hertz_mindlin;

    #[test]
    fn zero_load_is_where_hertz_bears_the_pull() {
        let (work, radius, young) = (0.05, 5e-5_f64, 1e7);
        // δ₀ = (3 F_c/(4 Y* √R*))^{2/3}
        let overlap = (0.75 * pull_off(work, radius) / (young * radius.sqrt())).powf(2.0 / 3.0);
        let load = hertz_mindlin::normal_force(young, radius, overlap) - pull_off(work, radius);
        assert!(load.abs() < 1e-13 * pull_off(work, radius));
    }

    #[test]
    fn pull_is_linear_in_work_and_radius() {
        assert!((pull_off(0.1_f64, 2e-5) / pull_off(0.05, 1e-5) - 4.0).abs() < 1e-14);
        assert_eq!(pull_off(0.0, 1.0), 0.0);
    }
}
