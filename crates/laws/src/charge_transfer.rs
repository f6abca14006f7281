//! Charge transfer while a contact area grows: dT/dA = ε [(W_i − W_j)/(δe) + E_c·n_ij] = β − αT.
//!
//! T charge moved from i to j since first touch [C], so that q_i −= T and q_j += T; A contact area [m²]; ε
//! permittivity [F/m]; W work functions [J]; δ cut-off distance of the transfer [m]; e elementary charge [C];
//! E_c field at the contact [V/m], which includes that of the two colliding bodies; n_ij unit vector from i
//! to j. With E_x the field of everything else [V/m], r the radii [m], E_Q·n the field of the charge that an
//! insulator keeps around the contact [V/m], and A_f the area over which it keeps what this contact leaves
//! [m²], both of [`crate::kept_charge`],
//!
//! ```text
//! two grains               α = (1/r_i² + 1/r_j²)/(4π)
//!                          β = ε(W_i − W_j)/(δe) + q_i/(4πr_i²) − q_j/(4πr_j²) + ε E_x·n_ij
//! grain, grounded wall     α = 1/(2πr²)
//!                          β = ε(W_p − W_w)/(δe) + q/(2πr²) + ε E_x·n_pw
//! grain, insulating wall   α = 1/(4πr²) + 1/(2A_f)
//!                          β = ε(W_p − W_w)/(δe) + q/(4πr²) + ε E_Q·n_pw + ε E_x·n_pw
//! ```
//!
//! While the area grows by ΔA, T = (β/α)(1 − e^{−αΔA}). This is exact for a single contact and bounded for
//! any ΔA, whereas the explicit step βΔA is unstable beyond αΔA = 2. A contact whose area shrinks moves no
//! charge. The body with the higher work function ends negative.
//! Range: overlaps small against the radii.
//! Source: J. Kolehmainen, A. Ozel, C. M. Boyce & S. Sundaresan, AIChE J. 63, 1872 (2017), with its signs
//! made consistent.
//!
//! ```
//! use amberfield_laws::charge_transfer::{ChargedSphere, between_grains};
//! let left = ChargedSphere { charge: 1e-13, radius: 75e-6 };
//! let right = ChargedSphere { charge: -1e-13, radius: 75e-6 };
//! let drive = between_grains(8.854e-12, 0.0, [left, right], 0.0);
//! let moved = drive.transfer(1e-12);
//! assert!(moved > 0.0 && moved < 1e-13);
//! ```

use std::f64::consts::PI;

/// Charge and size of a colliding grain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChargedSphere {
    /// Charge [C].
    pub charge: f64,
    /// Radius [m].
    pub radius: f64,
}

/// Charge that an insulating wall keeps around a contact.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChargeOfInsulator {
    /// Normal field of it at the contact, positive from the wall to the grain: −E_Q·n_pw [V/m].
    pub normal_field: f64,
    /// Growth of ε times that field per charge that the contact leaves, 1/(2A_f) [1/m²].
    pub per_charge: f64,
}

/// Coefficients of the transfer through one contact: dT/dA = β − αT.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// Decay α [1/m²], positive.
    pub decay: f64,
    /// Drive β [C/m²], the transfer per area at T = 0.
    pub drive: f64,
}

impl Drive {
    /// Charge moved from i to j [C] while the area grows by `growth` [m²].
    #[must_use]
    pub fn transfer(self, growth: f64) -> f64 {
        // `exp_m1` keeps all digits where αΔA is small, as in nearly every step.
        -self.drive / self.decay * (-self.decay * growth).exp_m1()
    }
}

/// Contact potential's share of the drive, ε(W_i − W_j)/(δe) [C/m²]: permittivity ε [F/m], work functions
/// [eV], cut-off distance δ [m].
#[must_use]
pub fn work_term(permittivity: f64, work_functions_ev: [f64; 2], cutoff_m: f64) -> f64 {
    permittivity * (work_functions_ev[0] - work_functions_ev[1]) / cutoff_m
}

/// Drive between grain i and grain j: permittivity [F/m], `work` from [`work_term`] [C/m²], `field` =
/// E_x·n_ij [V/m].
#[must_use]
pub fn between_grains(permittivity: f64, work: f64, [i, j]: [ChargedSphere; 2], field: f64) -> Drive {
    let [per_i, per_j] = [i, j].map(|grain| 1.0 / (4.0 * PI * grain.radius * grain.radius));
    let own = i.charge * per_i - j.charge * per_j;
    Drive { decay: per_i + per_j, drive: work + own + permittivity * field }
}

/// Drive between a grain and a grounded wall: permittivity [F/m], `work` from [`work_term`] [C/m²], `field` =
/// E_x·n_pw [V/m] without the grain's own image.
#[must_use]
pub fn with_grounded_wall(permittivity: f64, work: f64, grain: ChargedSphere, field: f64) -> Drive {
    // The image doubles the grain's own field at the wall: 2πr² instead of 4πr².
    let per_area = 1.0 / (2.0 * PI * grain.radius * grain.radius);
    Drive { decay: per_area, drive: work + grain.charge * per_area + permittivity * field }
}

