//! Dielectric breakdown as a limit on charge transfer: |E_c·n − αT/ε| ≤ max(E_bd, |E_c·n|).
//!
//! E_c·n field at the contact along n_ij before the transfer [V/m]; T charge moved from i to j [C], which
//! lowers the field by αT/ε (α from [`crate::charge_transfer`] [1/m²], ε permittivity [F/m]); E_bd breakdown
//! field [V/m], 3 MV/m in air. A transfer that would raise the field beyond E_bd ends where the bound is
//! reached; where the field is beyond the bound already, only transfers that lower it are left.
//! Range: a limit on charging, not a model of the discharge itself.
//! Source: S. Matsusaka, H. Maruyama, T. Matsuyama & M. Ghadiri, Chem. Eng. Sci. 65, 5781 (2010), §2.
//!
//! ```
//! use amberfield_laws::dielectric_breakdown::bounded;
//! // Relief is free, and a charge that would overshoot to the other side ends at −3 MV/m.
//! assert_eq!(bounded(1.0, 2e6, 1.0, 3e6), 1.0);
//! assert_eq!(bounded(9e6, 2e6, 1.0, 3e6), 5e6);
//! ```

/// Transfer [C] that breakdown leaves of a transfer T [C].
///
/// `normal_field` = E_c·n [V/m], `field_per_charge` = α/ε [V/(m·C)], `breakdown` = E_bd [V/m].
#[must_use]
pub fn bounded(transfer: f64, normal_field: f64, field_per_charge: f64, breakdown: f64) -> f64 {
    let most = breakdown.max(normal_field.abs());
    transfer.clamp((normal_field - most) / field_per_charge, (normal_field + most) / field_per_charge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bound_holds_and_what_is_below_it_is_free() {
        for field in [-9.0, -3.0, -1.0, 0.0, 2.0, 5.0] {
            for transfer in [-20.0, -1.0, 0.0, 0.5, 30.0] {
                let left = bounded(transfer, field, 0.5, 3.0);
                let after: f64 = field - 0.5 * left;
                assert!(after.abs() <= f64::max(3.0, field.abs()) + 1e-14);
                assert!(left == 0.0 || left.signum() == transfer.signum());
                if (field - 0.5 * transfer).abs() < 3.0 {
                    assert_eq!(left, transfer);
                }
            }
        }
    }

    #[test]
    fn beyond_the_bound_only_relief_is_left() {
        assert_eq!(bounded(-1.0, 5.0, 1.0, 3.0), 0.0);
        assert_eq!(bounded(1.0, 5.0, 1.0, 3.0), 1.0);
        assert_eq!(bounded(1.0, 5.0, 1.0, 0.0), bounded(1.0, 5.0, 1.0, 5.0));
    }
}
