//! Rolling friction: |M| ≤ μ_r R* F_n, ω_r = ω_i − ω_j.
//!
//! M torque on i [N·m], −M on j; μ_r rolling friction coefficient, ≥ 0; R* effective radius [m]; F_n normal
//! force [N]; ω_r relative angular velocity [rad/s]. A contact that pulls carries no torque. ω_r holds
//! rolling as well as twist about the normal; otherwise a grain could spin like a top forever. (With μ_r = 0
//! it may: a point contact has no drilling torque.) A sphere on a slope rolls down where tan α > μ_r.
//!
//! Three models say how M depends on the motion: [`crate::rolling_epsd`], a spring with a dashpot;
//! [`crate::rolling_epsd2`], a stiffer spring alone; and [`crate::rolling_cdt`], a constant torque.
//! Source: Ai, Chen, Rotter & Ooi, Powder Technol. 206, 269 (2011).
//!
//! Each number may be that of one contact, or of several contacts side by side.
//!
//! ```
//! use amberfield_laws::rolling_friction::largest;
//! let bound: f64 = largest(0.1, 1e-3, 2.0);
//! assert!((bound - 2e-4).abs() < 1e-15);
//! ```

use nalgebra::{SimdRealField, Vector3};

/// Largest rolling torque μ_r R* max(F_n, 0) [N·m].
#[inline]
#[must_use]
pub fn largest<T: SimdRealField<Element = f64> + Copy>(
    rolling_friction: T,
    effective_radius: T,
    normal_force: T,
) -> T {
    rolling_friction * effective_radius * normal_force.simd_max(T::zero())
}

/// Rolling friction coefficient between two materials: the smaller of their two coefficients.
#[must_use]
pub fn mixed(rolling_friction_i: f64, rolling_friction_j: f64) -> f64 {
    rolling_friction_i.min(rolling_friction_j)
}

/// Torque shortened to a bound [N·m], and where it was below it.
#[inline]
#[must_use]
pub fn limited<T: SimdRealField<Element = f64> + Copy>(
    trial: Vector3<T>,
    bound: T,
) -> (Vector3<T>, T::SimdBool) {
    let size2 = trial.norm_squared();
    let below = size2.simd_lt(bound * bound);
    // A trial torque of zero is kept too: shortening it would divide by zero.
    let kept = below | size2.simd_eq(T::zero());
    (trial * T::one().select(kept, bound / size2.simd_sqrt()), below)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torque_has_the_bound_and_the_direction() {
        let trial: Vector3<f64> = Vector3::new(3.0, 0.0, -4.0);
        let (torque, below) = limited(trial, 1.0);
        assert!((torque - trial / 5.0).norm() < 1e-15 && !below);
        assert_eq!(limited(trial, 6.0), (trial, true));
        assert_eq!(limited(Vector3::zeros(), 0.0), (Vector3::<f64>::zeros(), false));
    }

    #[test]
    fn contacts_that_pull_carry_none_and_the_smoother_material_decides() {
        assert_eq!(largest(0.1, 1.0, -1.0), 0.0);
        assert_eq!(mixed(0.2, 0.1), 0.1);
    }
}
