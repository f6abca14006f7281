//! Damping that a step bears: F = γ f [v_½ + θ (v_1 − v_½)], f = min(1/(1 + k/2), b), 0 ≤ θ = b − 1 ≤ 1.
//!
//! b = λ/G, λ = 1.6; γ damping coefficient of a contact [N·s/m]; v_½ velocity in the middle of the step and
//! v_1 = v_½ + ½Δt a the one forecast for its end from the last acceleration a [m/s]; k = S Δt²/m*, S
//! stiffness [N/m], m* effective mass [kg], Δt step [s]; G = Δt [γ/m* + Σ M/m_i + Σ M/m_j] with sums over the
//! other contacts of bodies i and j, M = max(γ_n, 7/2 γ_t) + (5/2) C_r ⟨1/r²⟩ the largest coefficient of a
//! contact in any direction [N·s/m] ([`largest`]), C_r of a rolling dashpot [N·m·s]. Walls have no m.
//!
//! *Stable for any packing.* For one body v_½ decays if g f (1 + θ) + k/2 < 2, g = γΔt/m*; here g f (1 + θ) ≤
//! λ. For many, with Γ the sum of M/m over all contacts of a body and t = Γ_j/Γ_i,
//!
//! ```text
//! γ (v_i − v_j)² ≤ γ [(1 + t) v_i² + (1 + 1/t) v_j²] = (Γ_i + Γ_j) [γ v_i²/Γ_i + γ v_j²/Γ_j],
//! ```
//!
//! and f (1 + θ) ≤ λ/[Δt (Γ_i + Γ_j)], so that the sum over all contacts is at most λ/Δt Σ m v². The rest up
//! to 2/Δt is for springs. Forces at rest do not change, and as Δt → 0 f = θ = 1.
//!
//! *Exact to second order where θ = 1.* The forecast is too large by the part k/2, since the spring's force
//! changes in the step. With f the restitution of a Hertz contact in 4.4 steps is 0.103, 0.193, 0.279, 0.493
//! and 0.903 for 0.1, 0.2, 0.3, 0.5 and 0.9 (0.075, 0.127, 0.210, 0.410, 0.879 with f = θ = 1, 0.048, 0.158,
//! 0.241, 0.481, 0.901 with f = 1 and θ = 0); `crates/dem/tests/it/few_steps.rs` has them. Source: derived
//! here; both velocities are those of velocity Verlet (Hairer, Lubich & Wanner, *Geometric Numerical
//! Integration*, §I.1.4).
//!
//! Each number may be that of one contact, or of several contacts side by side.
//!
//! ```
//! use amberfield_laws::damped_step::{bearable, forecast, share};
//! let bearable: f64 = bearable(0.8, 0.0);
//! assert_eq!((bearable, forecast(bearable), share(bearable, 1.0)), (2.0, 1.0, 1.0 / 1.5));
//! ```

use crate::hertz_mindlin;
use nalgebra::SimdRealField;

/// Largest product λ of damping rate and step.
pub const LARGEST: f64 = 1.6;

/// Effect of a tangential force on the surface of a sphere over that on its centre: 1 + m r²/I = 7/2.
pub const SURFACE: f64 = 3.5;

/// Bound b = λ/G, for G = `own` + `others`.
#[inline]
#[must_use]
pub fn bearable<T: SimdRealField<Element = f64> + Copy>(own: T, others: T) -> T {
    T::splat(LARGEST) / (own + others)
}

/// Part θ of the forecast, for the bound b.
#[inline]
#[must_use]
pub fn forecast<T: SimdRealField<Element = f64> + Copy>(bearable: T) -> T {
    (bearable - T::one()).simd_max(T::zero()).simd_min(T::one())
}

/// Share f of the damping that acts, for the bound b and k.
#[inline]
#[must_use]
pub fn share<T: SimdRealField<Element = f64> + Copy>(bearable: T, stiffness: T) -> T {
    let lagging = T::one() / (T::one() + T::splat(0.5) * stiffness);
    lagging.simd_min(bearable)
}

/// Largest coefficient M [N·s/m] of a contact in any direction: `normal` γ_n and `tangential` γ_t [N·s/m],
/// which also turns the bodies, and `rolling` = (5/2) C_r ⟨1/r²⟩ [N·s/m].
#[inline]
#[must_use]
pub fn largest<T: SimdRealField<Element = f64> + Copy>(normal: T, tangential: T, rolling: T) -> T {
    normal.simd_max(T::splat(SURFACE) * tangential) + rolling
}

/// Restitution of an impact that takes a number of steps, elastic, of a Hertz contact with the damping ratio
/// β of [`crate::restitution`]: the mean over where in a step it begins. More than a thousand steps are
/// counted as so many, where it is the one that was asked for to 1e-5.
///
/// ```
/// use amberfield_laws::{damped_step::restitution_in_steps, restitution::damping_ratio};
/// assert!((restitution_in_steps(damping_ratio(0.5), 4.4) - 0.493).abs() < 1e-3);
/// assert!((restitution_in_steps(damping_ratio(0.5), 100.0) - 0.5).abs() < 1e-3);
/// assert!((restitution_in_steps(damping_ratio(0.5), f64::INFINITY) - 0.5).abs() < 1e-5);
/// ```
#[must_use]
pub fn restitution_in_steps(damping_ratio: f64, steps: f64) -> f64 {
    let steps = steps.min(MOST_STEPS);
    (0..PHASES).map(|n| rebound(damping_ratio, steps, (f64::from(n) + 0.5) / f64::from(PHASES))).sum::<f64>()
        / f64::from(PHASES)
}

