//! Adhesion of Johnson, Kendall and Roberts: δ = a²/R* − √(2πwa/Y*), F = 4Y*a³/(3R*) − √(8πwY*a³).
//!
//! a contact radius [m]; δ overlap [m], negative where the contact is stretched; R* effective radius (at a
//! wall that of the grain) [m]; Y* effective modulus [Pa]; w work of adhesion [J/m²], see
//! [`crate::work_of_adhesion`]; F > 0 pushes the bodies apart [N].
//!
//! With a_c³ = πwR*²/(8Y*) the contact radius where a stretched contact breaks, F_c = (3/2)πwR* the pull-off
//! force and s = √(a/a_c),
//!
//! ```text
//! δ R*/a_c² = s⁴ − 4s,    F/F_c = s⁶/9 − 2s³/3,    U R*/(F_c a_c²) = 2s¹⁰/45 − 4s⁷/9 + 2s⁴/3,
//! ```
//!
//! U = ∫F dδ from a = 0 [J]. The root s ≥ 1 of the quartic is known in closed form. A contact is made at δ =
//! 0, where it jumps to a³ = 2πwR*²/Y* and pulls with (8/9) F_c; it pulls with F_c at δ R*/a_c² = −3^{1/3},
//! and breaks at δ_c = −3a_c²/R* with (5/9) F_c. Making and breaking costs W_s = (4/15 + (2/5) 4^{4/3}) F_c
//! a_c²/R* = 7.09 (w⁵R*⁴/Y*²)^{1/3}; without other losses two bodies part if they meet faster than
//! √(2W_s/m*).
//! Range: large, soft grains (Tabor's number ≫ 1, see [`crate::dmt`]), a ≪ r.
//! Sources: Johnson, Kendall & Roberts, Proc. R. Soc. A 324, 301 (1971); Thornton & Ning, Powder Technol. 99,
//! 154 (1998), for W_s; Parteli et al., Sci. Rep. 4, 6227 (2014), who solve the same quartic.
//!
//! ```
//! use amberfield_laws::jkr::{Scale, pull_off};
//! let jkr = Scale::new(0.1_f64, 5e-5, 1e7);
//! assert!((jkr.pull_off / pull_off(0.1, 5e-5) - 1.0).abs() < 1e-15);
//! // At no overlap the contact pulls with 8/9 of the pull-off force.
//! assert!((jkr.force(jkr.root(0.0)) / jkr.pull_off + 8.0 / 9.0).abs() < 1e-14);
//! ```

use std::f64::consts::PI;

use nalgebra::SimdRealField;

/// Energy 4/15 + (2/5) 4^{4/3} of making and breaking a contact, over F_c a_c²/R*.
const CYCLE: f64 = 4.0 / 15.0 + 0.4 * 6.349_604_207_872_798;

/// Units of a contact: pull-off force, contact radius and overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale<T> {
    /// F_c [N].
    pub pull_off: T,
    /// a_c [m].
    pub contact_radius: T,
    /// a_c²/R* [m]; a third of the stretch at which the contact breaks.
    pub overlap: T,
}

impl<T: SimdRealField<Element = f64> + Copy> Scale<T> {
    /// Units of a contact with a work of adhesion [J/m²], R* [m] and Y* [Pa].
    #[inline(always)]
    #[must_use]
    pub fn new(work: T, radius: T, young: T) -> Self {
        let contact_radius = (work * radius * radius * T::splat(PI / 8.0) / young).simd_cbrt();
        let overlap = contact_radius * contact_radius / radius;
        Self { pull_off: pull_off(work, radius), contact_radius, overlap }
    }

    /// Root s = √(a/a_c) at an overlap [m]; 1 where the contact would break.
    #[inline(always)]
    #[must_use]
    pub fn root(&self, overlap: T) -> T {
        // s⁴ − 4s − d = (s² + ps + q)(s² − ps + r); p² = u solves u³ + 4du − 16 = 0.
        let third = overlap / self.overlap * T::splat(4.0 / 3.0);
        let square = (T::splat(64.0) + third * third * third).simd_max(T::zero()).simd_sqrt();
        let large = (T::splat(8.0) + square).simd_cbrt();
        let small = third / large;
        let u = T::splat(16.0) / (large * large + third + small * small);
        let p = u.simd_sqrt();
        let rest = (T::splat(8.0) / p - u).simd_max(T::zero()).simd_sqrt();
        ((p + rest) * T::splat(0.5)).simd_max(T::one())
    }

    /// Contact radius a [m] of a root.
    #[inline(always)]
    #[must_use]
    pub fn radius(&self, root: T) -> T {
        self.contact_radius * root * root
    }

    /// Normal force F [N] of a root.
    #[inline(always)]
    #[must_use]
    pub fn force(&self, root: T) -> T {
        let cube = root * root * root;
        self.pull_off * cube * (cube * T::splat(1.0 / 9.0) - T::splat(2.0 / 3.0))
    }

    /// Energy U [J] of a root: that of a contact with a = 0 is zero.
    #[inline(always)]
    #[must_use]
    pub fn energy(&self, root: T) -> T {
        let cube = root * root * root;
        let inner = (cube * T::splat(2.0 / 45.0) - T::splat(4.0 / 9.0)) * cube + T::splat(2.0 / 3.0);
        self.pull_off * self.overlap * cube * root * inner
    }

    /// Stretch −δ_c = 3a_c²/R* [m] at which the contact breaks.
    #[inline(always)]
    #[must_use]
    pub fn longest_stretch(&self) -> T {
        self.overlap * T::splat(3.0)
    }

    /// Work W_s [J] that a contact costs which is made and broken.
    #[inline]
    #[must_use]
    pub fn cycle_work(&self) -> T {
        self.pull_off * self.overlap * T::splat(CYCLE)
    }
}

