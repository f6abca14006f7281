//! Rolling friction CDT, a constant directional torque: M = −μ_r R* F_n ω_r/|ω_r|.
//!
//! M torque on i [N·m]; ω_r relative angular velocity [rad/s]; bound and signs as in
//! [`crate::rolling_friction`]. A sphere that rolls on a plane slows at (5/7) μ_r g. The torque jumps where
//! ω_r turns, and in steps it would chatter there. So it takes at most a share s = 0.1 of ω_r in a step,
//!
//! ```text
//! M = −ω_r min(C, μ_r R* F_n/|ω_r|),   C = s I/Δt,   I = 1/(1/I_i + 1/I_j),
//! ```
//!
//! I_i moment of inertia about the centre [kg·m²], Δt step [s]. Below |ω_r| = μ_r R* F_n Δt/(s I) rolling
//! fades instead of stopping. The law has no spring: a loaded grain creeps, and a heap comes to rest slower
//! than by EPSD.
//! Source: Zhou, Wright, Yang, Xu & Yu, Physica A 269, 536 (1999); Ai, Chen, Rotter & Ooi, Powder Technol.
//! 206, 269 (2011), type A; Wensrich & Katterfeld, Powder Technol. 217, 409 (2012).
//!
//! Each number may be that of one contact, or of several contacts side by side.
//!
//! ```
//! use amberfield_core::Vector3;
//! use amberfield_laws::rolling_cdt::{coefficient, most};
//! let (turning, bound): (Vector3<f64>, f64) = (Vector3::new(0.0, 50.0, 0.0), 1e-8);
//! let torque = -turning * coefficient(most(1e-10, 1e-6), bound, turning.norm());
//! assert!((torque.y + bound).abs() < 1e-23);
//! ```

use nalgebra::SimdRealField;

/// Largest share s of the relative rolling that a contact takes in a step.
pub const SHARE: f64 = 0.1;

/// Largest coefficient C [N·m·s/rad] for an inertia I [kg·m²] and a step [s]; none in no step.
#[inline]
#[must_use]
pub fn most<T: SimdRealField<Element = f64> + Copy>(inertia: T, step: T) -> T {
    let taken = T::splat(SHARE) * inertia / step;
    taken.select(step.simd_gt(T::zero()), T::zero())
}

/// Coefficient c of the torque −c ω_r [N·m·s/rad]: `most` C [N·m·s/rad], `bound` from
/// [`crate::rolling_friction::largest`] [N·m], `speed` |ω_r| [rad/s].
#[inline]
#[must_use]
pub fn coefficient<T: SimdRealField<Element = f64> + Copy>(most: T, bound: T, speed: T) -> T {
    // Not a division by the speed, which may be zero.
    (most * bound / bound.simd_max(most * speed)).select(bound.simd_gt(T::zero()), T::zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn torque_is_constant_and_fades_at_rest() {
        let (most, bound): (f64, f64) = (2.0, 0.5);
        for speed in [0.25, 1.0, 1e3, 1e9] {
            assert!((coefficient(most, bound, speed) * speed - bound).abs() < 1e-15);
        }
        assert_eq!(coefficient(most, bound, 0.1), most);
        assert_eq!(coefficient(most, bound, 0.0), most);
    }

    #[test]
    fn no_load_and_no_step_have_no_torque() {
        assert_eq!(coefficient(2.0, 0.0, 1.0), 0.0);
        assert_eq!(most(1.0, 0.0), 0.0);
        assert_eq!(coefficient(most(1.0, 0.0), 0.3, 0.0), 0.0);
    }

    #[test]
    fn step_takes_a_tenth_of_slow_rolling() {
        let (inertia, step): (f64, f64) = (3e-10, 1e-5);
        let left = 1.0 - coefficient(most(inertia, step), 1.0, 1e-3) * step / inertia;
        assert!((left - 0.9).abs() < 1e-15);
    }
}
