//! Field of a point charge: E = q r̂/(4πεr²), V = q/(4πεr).
//!
//! q charge [C]; r distance [m], r > 0; r̂ unit vector from the charge to the point; ε = ε₀εr permittivity
//! [F/m]. E [V/m] points away from positive charge. The functions take k = 1/(4πε) [V·m/C]
//! (`amberfield_core::Permittivity::coulomb`), so that a sum over charges multiplies by it once.
//! Range: any r > 0; the caller skips the charge itself by its index.
//! Source: Jackson, *Classical Electrodynamics*, 3rd ed., §1.2.
//!
//! ```
//! use amberfield_core::{Permittivity, Vector3};
//! use amberfield_laws::point_charge::{field, potential};
//! let k = Permittivity::VACUUM.coulomb();
//! let e = field(k, 1e-9, Vector3::new(0.0, 0.0, 2.0));
//! assert!((e.z - k * 1e-9 / 4.0).abs() < 1e-12);
//! assert!((potential(k, 1e-9, 2.0) - 2.0 * e.z).abs() < 1e-12);
//! ```

use nalgebra::Vector3;

/// Field E [V/m] of a charge [C] at `offset` = point − charge [m], with k = 1/(4πε) [V·m/C].
#[inline]
#[must_use]
pub fn field(coulomb_constant: f64, charge: f64, offset: Vector3<f64>) -> Vector3<f64> {
    let r2 = offset.norm_squared();
    offset * (coulomb_constant * charge / (r2 * r2.sqrt()))
}

/// Potential V [V] of a charge [C] at a distance r [m], with k = 1/(4πε) [V·m/C].
#[inline]
#[must_use]
pub fn potential(coulomb_constant: f64, charge: f64, distance: f64) -> f64 {
    coulomb_constant * charge / distance
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-14;
    /// Error of a central difference with step 1e-5 of the distance: truncation 1e-10.
    const DIFFERENCE: f64 = 1e-8;

    #[test]
    fn exact_point() {
        let e = field(2.0, 3.0, Vector3::new(3.0, 0.0, 4.0));
        assert!((e - Vector3::new(3.0, 0.0, 4.0) * (6.0 / 125.0)).norm() < ROUND_OFF);
        assert!((potential(2.0, 3.0, 5.0) - 1.2).abs() < ROUND_OFF);
    }

    #[test]
    fn field_is_minus_gradient_of_potential() {
        let (r, h) = (1.7, 1.7e-5);
        let slope = (potential(1.0, 1.0, r + h) - potential(1.0, 1.0, r - h)) / (2.0 * h);
        let e = field(1.0, 1.0, Vector3::new(r, 0.0, 0.0)).x;
        assert!((e + slope).abs() < DIFFERENCE * e);
    }

    #[test]
    fn reversing_offset_or_charge_reverses_the_field() {
        let x = Vector3::new(0.3, -0.2, 0.9);
        assert_eq!(field(1.0, 1.0, x), -field(1.0, 1.0, -x));
        assert_eq!(field(1.0, 1.0, x), -field(1.0, -1.0, x));
    }

    #[test]
    fn vanishes_far_away() {
        assert!(field(1.0, 1.0, Vector3::new(1e9, 0.0, 0.0)).x <= 1e-17);
    }
}