/// Pull-off force F_c = (3/2)πwR* [N] of a work of adhesion [J/m²] and an effective radius [m].
#[inline(always)]
#[must_use]
pub fn pull_off<T: SimdRealField<Element = f64> + Copy>(work: T, radius: T) -> T {
    work * radius * T::splat(1.5 * PI)
}

/// Contact radius [m] under a load F [N]: a³ = 3R*/(4Y*)·(F + 3πwR* + √(6πwR*F + (3πwR*)²)), F ≥ −F_c.
#[must_use]
pub fn contact_radius_of_load(load: f64, work: f64, radius: f64, young: f64) -> f64 {
    let pull = 3.0 * PI * work * radius;
    let root = (2.0 * pull * load + pull * pull).max(0.0).sqrt();
    (0.75 * radius / young * (load + pull + root)).cbrt()
}

/// Speed √(2W_s/m*) [m/s] below which two bodies of an effective mass m* [kg] stay together.
#[must_use]
pub fn sticking_speed(work: f64, radius: f64, young: f64, mass: f64) -> f64 {
    (2.0 * Scale::new(work, radius, young).cycle_work() / mass).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hertz_mindlin;

    const WORK: f64 = 0.1;
    const RADIUS: f64 = 5e-5;
    const YOUNG: f64 = 1e7;
    /// Round-off through powers.
    const ROUND_OFF: f64 = 1e-13;
    /// Error of a central difference.
    const DIFFERENCE: f64 = 1e-7;

    fn jkr() -> Scale<f64> {
        Scale::new(WORK, RADIUS, YOUNG)
    }

    #[test]
    fn root_solves_the_quartic_to_round_off_for_any_overlap() {
        let jkr = jkr();
        for d in [-3.0, -2.999, -2.0, -1.442, -1e-9, 0.0, 1e-9, 1.0, 1e2, 1e6, 1e12] {
            let s = jkr.root(d * jkr.overlap);
            let error = (s.powi(4) - 4.0 * s - d).abs() / d.abs().max(1.0);
            assert!(error < 1e-13 && s >= 1.0, "{d}: {error:e}");
        }
    }

    #[test]
    fn root_is_that_of_the_equations_of_johnson_kendall_and_roberts() {
        let jkr = jkr();
        for d in [-2.9, -1.0, 0.0, 3.0, 70.0] {
            let overlap = d * jkr.overlap;
            let s = jkr.root(overlap);
            let a = jkr.radius(s);
            let approach = a * a / RADIUS - (2.0 * PI * WORK * a / YOUNG).sqrt();
            assert!((approach - overlap).abs() < ROUND_OFF * a * a / RADIUS, "{d}");
            let force =
                4.0 * YOUNG * a.powi(3) / (3.0 * RADIUS) - (8.0 * PI * WORK * YOUNG * a.powi(3)).sqrt();
            assert!((jkr.force(s) - force).abs() < ROUND_OFF * (force.abs() + jkr.pull_off), "{d}");
            let of_load = contact_radius_of_load(force, WORK, RADIUS, YOUNG);
            // The branch of stable loads.
            assert!(s.powi(3) < 3.0 || (of_load / a - 1.0).abs() < 1e-7, "{d}: {of_load:e} {a:e}");
        }
    }

    #[test]
    fn exact_points() {
        let jkr = jkr();
        let over = |s: f64| jkr.force(s) / jkr.pull_off;
        assert!((over(3.0_f64.cbrt()) + 1.0).abs() < ROUND_OFF);
        assert!((over(1.0) + 5.0 / 9.0).abs() < ROUND_OFF);
        assert!((over(jkr.root(0.0)) + 8.0 / 9.0).abs() < ROUND_OFF);
        // No load: a₀³ = 9πwR*²/(2Y*).
        let zero = jkr.radius(6.0_f64.cbrt());
        assert!((zero / (4.5 * PI * WORK * RADIUS * RADIUS / YOUNG).cbrt() - 1.0).abs() < ROUND_OFF);
        assert!((zero / contact_radius_of_load(0.0, WORK, RADIUS, YOUNG) - 1.0).abs() < ROUND_OFF);
    }

    #[test]
    fn force_is_the_derivative_of_the_energy() {
        let jkr = jkr();
        for d in [-2.5, -1.0, 0.0, 5.0] {
            let h = 1e-5 * jkr.overlap;
            let at = |shift: f64| jkr.energy(jkr.root(d * jkr.overlap + shift));
            let slope = (at(h) - at(-h)) / (2.0 * h);
            let force = jkr.force(jkr.root(d * jkr.overlap));
            assert!((slope - force).abs() < DIFFERENCE * jkr.pull_off, "{d}");
        }
    }

    #[test]
    fn work_of_a_cycle_is_that_of_thornton_and_ning() {
        let jkr = jkr();
        let work = jkr.energy(1.0) - jkr.energy(jkr.root(0.0));
        assert!((work / jkr.cycle_work() - 1.0).abs() < ROUND_OFF);
        let rounded = 7.09 * (WORK.powi(5) * RADIUS.powi(4) / (YOUNG * YOUNG)).cbrt();
        assert!((work / rounded - 1.0).abs() < 1e-3);
        let speed = sticking_speed(WORK, RADIUS, YOUNG, 1e-9);
        assert!((0.5e-9 * speed * speed / work - 1.0).abs() < ROUND_OFF);
    }

    #[test]
    fn little_adhesion_is_hertz() {
        let (weak, overlap) = (Scale::new(1e-12, RADIUS, YOUNG), 1e-7);
        let ratio = weak.force(weak.root(overlap)) / hertz_mindlin::normal_force(YOUNG, RADIUS, overlap);
        assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
    }
}
