//! The permittivity of a medium.

use crate::constants::VACUUM_PERMITTIVITY;
use serde::{Deserialize, Serialize};

/// Permittivity ε = ε₀ εr of a medium, so that ε [F/m] and εr are never taken for each other.
///
/// It is stored, and written to files, as the number εr.
///
/// ```
/// use amberfield_core::Permittivity;
///
/// let glass = Permittivity::from_relative(5.0);
/// assert_eq!(glass.relative(), 5.0);
/// assert_eq!(glass.absolute(), 5.0 * Permittivity::VACUUM.absolute());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Permittivity {
    relative: f64,
}

impl Permittivity {
    /// Permittivity of vacuum, ε₀.
    pub const VACUUM: Self = Self::from_relative(1.0);

    /// Makes a permittivity of εr, which is 1 in vacuum.
    #[must_use]
    pub const fn from_relative(relative: f64) -> Self {
        Self { relative }
    }

    /// Relative permittivity εr; 1 in vacuum.
    #[must_use]
    pub const fn relative(self) -> f64 {
        self.relative
    }

    /// Absolute permittivity ε = ε₀ εr [F/m].
    #[must_use]
    pub fn absolute(self) -> f64 {
        VACUUM_PERMITTIVITY * self.relative
    }

    /// Coulomb's constant 1/(4πε) of the medium [V·m/C].
    ///
    /// ```
    /// let k = amberfield_core::Permittivity::VACUUM.coulomb();
    /// assert!((k - 8.987_551_792e9).abs() < 10.0);
    /// ```
    #[must_use]
    pub fn coulomb(self) -> f64 {
        1.0 / (4.0 * std::f64::consts::PI * VACUUM_PERMITTIVITY * self.relative)
    }
}

impl Default for Permittivity {
    fn default() -> Self {
        Self::VACUUM
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn absolute_permittivity_and_coulomb_constant_belong_together() {
        for relative in [1.0, 2.5, 80.0] {
            let medium = Permittivity::from_relative(relative);
            let product = 4.0 * std::f64::consts::PI * medium.absolute() * medium.coulomb();
            assert!((product - 1.0).abs() < 4.0 * f64::EPSILON, "{product}");
        }
    }
}
