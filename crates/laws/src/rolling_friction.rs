//! Rolling friction, elastic–plastic spring and dashpot: M_k ← M_k − k_r ω_r Δt, |M_k| ≤ μ_r R* F_n,
//! M_d = −C_r ω_r.
//!
//! M [N·m] torque on i, −M on j; ω_r relative angular velocity ω_i − ω_j [rad/s], rolling and twist about the
//! normal alike, else a grain could spin like a top forever (with μ_r = 0 it may: a point contact has no drilling torque); k_r = 2.25 S_n (μ_r R*)² rolling stiffness [N·m/rad]; S_n normal stiffness [N/m]; R* effective
//! radius [m]; μ_r rolling friction coefficient; F_n normal force [N]; C_r = 2 η √(I_r k_r) [N·m·s],
//! I_r reduced moment of inertia about the contact [kg·m²], η = 0.3. The dashpot acts only while the spring
//! is below its limit. A constant directional torque (type A) would chatter about zero in a heap at rest; the
//! spring gives rest without creeping energy. Source: Ai, Chen, Rotter & Ooi, Powder Technol. 206, 269 (2011),
//! type C; Iwashita & Oda, J. Eng. Mech. 124, 285 (1998).
//! A number may be one contact's or, side by side, those of several.
//!
//! ```
//! use amberfield_laws::rolling_friction::{largest, stiffness};
//! let (k, bound): (f64, f64) = (stiffness(1e4, 0.1, 1e-3), largest(0.1, 1e-3, 2.0));
//! assert!((k - 2.25e-4).abs() < 1e-15 && (bound - 2e-4).abs() < 1e-15);
//! ```

use nalgebra::{SimdRealField, Vector3};

/// Damping ratio η of the rolling dashpot, the value that Ai et al. recommend.
pub const ROLLING_DAMPING_RATIO: f64 = 0.3;

/// k_r [N·m/rad] for S_n [N/m], μ_r and R* [m].
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

/// Largest rolling torque [N·m]: μ_r R* max(F_n, 0).
#[inline]
#[must_use]
pub fn largest<T: SimdRealField<Element = f64> + Copy>(
    rolling_friction: T,
    effective_radius: T,
    normal_force: T,
) -> T {
    rolling_friction * effective_radius * normal_force.simd_max(T::zero())
}

/// C_r [N·m·s/rad] for the reduced inertia [kg·m²] and k_r [N·m/rad].
#[inline]
#[must_use]
pub fn damping<T: SimdRealField<Element = f64> + Copy>(reduced_inertia: T, stiffness: T) -> T {
    T::splat(2.0 * ROLLING_DAMPING_RATIO) * (reduced_inertia * stiffness).simd_sqrt()
}

/// One step of the spring: new spring torque and total torque on i [N·m]. `turn` = ω_r Δt [rad],
/// `rolling_velocity` = ω_r [rad/s], `bound` as [`largest`] gives it.
#[inline]
#[must_use]
pub fn advance<T: SimdRealField<Element = f64> + Copy>(
    spring: Vector3<T>,
    turn: Vector3<T>,
    rolling_velocity: Vector3<T>,
    stiffness: T,
    damping: T,
    bound: T,
) -> (Vector3<T>, Vector3<T>) {
    let trial = spring - turn * stiffness;
    let size2 = trial.norm_squared();
    let sticking = size2.simd_lt(bound * bound);
    let kept = sticking | size2.simd_eq(T::zero());
    let new = trial * T::one().select(kept, bound / size2.simd_sqrt());
    (new, new - rolling_velocity * damping.select(sticking, T::zero()))
}

/// Rolling friction coefficient of two materials: the smaller one, as for sliding.
#[must_use]
pub fn mixed(rolling_friction_i: f64, rolling_friction_j: f64) -> f64 {
    rolling_friction_i.min(rolling_friction_j)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-15;

    #[test]
    fn spring_opposes_rolling_and_saturates() {
        let turn: Vector3<f64> = Vector3::new(0.1, 0.0, 0.0);
        let (spring, torque) = advance(Vector3::zeros(), turn, Vector3::zeros(), 2.0, 0.0, 1.0);
        assert!((spring.x + 0.2).abs() < ROUND_OFF && torque == spring);
        let (spring, torque) = advance(Vector3::zeros(), turn * 100.0, turn, 2.0, 5.0, 1.0);
        assert!((spring.x + 1.0).abs() < ROUND_OFF && torque == spring);
    }

    #[test]
    fn derivative_of_the_elastic_torque_is_the_stiffness() {
        let at = |angle: f64| {
            advance(Vector3::zeros(), Vector3::new(angle, 0.0, 0.0), Vector3::zeros(), 3.0, 0.0, 9.0).1.x
        };
        assert!(((at(0.1 + 1e-4) - at(0.1 - 1e-4)) / 2e-4 + 3.0).abs() < 1e-9);
    }

    #[test]
    fn odd_and_zero_without_load() {
        let turn = Vector3::new(0.1, 0.2, -0.1);
        let (a, _) = advance(Vector3::zeros(), turn, turn, 1.0, 1.0, 0.1);
        let (b, _) = advance(Vector3::zeros(), -turn, -turn, 1.0, 1.0, 0.1);
        assert_eq!(a, -b);
        assert_eq!(advance(turn, turn, turn, 1.0, 1.0, 0.0).1, Vector3::zeros());
        assert_eq!(largest(0.1, 1.0, -1.0), 0.0);
        assert!((damping(4.0, 9.0) - 3.6_f64).abs() < ROUND_OFF);
        assert_eq!(mixed(0.2, 0.1), 0.1);
    }
}
