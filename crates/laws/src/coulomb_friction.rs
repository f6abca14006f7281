//! Coulomb friction: |F_t| ≤ μ F_n.
//!
//! F_t tangential force [N]; F_n normal force [N], positive when it pushes the bodies apart; μ friction
//! coefficient, ≥ 0. A contact that pulls (F_n < 0) carries no friction. Static and sliding friction are
//! equal.
//! Source: Cundall & Strack, Géotechnique 29, 47 (1979).
//!
//! ```
//! use amberfield_core::Vector3;
//! use amberfield_laws::coulomb_friction::limited;
//! let trial = Vector3::new(3.0, 4.0, 0.0);
//! assert_eq!(limited(trial, 0.5, 100.0), trial); // sticks
//! assert!((limited(trial, 0.5, 2.0) - trial / 5.0).norm() < 1e-15); // slides with 1 N
//! ```

use nalgebra::Vector3;

/// Largest tangential force μ max(F_n, 0) [N] that friction can carry.
#[inline]
#[must_use]
pub fn largest(friction: f64, normal_force: f64) -> f64 {
    friction * normal_force.max(0.0)
}

/// Tangential force [N]: the trial force, shortened to the largest that friction can carry.
#[inline]
#[must_use]
pub fn limited(trial: Vector3<f64>, friction: f64, normal_force: f64) -> Vector3<f64> {
    let bound = largest(friction, normal_force);
    let size2 = trial.norm_squared();
    if size2 <= bound * bound { trial } else { trial * (bound / size2.sqrt()) }
}

/// Friction coefficient between two materials: the smaller of their two coefficients.
#[must_use]
pub fn mixed(friction_i: f64, friction_j: f64) -> f64 {
    friction_i.min(friction_j)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-15;

    #[test]
    fn sliding_force_has_the_bound_and_the_direction() {
        let trial = Vector3::new(-3.0, 0.0, 4.0);
        let f = limited(trial, 0.3, 2.0);
        assert!((f.norm() - 0.6).abs() < ROUND_OFF);
        assert!(f.cross(&trial).norm() < ROUND_OFF);
    }

    #[test]
    fn continuous_at_the_limit_and_zero_in_tension() {
        let trial = Vector3::new(1.0, 0.0, 0.0);
        assert!((limited(trial, 1.0, 1.0 - 1e-12) - trial).norm() < 2e-12);
        assert_eq!(limited(trial, 0.5, -3.0), Vector3::zeros());
    }

    #[test]
    fn odd_in_the_trial_force() {
        let trial = Vector3::new(1.0, 2.0, 3.0);
        assert_eq!(limited(trial, 0.1, 1.0), -limited(-trial, 0.1, 1.0));
        assert_eq!(mixed(0.1, 0.4), mixed(0.4, 0.1));
    }
}
