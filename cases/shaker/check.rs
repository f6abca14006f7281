//! Case of a grain on a plate that shakes.

use crate::support::Case;
use std::f64::consts::{FRAC_PI_2, TAU};

const AMPLITUDE_M: f64 = 1e-3;
const GRAVITY_M_S2: f64 = 9.81;
/// Time in which a contact of the stiffness lets go or is found [s].
const CONTACT_S: f64 = 1e-4;

/// Times at which the grain touches, over a run at a frequency [Hz].
fn touching(frequency_hz: f64) -> Vec<(f64, bool)> {
    let case = Case::new("shaker");
    case.replace("scene.toml", "frequency_Hz = 22.29", &format!("frequency_Hz = {frequency_hz}"));
    let history = case.run(&[]).history();
    let contacts = history.column("contacts").iter().map(|count| *count > 0.0);
    history.column("time_s").iter().copied().zip(contacts).collect()
}

#[test]
fn grain_stays_below_and_flies_above_the_acceleration_of_gravity() {
    for gamma in [0.5, 0.9] {
        let omega = (gamma * GRAVITY_M_S2 / AMPLITUDE_M).sqrt();
        assert!(touching(omega / TAU).iter().all(|(_, touches)| *touches), "it left at Γ = {gamma}");
    }
    for gamma in [1.5, 2.0, 3.0] {
        let omega: f64 = (gamma * GRAVITY_M_S2 / AMPLITUDE_M).sqrt();
        // φ at which it leaves, and the first at which the parabola meets the sine again.
        let leaves = (1.0 / gamma).asin();
        let above = |phi: f64| {
            let time = (phi - leaves) / omega;
            let flown = (leaves.sin() + (phi - leaves) * leaves.cos()) * AMPLITUDE_M;
            flown - 0.5 * GRAVITY_M_S2 * time * time - AMPLITUDE_M * phi.sin()
        };
        let mut lands = leaves + 0.5;
        while above(lands) > 0.0 {
            lands += 1e-5;
        }
        let time = |phi: f64| (phi + FRAC_PI_2) / omega;
        let found = touching(omega / TAU);
        let left = found.iter().position(|(_, touches)| !touches).expect("it leaves");
        let landed = left + found[left..].iter().position(|(_, touches)| *touches).expect("it lands");
        let (left, landed) = (found[left].0, found[landed].0);
        assert!(
            (left - time(leaves)).abs() < CONTACT_S,
            "Γ = {gamma}: left after {left} s, {}",
            time(leaves)
        );
        assert!((landed - time(lands)).abs() < CONTACT_S, "Γ = {gamma}: {landed} s, {}", time(lands));
    }
}