/// Most steps of an impact that are followed.
const MOST_STEPS: f64 = 1e3;
/// Places in a step over which [`restitution_in_steps`] takes the mean.
const PHASES: u32 = 20;

/// Speed after an impact of speed 1 that begins a part `phase` into a step: m* = 1, F = δ^{3/2} + γ v.
fn rebound(damping_ratio: f64, steps: f64, phase: f64) -> f64 {
    // (4/3) Y* = 1.
    let step = hertz_mindlin::contact_time(0.75, 1.0, 1.0, 1.0) / steps;
    let (mut overlap, mut speed, mut acceleration): (f64, f64, f64) = (-phase * step, 1.0, 0.0);
    loop {
        let middle = speed + 0.5 * step * acceleration;
        overlap += step * middle;
        if overlap < 0.0 && middle < 0.0 {
            return -middle;
        }
        let forecast = middle + 0.5 * step * acceleration;
        acceleration = 0.0;
        if overlap > 0.0 {
            let stiffness = 1.5 * overlap.sqrt();
            let damping = hertz_mindlin::damping(damping_ratio, stiffness, 1.0);
            let bearable = bearable(damping * step, 0.0);
            let seen = middle + self::forecast(bearable) * (forecast - middle);
            let acting = damping * share(bearable, stiffness * step * step);
            acceleration = -overlap.powf(1.5) - acting * seen;
        }
        speed = middle + 0.5 * step * acceleration;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in [0, 1) that depend on nothing but a seed.
    struct Numbers(u64);

    impl Numbers {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    /// Largest rate times step of bodies of masses m on a line, joined by dampings (i, j, γ), by iteration.
    fn largest_rate(mass: &[f64], contacts: &[(usize, usize, f64)]) -> f64 {
        let mut rate = vec![0.0; mass.len()];
        for &(i, j, damping) in contacts {
            rate[i] += damping / mass[i];
            rate[j] += damping / mass[j];
        }
        let mut v: Vec<f64> = (0..mass.len()).map(|k| if k % 2 == 0 { 1.0 } else { -0.9 }).collect();
        let mut size = 0.0;
        for _ in 0..500 {
            let mut change = vec![0.0; mass.len()];
            for &(i, j, damping) in contacts {
                let own = damping * (1.0 / mass[i] + 1.0 / mass[j]);
                let bearable = bearable(own, rate[i] + rate[j] - own);
                let share = share(bearable, 0.0) * (1.0 + forecast(bearable));
                let force = damping * share * (v[i] - v[j]);
                change[i] += force / mass[i];
                change[j] -= force / mass[j];
            }
            let norm = |v: &[f64]| v.iter().zip(mass).map(|(v, m)| m * v * v).sum::<f64>().sqrt();
            size = norm(&change) / norm(&v);
            v = change.iter().map(|c| c / size).collect();
        }
        size
    }

    #[test]
    fn no_packing_is_damped_beyond_the_bound_and_some_come_near_it() {
        let mut numbers = Numbers(7);
        let mut worst = 0.0_f64;
        for _ in 0..50 {
            let count = 3 + (numbers.next() * 10.0) as usize;
            let mass: Vec<f64> = (0..count).map(|_| 10_f64.powf(6.0 * numbers.next() - 3.0)).collect();
            let contacts: Vec<_> = (0..4 * count)
                .map(|n| {
                    let other = (n + 1 + (numbers.next() * 2.0) as usize) % count;
                    (n % count, other, 10_f64.powf(6.0 * numbers.next() - 2.0))
                })
                .filter(|(i, j, _)| i != j)
                .collect();
            worst = worst.max(largest_rate(&mass, &contacts));
        }
        assert!(worst < LARGEST * (1.0 + 1e-12) && worst > 0.9 * LARGEST, "{worst}");
    }

    #[test]
    fn small_steps_damp_in_full_and_large_ones_as_far_as_they_bear() {
        let (small, large): (f64, f64) = (bearable(1e-3, 1e-3), bearable(8.0, 24.0));
        assert_eq!((share(small, 0.0), forecast(small)), (1.0, 1.0));
        assert_eq!((share(large, 0.0), forecast(large)), (0.05, 0.0));
        // Where θ fades, f (1 + θ) G stays λ.
        let (share, part): (f64, f64) = (share(bearable(1.0, 0.25), 0.0), forecast(bearable(1.0, 0.25)));
        assert!((share * (1.0 + part) * 1.25 - LARGEST).abs() < 1e-15);
    }

    #[test]
    fn no_step_and_no_damping_are_borne() {
        let none: f64 = bearable(0.0, 0.0);
        assert_eq!((share(none, 0.0), forecast(none)), (1.0, 1.0));
    }

    #[test]
    fn tangential_damping_counts_seven_halves() {
        assert_eq!(largest(1.0, 0.9, 0.25), 3.4);
        assert_eq!(largest(1.0, 0.1, 0.0), 1.0);
    }
}
