//! Physical constants, CODATA 2018 (Tiesinga et al., Rev. Mod. Phys. 93, 025010, 2021).

/// Vacuum electric permittivity ε₀ [F/m].
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_812_8e-12;

/// Elementary charge e [C], exact since 2019.
pub const ELEMENTARY_CHARGE: f64 = 1.602_176_634e-19;
