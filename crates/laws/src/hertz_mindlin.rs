//! Hertz–Mindlin contact: F_n = (4/3) Y* √R* δ^{3/2} − γ_n v_n, dF_t = −S_t v_t dt, γ = 2√(5/6) β √(S m*).
//!
//! δ overlap [m]; Y* effective Young's modulus [Pa], 1/Y* = (1−ν_i²)/Y_i + (1−ν_j²)/Y_j; G* effective shear
//! modulus [Pa], 1/G* = (2−ν_i)/G_i + (2−ν_j)/G_j, G = Y/2(1+ν); R* effective radius [m], 1/R* = 1/r_i +
//! 1/r_j (wall: R* = r); m* effective mass [kg], defined likewise; S_n = 2Y*√(R*δ) and S_t = 8G*√(R*δ)
//! stiffnesses [N/m]; β damping ratio (see [`crate::restitution`]); γ damping coefficient [N·s/m]; v_n, v_t
//! relative velocity of the surfaces [m/s]. F_n > 0 pushes the bodies apart.
//! Range: δ ≪ r, smooth, elastic. The contact ends at δ = 0, where the damped force pulls slightly.
//! Sources: Johnson, *Contact Mechanics* (1985), ch. 4 and 7; Tsuji, Tanaka & Ishida, Powder Technol. 71, 239
//! (1992); Antypov & Elliott, EPL 94, 50004 (2011).
//!
//! ```
//! use amberfield_laws::hertz_mindlin::{effective_young, normal_force, normal_stiffness};
//! let young = effective_young(1e7, 0.3, 1e7, 0.3);
//! let (radius, overlap) = (5e-4, 1e-6);
//! // F = (2/3) S_n δ
//! let expected = 2.0 / 3.0 * normal_stiffness(young, radius, overlap) * overlap;
//! assert!((normal_force(young, radius, overlap) / expected - 1.0).abs() < 1e-14);
//! ```

/// Factor 2√(5/6) of the damping of a Hertz contact.
pub const DAMPING_FACTOR: f64 = 1.825_741_858_350_553_8;

/// Factor of the elastic contact time: 2 ∫₀¹ dx/√(1 − x^{5/2}) · (15/16)^{2/5} = 2.868….
pub const CONTACT_TIME_FACTOR: f64 = 2.868_265_699_480_853;

/// Effective radius [m] or mass [kg] of two bodies: 1/(1/a + 1/b).
#[inline]
#[must_use]
pub fn effective(a: f64, b: f64) -> f64 {
    a * b / (a + b)
}

/// Effective modulus Y* [Pa] of two bodies with Young's moduli [Pa] and Poisson ratios.
#[must_use]
pub fn effective_young(young_i: f64, poisson_i: f64, young_j: f64, poisson_j: f64) -> f64 {
    1.0 / ((1.0 - poisson_i * poisson_i) / young_i + (1.0 - poisson_j * poisson_j) / young_j)
}

/// Shear modulus G = Y/(2(1 + ν)) [Pa] of an isotropic solid.
#[must_use]
pub fn shear_modulus(young: f64, poisson: f64) -> f64 {
    young / (2.0 * (1.0 + poisson))
}

/// Effective shear modulus G* [Pa] of two bodies with Young's moduli [Pa] and Poisson ratios.
#[must_use]
pub fn effective_shear(young_i: f64, poisson_i: f64, young_j: f64, poisson_j: f64) -> f64 {
    let (g_i, g_j) = (shear_modulus(young_i, poisson_i), shear_modulus(young_j, poisson_j));
    1.0 / ((2.0 - poisson_i) / g_i + (2.0 - poisson_j) / g_j)
}

/// Normal stiffness S_n = 2Y*√(R*δ) [N/m].
#[inline]
#[must_use]
pub fn normal_stiffness(young: f64, radius: f64, overlap: f64) -> f64 {
    2.0 * young * (radius * overlap).sqrt()
}

/// Tangential stiffness S_t = 8G*√(R*δ) [N/m].
#[inline]
#[must_use]
pub fn tangential_stiffness(shear: f64, radius: f64, overlap: f64) -> f64 {
    8.0 * shear * (radius * overlap).sqrt()
}

/// Elastic normal force (4/3) Y*√R* δ^{3/2} [N].
#[inline]
#[must_use]
pub fn normal_force(young: f64, radius: f64, overlap: f64) -> f64 {
    4.0 / 3.0 * young * (radius * overlap).sqrt() * overlap
}

/// Elastic energy (8/15) Y*√R* δ^{5/2} [J] of the normal spring.
#[inline]
#[must_use]
pub fn normal_energy(young: f64, radius: f64, overlap: f64) -> f64 {
    8.0 / 15.0 * young * (radius * overlap).sqrt() * overlap * overlap
}

/// Damping coefficient γ = 2√(5/6) β √(S m*) [N·s/m].
#[inline]
#[must_use]
pub fn damping(damping_ratio: f64, stiffness: f64, mass: f64) -> f64 {
    DAMPING_FACTOR * damping_ratio * (stiffness * mass).sqrt()
}

