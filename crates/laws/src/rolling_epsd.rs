//! Rolling friction EPSD, a spring and a dashpot: M = M_k − C_r ω_r, dM_k = −k_r ω_r dt, |M_k| ≤ μ_r R* F_n.
//!
//! M torque on i [N·m]; ω_r relative angular velocity [rad/s]; k_r = 2.25 S_n (μ_r R*)² rolling stiffness
//! [N·m/rad]; S_n normal stiffness [N/m]; C_r = 2 η √(I_r k_r) damping [N·m·s/rad]; I_r reduced moment of
//! inertia about the contact [kg·m²]; η = 0.3 damping ratio; bound and signs as in
//! [`crate::rolling_friction`].
//!
//! The dashpot acts only while the spring is below its limit (f = 0 in the source). μ_r bounds the spring,
//! not the dashpot: a grain that begins to roll fast feels more than μ_r R* F_n until the spring is at its
//! limit, and heaps are steeper than those of EPSD2 with the same μ_r. The spring
//! lets a heap rest without creeping.
//! Source: Ai, Chen, Rotter & Ooi, Powder Technol. 206, 269 (2011), type C; Iwashita & Oda, J. Eng. Mech.
//! 124, 285 (1998).
//!
//! Each number may be that of one contact, or of several contacts side by side.
//!
//! ```
//! use amberfield_laws::rolling_epsd::stiffness;
//! let k: f64 = stiffness(1e4, 0.1, 1e-3);
//! assert!((k - 2.25e-4).abs() < 1e-15);
//! ```

use crate::rolling_friction::limited;
use nalgebra::{SimdRealField, Vector3};

/// Damping ratio η of the rolling dashpot, the value that Ai et al. recommend.
pub const ROLLING_DAMPING_RATIO: f64 = 0.3;

/// Rolling stiffness k_r [N·m/rad] for a normal stiffness S_n [N/m], a coefficient μ_r and a radius R* [m].
#[inline]
#[must_use]
pub fn stiffness<T: SimdRealField<Element = f64> + Copy>(
    normal_stiffness: T,
    rolling_friction: T,
    effective_radius: T,
) -> T {
    let arm = rolling_friction * effective_radius;
    T::splat(2.25) * normal_stiffness * arm * arm
}

/// Rolling damping C_r [N·m·s/rad] for a reduced inertia I_r [kg·m²] and a stiffness k_r [N·m/rad].
#[inline]
#[must_use]
pub fn damping<T: SimdRealField<Element = f64> + Copy>(reduced_inertia: T, stiffness: T) -> T {
    T::splat(2.0 * ROLLING_DAMPING_RATIO) * (reduced_inertia * stiffness).simd_sqrt()
}

/// Rolling torques on body i after a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RollingTorque<T> {
    /// Torque M_k of the spring [N·m], which the contact remembers.
    pub spring: Vector3<T>,
    /// Total torque M_k + M_d [N·m].
    pub total: Vector3<T>,
}

/// Advances the spring by one step.
///
/// `spring` M_k before the step [N·m], `turn` = ω_r Δt [rad], `rolling_velocity` = ω_r [rad/s], `stiffness`
/// k_r [N·m/rad], `damping` C_r [N·m·s/rad], `bound` from [`crate::rolling_friction::largest`] [N·m].
#[inline]
#[must_use]
pub fn advance<T: SimdRealField<Element = f64> + Copy>(
    spring: Vector3<T>,
    turn: Vector3<T>,
    rolling_velocity: Vector3<T>,
    stiffness: T,
    damping: T,
    bound: T,
) -> RollingTorque<T> {
    let (spring, sticking) = limited(spring - turn * stiffness, bound);
    RollingTorque { spring, total: spring - rolling_velocity * damping.select(sticking, T::zero()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-15;

    #[test]
    fn spring_opposes_rolling_and_saturates() {
        let turn: Vector3<f64> = Vector3::new(0.1, 0.0, 0.0);
        let sticking = advance(Vector3::zeros(), turn, Vector3::zeros(), 2.0, 0.0, 1.0);
        assert!((sticking.spring.x + 0.2).abs() < ROUND_OFF && sticking.total == sticking.spring);
        let slipping = advance(Vector3::zeros(), turn * 100.0, turn, 2.0, 5.0, 1.0);
        assert!((slipping.spring.x + 1.0).abs() < ROUND_OFF && slipping.total == slipping.spring);
    }

    #[test]
    fn derivative_of_the_elastic_torque_is_the_stiffness() {
        let at = |angle: f64| {
            let turn = Vector3::new(angle, 0.0, 0.0);
            advance(Vector3::zeros(), turn, Vector3::zeros(), 3.0, 0.0, 9.0).total.x
        };
        assert!(((at(0.1 + 1e-4) - at(0.1 - 1e-4)) / 2e-4 + 3.0).abs() < 1e-9);
    }

    #[test]
    fn odd_and_zero_without_load() {
        let turn = Vector3::new(0.1, 0.2, -0.1);
        let there = advance(Vector3::zeros(), turn, turn, 1.0, 1.0, 0.1);
        let back = advance(Vector3::zeros(), -turn, -turn, 1.0, 1.0, 0.1);
        assert_eq!(there.spring, -back.spring);
        assert_eq!(advance(turn, turn, turn, 1.0, 1.0, 0.0).total, Vector3::zeros());
        assert!((damping(4.0, 9.0) - 3.6_f64).abs() < ROUND_OFF);
    }

    #[test]
    fn dashpot_goes_beyond_the_bound_of_the_spring() {
        let turning: Vector3<f64> = Vector3::new(1.0, 0.0, 0.0);
        assert_eq!(advance(Vector3::zeros(), turning * 1e-3, turning, 1.0, 5.0, 0.1).total.x, -5.001);
    }
}
