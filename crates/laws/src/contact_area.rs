//! Area of a Hertz contact, A = πR*δ, and its correction for stiffness,
//! σ_A = (Y*_soft/Y*_real)^{2/5} (v_real/v_soft)^{4/5}.
//!
//! R* effective radius (at a wall that of the grain) [m]; δ overlap [m]; Y* effective moduli [Pa]; v impact
//! velocities [m/s]. Simulated grains are soft to allow long steps, so that they overlap too much: the
//! largest overlap of an impact, and with it the area, goes as (v²/Y*)^{2/5}. σ_A A is the area of the real,
//! stiffer contact.
//! Range: σ_A is derived for impacts; a contact at rest, whose overlap goes as Y*^{−2/3}, is corrected by the
//! same factor.
//! Source: Johnson, *Contact Mechanics* (1985), ch. 4, for the area; the correction as in J. Kolehmainen et
//! al., AIChE J. 63, 1872 (2017), with the exponent 4/5 of the velocity.
//!
//! ```
//! use amberfield_laws::contact_area::{correction, hertz};
//! assert!((hertz(5e-4, 1e-6) - 1.5708e-9).abs() < 1e-13);
//! assert!((correction(1e6, 1e11, 1.0) - 0.01).abs() < 1e-12);
//! ```

use std::f64::consts::PI;

/// Contact area A [m²] for an effective radius R* [m] and an overlap δ [m].
#[inline(always)]
#[must_use]
pub fn hertz(effective_radius: f64, overlap: f64) -> f64 {
    PI * effective_radius * overlap
}

/// Area correction σ_A for the simulated (`soft`) and the real effective modulus Y* [Pa] and the ratio
/// v_real/v_soft.
#[must_use]
pub fn correction(soft: f64, real: f64, velocity_ratio: f64) -> f64 {
    (soft / real).powf(0.4) * velocity_ratio.powf(0.8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corrected_area_of_an_impact_does_not_depend_on_the_modulus() {
        // δ_max ∝ (v²/Y*)^{2/5}.
        let area = |young: f64| hertz(1.0, (0.1_f64.powi(2) / young).powf(0.4)) * correction(young, 1e9, 1.0);
        assert!((area(1e5) / area(1e9) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn same_contact_is_not_corrected_and_faster_impacts_are_larger() {
        assert_eq!(correction(1e7, 1e7, 1.0), 1.0);
        assert!((correction(1e7, 1e7, 4.0) - 4.0_f64.powf(0.8)).abs() < 1e-14);
        assert_eq!(hertz(1e-3, 0.0), 0.0);
    }
}