/// Duration [s] of an elastic head-on collision: 2.868 (m*²/(R* Y*² v))^{1/5}, v approach speed [m/s].
#[must_use]
pub fn contact_time(young: f64, radius: f64, mass: f64, speed: f64) -> f64 {
    CONTACT_TIME_FACTOR * (mass * mass / (radius * young * young * speed)).powf(0.2)
}

/// Largest overlap [m] of an elastic head-on collision: (15 m* v²/(16 Y* √R*))^{2/5}.
#[must_use]
pub fn largest_overlap(young: f64, radius: f64, mass: f64, speed: f64) -> f64 {
    (15.0 * mass * speed * speed / (16.0 * young * radius.sqrt())).powf(0.4)
}

/// Largest overlap [m] of a damped head-on collision, 0 ≤ β < 1:
/// δ_max^{5/4} = (v/ω) exp(−(β/√(1−β²)) acos β), ω = √(4k/(5m*)), k = (4/3)Y*√R*
/// (Antypov & Elliott map the contact onto a damped linear oscillator).
#[must_use]
pub fn largest_overlap_damped(young: f64, radius: f64, mass: f64, speed: f64, damping_ratio: f64) -> f64 {
    let k = 4.0 / 3.0 * young * radius.sqrt();
    let omega = (4.0 * k / (5.0 * mass)).sqrt();
    let decay = damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt() * damping_ratio.acos();
    (speed / omega * (-decay).exp()).powf(0.8)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off through a power.
    const ROUND_OFF: f64 = 1e-13;
    /// Error of a central difference with relative step 1e-5.
    const DIFFERENCE: f64 = 1e-8;

    #[test]
    fn exact_points() {
        assert!((normal_force(3.0, 4.0, 1.0) - 8.0).abs() < ROUND_OFF);
        assert!((normal_stiffness(3.0, 4.0, 1.0) - 12.0).abs() < ROUND_OFF);
        assert!((tangential_stiffness(3.0, 4.0, 1.0) - 48.0).abs() < ROUND_OFF);
        assert!((effective_young(2.0, 0.0, 2.0, 0.0) - 1.0).abs() < ROUND_OFF);
        assert!((effective_shear(4.0, 0.0, 4.0, 0.0) - 0.5).abs() < ROUND_OFF);
        assert!((DAMPING_FACTOR - 2.0 * (5.0_f64 / 6.0).sqrt()).abs() < ROUND_OFF);
    }

    #[test]
    fn stiffness_and_force_are_derivatives() {
        let (y, r, d, h) = (1e7, 1e-3, 1e-6, 1e-11);
        let stiffness = (normal_force(y, r, d + h) - normal_force(y, r, d - h)) / (2.0 * h);
        assert!((normal_stiffness(y, r, d) / stiffness - 1.0).abs() < DIFFERENCE);
        let force = (normal_energy(y, r, d + h) - normal_energy(y, r, d - h)) / (2.0 * h);
        assert!((normal_force(y, r, d) / force - 1.0).abs() < DIFFERENCE);
    }

    #[test]
    fn limits() {
        assert!((effective(1e-3, 1e30) / 1e-3 - 1.0).abs() < ROUND_OFF);
        assert_eq!(normal_force(1e7, 1e-3, 0.0), 0.0);
        let (a, b) =
            (largest_overlap_damped(1e7, 1e-3, 1e-9, 0.3, 0.0), largest_overlap(1e7, 1e-3, 1e-9, 0.3));
        assert!((a / b - 1.0).abs() < ROUND_OFF, "{a} {b}");
        assert!(largest_overlap_damped(1e7, 1e-3, 1e-9, 0.3, 0.4) < a);
    }

    #[test]
    fn symmetric_in_the_bodies() {
        assert_eq!(effective(1.0, 3.0), effective(3.0, 1.0));
        let (a, b) = (effective_young(1e7, 0.2, 3e9, 0.4), effective_young(3e9, 0.4, 1e7, 0.2));
        assert!((a / b - 1.0).abs() < ROUND_OFF);
    }

    #[test]
    fn largest_overlap_balances_energy() {
        let (y, r, m, v) = (1e7, 1e-3, 1e-9, 0.3);
        let energy = normal_energy(y, r, largest_overlap(y, r, m, v));
        assert!((energy / (0.5 * m * v * v) - 1.0).abs() < ROUND_OFF);
    }

    #[test]
    fn contact_time_factor_is_the_integral() {
        // x = 1 − s² takes the root singularity out; midpoint rule.
        let steps = 20_000;
        let width = 1.0 / f64::from(steps);
        let integral: f64 = (0..steps)
            .map(|k| {
                let s = (f64::from(k) + 0.5) * width;
                2.0 * s / (1.0 - (1.0 - s * s).powf(2.5)).sqrt() * width
            })
            .sum();
        let factor = 2.0 * integral * (15.0_f64 / 16.0).powf(0.4);
        assert!((factor / CONTACT_TIME_FACTOR - 1.0).abs() < 1e-8, "{factor:.15}");
    }
}
