//! Bound on the electric force: |F_E| ≤ f · m · skin/Δt².
//!
//! F_E electric force [N]; f factor in [0, 1]; m mass [kg]; skin of the neighbour list [m]; Δt step [s].
//! A force at the bound moves a grain from rest by f·skin/2 in one step, so that no pair is missed by the
//! list. Longer forces are shortened, their direction kept. Source: the `limit_field_force` option of the
//! scene contract.
//!
//! ```
//! use amberfield_core::Vector3;
//! use amberfield_laws::force_limit::{largest, limited};
//! let bound = largest(1e-3, 2e-9, 1e-5, 1e-6);
//! assert!((bound - 2e-5).abs() < 1e-18);
//! let (force, was_limited) = limited(Vector3::new(0.0, 1.0, 0.0), bound);
//! assert!(was_limited && (force.y - bound).abs() < 1e-18);
//! ```

use nalgebra::Vector3;

/// Largest electric force [N] for factor, mass [kg], skin [m] and step [s].
#[inline]
#[must_use]
pub fn largest(factor: f64, mass: f64, skin: f64, step: f64) -> f64 {
    factor * mass * skin / (step * step)
}

/// The force [N] shortened to the bound [N], and whether it was.
#[inline]
#[must_use]
pub fn limited(force: Vector3<f64>, bound: f64) -> (Vector3<f64>, bool) {
    let size = force.norm();
    if size <= bound { (force, false) } else { (force * (bound / size), true) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-15;

    #[test]
    fn keeps_direction_and_short_forces() {
        let force = Vector3::new(3.0, 0.0, 4.0);
        let (cut, flag) = limited(force, 1.0);
        assert!(flag && (cut - force / 5.0).norm() < ROUND_OFF);
        assert_eq!(limited(force, 5.0), (force, false));
        assert_eq!(limited(force, 0.0).0, Vector3::zeros());
    }

    #[test]
    fn odd_and_continuous() {
        let force = Vector3::new(1.0, 1.0, 1.0);
        assert_eq!(limited(force, 1.0).0, -limited(-force, 1.0).0);
        let size = force.norm();
        assert!((limited(force, size * (1.0 - 1e-12)).0 - force).norm() < 1e-11);
    }

    #[test]
    fn grows_with_the_inverse_square_of_the_step() {
        assert!((largest(1.0, 1.0, 1.0, 0.5) / largest(1.0, 1.0, 1.0, 1.0) - 4.0).abs() < ROUND_OFF);
    }
}
