//! Rolling friction EPSD2, a spring alone: dM = −k_r ω_r dt, k_r = S_t R*², |M| ≤ μ_r R* F_n.
//!
//! M torque on i [N·m]; ω_r relative angular velocity [rad/s]; k_r rolling stiffness [N·m/rad]; S_t
//! tangential stiffness [N/m]; bound and signs as in [`crate::rolling_friction`]. There is no dashpot, so
//! that μ_r bounds the whole torque. k_r does not depend on μ_r, and is larger than that of EPSD where μ_r <
//! 0.6. A grain that rocks about its rest is slowed by friction alone.
//! Source: Iwashita & Oda, J. Eng. Mech. 124, 285 (1998) for k_r; Wensrich & Katterfeld, Powder Technol. 217,
//! 409 (2012) for its use; the name is that of LIGGGHTS.
//!
//! Each number may be that of one contact, or of several contacts side by side.
//!
//! ```
//! use amberfield_core::Vector3;
//! use amberfield_laws::rolling_epsd2::{advance, stiffness};
//! let k: f64 = stiffness(1e4, 1e-3);
//! let turn = Vector3::new(1e-3, 0.0, 0.0);
//! assert_eq!(advance(Vector3::zeros(), turn, k, 1.0).x, -k * 1e-3); // below its bound
//! assert_eq!(advance(Vector3::zeros(), turn, k, 1e-6).x, -1e-6);
//! ```

use crate::rolling_friction::limited;
use nalgebra::{SimdRealField, Vector3};

/// Rolling stiffness k_r [N·m/rad] for a tangential stiffness S_t [N/m] and a radius R* [m].
#[inline]
#[must_use]
pub fn stiffness<T: SimdRealField<Element = f64> + Copy>(tangential_stiffness: T, effective_radius: T) -> T {
    tangential_stiffness * effective_radius * effective_radius
}

/// Torque M [N·m] after a step: `torque` before it [N·m], `turn` = ω_r Δt [rad], `stiffness` k_r [N·m/rad],
/// `bound` from [`crate::rolling_friction::largest`] [N·m].
#[inline]
#[must_use]
pub fn advance<T: SimdRealField<Element = f64> + Copy>(
    torque: Vector3<T>,
    turn: Vector3<T>,
    stiffness: T,
    bound: T,
) -> Vector3<T> {
    limited(torque - turn * stiffness, bound).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torque_never_exceeds_its_bound_however_fast_it_rolls() {
        let mut torque: Vector3<f64> = Vector3::zeros();
        for n in 0..100 {
            let turn = Vector3::new(0.1 * f64::from(n), -1.0, 0.3);
            torque = advance(torque, turn, 2.0, 0.7);
            assert!(torque.norm() <= 0.7 * (1.0 + 1e-15));
        }
    }

    #[test]
    fn spring_returns_what_it_took_below_the_bound() {
        let turn: Vector3<f64> = Vector3::new(0.1, 0.2, 0.0);
        let there = advance(Vector3::zeros(), turn, 2.0, 10.0);
        assert_eq!(advance(there, -turn, 2.0, 10.0), Vector3::zeros());
        assert_eq!(stiffness(3.0, 2.0), 12.0);
    }
}
