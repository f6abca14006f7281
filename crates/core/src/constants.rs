//! Physical constants, CODATA 2018 (Tiesinga et al., Rev. Mod. Phys. 93, 025010, 2021).

/// Vacuum electric permittivity ε₀ [F/m].
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_812_8e-12;

/// Elementary charge e [C], exact since 2019.
pub const ELEMENTARY_CHARGE: f64 = 1.602_176_634e-19;

/// Coulomb's constant 1/(4πε₀εr) [V·m/C] in a medium of the given relative permittivity.
///
/// ```
/// let k = amberfield_core::constants::coulomb_constant(1.0);
/// assert!((k - 8.987_551_792e9).abs() < 10.0);
/// ```
#[must_use]
pub fn coulomb_constant(relative_permittivity: f64) -> f64 {
    1.0 / (4.0 * std::f64::consts::PI * VACUUM_PERMITTIVITY * relative_permittivity)
}
