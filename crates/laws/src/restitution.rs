//! Damping ratio of a coefficient of restitution: β = −ln e/√(ln²e + π²).
//!
//! e rebound speed over approach speed, 0 < e ≤ 1; β damping ratio, 0 ≤ β < 1.
//! Range: exact for the linear contact, and for the Hertz contact with the damping γ = 2√(5/6) β √(S_n m*)
//! that ends when the overlap returns to zero (the last part of the rebound then pulls).
//! Source: Antypov & Elliott, EPL 94, 50004 (2011); Tsuji, Tanaka & Ishida, Powder Technol. 71, 239 (1992).
//!
//! ```
//! use amberfield_laws::restitution::damping_ratio;
//! assert_eq!(damping_ratio(1.0), 0.0);
//! assert!((damping_ratio(0.5) - 0.21545).abs() < 1e-5);
//! ```

use std::f64::consts::PI;

/// Damping ratio β for a coefficient of restitution e in (0, 1].
#[must_use]
pub fn damping_ratio(restitution: f64) -> f64 {
    let log = restitution.ln();
    // `-0.0` for e = 1 would be harmless but odd to print.
    (-log / (log * log + PI * PI).sqrt()).abs()
}

/// Coefficient of restitution e = exp(−πβ/√(1 − β²)) for a damping ratio β in [0, 1).
#[must_use]
pub fn restitution_of(damping_ratio: f64) -> f64 {
    (-PI * damping_ratio / (1.0 - damping_ratio * damping_ratio).sqrt()).exp()
}

/// Coefficient of restitution between two materials: the geometric mean √(e_i e_j) of their own values.
///
/// LAMMPS and LIGGGHTS use the same rule where no value for the pair is given.
#[must_use]
pub fn mixed(restitution_i: f64, restitution_j: f64) -> f64 {
    // The root of a square may be off by one rounding; equal materials keep their value.
    if restitution_i == restitution_j { restitution_i } else { (restitution_i * restitution_j).sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off through ln and exp.
    const ROUND_OFF: f64 = 1e-13;

    #[test]
    fn exact_point_and_limit() {
        // ln e = −π gives β = 1/√2.
        assert!((damping_ratio((-PI).exp()) - 0.5_f64.sqrt()).abs() < ROUND_OFF);
        assert_eq!(damping_ratio(1.0), 0.0);
        assert!(damping_ratio(1e-300) > 0.999);
    }

    #[test]
    fn inverse() {
        for e in [0.05, 0.3, 0.5, 0.9, 1.0] {
            assert!((restitution_of(damping_ratio(e)) - e).abs() < ROUND_OFF);
        }
    }

    #[test]
    fn derivative_near_one() {
        // β ≈ (1 − e)/π.
        let h = 1e-6;
        assert!((damping_ratio(1.0 - h) / h * PI - 1.0).abs() < 1e-5);
    }

    #[test]
    fn mixing_is_symmetric() {
        assert_eq!(mixed(0.3, 0.9), mixed(0.9, 0.3));
        assert_eq!(mixed(0.7, 0.7), 0.7);
    }
}
