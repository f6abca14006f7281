//! Vibration that begins where a body stands: s = A [sin(2πft + φ) − sin φ].
//!
//! s displacement and A amplitude, of one unit; f frequency [Hz]; t time since the begin [s]; φ phase [rad].
//! The velocity is 2πf A cos(2πft + φ). A grain lies on a plate that vibrates upwards as long as Γ =
//! A(2πf)²/g < 1; for Γ > 1 it leaves where sin(2πft) = 1/Γ.
//! Range: any values. Whole periods give the same place, exactly.
//! Source: Luck & Mehta, Phys. Rev. E 48, 3988 (1993).
//!
//! ```
//! use amberfield_laws::vibration::{displacement, rate};
//! assert_eq!(displacement(50.0, 0.0, 0.005), 1.0);
//! assert_eq!(rate(50.0, 0.0, 0.0), std::f64::consts::TAU * 50.0);
//! ```

use std::f64::consts::TAU;

/// s/A at a time [s], for a frequency [Hz] and a phase [rad].
#[must_use]
pub fn displacement(frequency: f64, phase: f64, time: f64) -> f64 {
    angle(frequency, phase, time).sin() - phase.sin()
}

/// ds/dt over A [1/s].
#[must_use]
pub fn rate(frequency: f64, phase: f64, time: f64) -> f64 {
    TAU * frequency * angle(frequency, phase, time).cos()
}

/// 2πft + φ less whole periods.
fn angle(frequency: f64, phase: f64, time: f64) -> f64 {
    let periods = frequency * time;
    TAU * (periods - periods.floor()) + phase
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn begins_at_home_and_repeats() {
        for phase in [0.0, 0.7, -2.0] {
            assert_eq!(displacement(8.0, phase, 0.0), 0.0);
            assert_eq!(displacement(8.0, phase, 1e3), 0.0);
            assert_eq!(displacement(8.0, phase, 0.03), displacement(8.0, phase, 0.125 + 0.03));
        }
    }

    #[test]
    fn rate_is_the_derivative() {
        let (h, time) = (1e-6, 0.0123);
        let slope = (displacement(8.0, 0.4, time + h) - displacement(8.0, 0.4, time - h)) / (2.0 * h);
        assert!((slope / rate(8.0, 0.4, time) - 1.0).abs() < 1e-8);
    }
}