/// Drive between a grain and an insulating wall: permittivity [F/m], `work` from [`work_term`] [C/m²],
/// `field` = E_x·n_pw [V/m] without the kept charge's.
#[must_use]
pub fn with_insulating_wall(
    permittivity: f64,
    work: f64,
    grain: ChargedSphere,
    kept: ChargeOfInsulator,
    field: f64,
) -> Drive {
    let per_area = 1.0 / (4.0 * PI * grain.radius * grain.radius);
    let own = grain.charge * per_area - permittivity * kept.normal_field;
    Drive { decay: per_area + kept.per_charge, drive: work + own + permittivity * field }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERMITTIVITY: f64 = 8.854_187_812_8e-12;
    const CUTOFF: f64 = 5e-7;
    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-13;

    fn pair(qi: f64, qj: f64) -> [ChargedSphere; 2] {
        [ChargedSphere { charge: qi, radius: 1e-4 }, ChargedSphere { charge: qj, radius: 3e-4 }]
    }

    #[test]
    fn single_bounces_add_up_to_the_closed_form() {
        let [mut i, mut j] = pair(3e-13, -1e-13);
        let work = work_term(PERMITTIVITY, [4.5, 4.2], CUTOFF);
        let whole = between_grains(PERMITTIVITY, work, [i, j], 2e4).transfer(1e-8);
        let mut moved = 0.0;
        for _ in 0..100 {
            let part = between_grains(PERMITTIVITY, work, [i, j], 2e4).transfer(1e-10);
            i.charge -= part;
            j.charge += part;
            moved += part;
        }
        assert!((moved - whole).abs() < 1e2 * ROUND_OFF * whole.abs(), "{moved:e} {whole:e}");
    }

    #[test]
    fn small_growth_is_the_derivative_and_large_growth_the_steady_state() {
        let drive = between_grains(PERMITTIVITY, 1e-6, pair(1e-13, 0.0), -3e3);
        let small = 1e-9 / drive.decay;
        assert!((drive.transfer(small) / (drive.drive * small) - 1.0).abs() < 1e-8);
        assert_eq!(drive.transfer(1e9 / drive.decay), drive.drive / drive.decay);
        assert_eq!(drive.transfer(0.0), 0.0);
    }

    #[test]
    fn exchange_of_names_turns_the_sign() {
        let [i, j] = pair(1e-13, 2e-13);
        let work = work_term(PERMITTIVITY, [4.0, 5.0], CUTOFF);
        let there = between_grains(PERMITTIVITY, work, [i, j], 1e3);
        let back = between_grains(PERMITTIVITY, -work, [j, i], -1e3);
        assert_eq!(there.decay, back.decay);
        assert!((there.drive + back.drive).abs() < ROUND_OFF * there.drive.abs());
    }

    #[test]
    fn higher_work_function_ends_negative() {
        // i holds on to its electrons: what moves from i to j is positive, and i ends negative.
        let work = work_term(PERMITTIVITY, [5.0, 4.0], CUTOFF);
        let moved = between_grains(PERMITTIVITY, work, pair(0.0, 0.0), 0.0).transfer(1e-10);
        assert!(-moved < 0.0);
    }

    #[test]
    fn one_electronvolt_on_a_grounded_wall() {
        let grain = ChargedSphere { charge: 0.0, radius: 75e-6 };
        let drive = with_grounded_wall(PERMITTIVITY, work_term(PERMITTIVITY, [1.0, 0.0], CUTOFF), grain, 0.0);
        let equilibrium = -drive.transfer(1e3 / drive.decay);
        assert!((equilibrium / -6.2587e-13 - 1.0).abs() < 1e-5, "{equilibrium:e}");
    }

    #[test]
    fn bare_insulator_is_a_conductor_and_kept_charge_repels() {
        let grain = ChargedSphere { charge: 1e-13, radius: 75e-6 };
        let area = 2.0 * PI * 75e-6_f64.powi(2);
        let with_charge = |charge: f64| {
            let kept = ChargeOfInsulator {
                normal_field: charge / (2.0 * area * PERMITTIVITY),
                per_charge: 0.5 / area,
            };
            with_insulating_wall(PERMITTIVITY, 0.0, grain, kept, 0.0)
        };
        let neutral = ChargedSphere { charge: 0.0, ..grain };
        let bare = ChargeOfInsulator { normal_field: 0.0, per_charge: 0.5 / area };
        let insulator = with_insulating_wall(PERMITTIVITY, 1e-6, neutral, bare, 2e4);
        let conductor = with_grounded_wall(PERMITTIVITY, 1e-6, neutral, 2e4);
        assert!((insulator.decay / conductor.decay - 1.0).abs() < ROUND_OFF);
        assert_eq!(insulator.drive, conductor.drive);
        assert!(with_charge(1e-13).drive < with_charge(0.0).drive);
        // The charge that was left drives back as much as the grain's own drives on.
        assert!(with_charge(1e-13).drive.abs() < ROUND_OFF * with_charge(0.0).drive);
    }
}
