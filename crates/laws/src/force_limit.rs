//! Bound on the electric force: |F_E| ≤ f · m · skin/Δt².
//!
//! F_E electric force [N]; f factor in [0, 1]; m mass [kg]; skin of the neighbour list [m]; Δt step [s]. A
//! force at the bound moves a grain from rest by f·skin/2 in one step, so that the neighbour list misses no
//! pair. A force beyond the bound is shortened; it keeps its direction.
//! Source: the scene's option `limit_field_force`.
//!
//! ```
//! use amberfield_core::Vector3;
//! use amberfield_laws::force_limit::{largest, limited};
//! let bound = largest(1e-3, 2e-9, 1e-5, 1e-6);
//! assert!((bound - 2e-5).abs() < 1e-18);
//! let limited = limited(Vector3::new(0.0, 1.0, 0.0), bound);
//! assert!(limited.shortened && (limited.force.y - bound).abs() < 1e-18);
//! ```

use nalgebra::Vector3;

/// Largest electric force [N] for factor f, mass [kg], skin [m] and step [s].
#[inline]
#[must_use]
pub fn largest(factor: f64, mass: f64, skin: f64, step: f64) -> f64 {
    factor * mass * skin / (step * step)
}

/// Electric force after the bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimitedForce {
    /// Force [N], not longer than the bound.
    pub force: Vector3<f64>,
    /// Flag of a force that was longer than the bound.
    pub shortened: bool,
}

/// Shortens a force [N] to the bound [N] where it is longer.
#[inline]
#[must_use]
pub fn limited(force: Vector3<f64>, bound: f64) -> LimitedForce {
    let size = force.norm();
    if size <= bound {
        LimitedForce { force, shortened: false }
    } else {
        LimitedForce { force: force * (bound / size), shortened: true }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-15;

    #[test]
    fn keeps_direction_and_short_forces() {
        let force = Vector3::new(3.0, 0.0, 4.0);
        let cut = limited(force, 1.0);
        assert!(cut.shortened && (cut.force - force / 5.0).norm() < ROUND_OFF);
        assert_eq!(limited(force, 5.0), LimitedForce { force, shortened: false });
        assert_eq!(limited(force, 0.0).force, Vector3::zeros());
    }

    #[test]
    fn odd_and_continuous() {
        let force = Vector3::new(1.0, 1.0, 1.0);
        assert_eq!(limited(force, 1.0).force, -limited(-force, 1.0).force);
        let size = force.norm();
        assert!((limited(force, size * (1.0 - 1e-12)).force - force).norm() < 1e-11);
    }

    #[test]
    fn grows_with_the_inverse_square_of_the_step() {
        assert!((largest(1.0, 1.0, 1.0, 0.5) / largest(1.0, 1.0, 1.0, 1.0) - 4.0).abs() < ROUND_OFF);
    }
}
