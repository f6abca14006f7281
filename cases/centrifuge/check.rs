//! Case of a grain in a drum that turns.

use crate::support::Case;
use std::f64::consts::TAU;

/// Largest angle that a grain falls behind the wall, by creep of the springs of friction [rad].
const CREEP: f64 = 0.05;
/// Angles by which faces of 2° and their edges shake a grain that slides [rad].
const FACES: f64 = 0.05;

/// Angle of the grain from the lowest place, in the sense of the drum, over time, for turns in a minute.
fn angles(rpm: f64, velocity: &str) -> Vec<(f64, f64)> {
    let case = Case::new("centrifuge");
    case.replace("scene.toml", "rpm = 265.8", &format!("rpm = {rpm}"));
    case.replace("grains.csv", "-0.52884,27.834", velocity);
    let run = case.run(&[]);
    let angle = |place: amberfield_core::Vector3<f64>| (-place.x).atan2(-place.z);
    run.frames().iter().map(|frame| (frame.time_s, angle(frame.grains.positions()[0]))).collect()
}

#[test]
fn grain_turns_with_a_fast_drum() {
    let omega = 265.8 / 60.0 * TAU;
    for (time, angle) in angles(265.8, "-0.52884,27.834") {
        let behind = (omega * time - angle + 0.5 * TAU).rem_euclid(TAU) - 0.5 * TAU;
        assert!(behind.abs() < CREEP, "{behind} rad behind the wall after {time} s");
    }
}

/// Angle between two at which a grain that slips with μ = 1 since the angle `slips`, at the speed of the wall
/// with ω²R_c = 0.2 g, turns back: θ̇² = 0.
///
/// R_c θ̈ = −g (sin θ − cos θ) + R_c θ̇² is linear in u = R_c θ̇²/g as a function of θ, u′ = 2u − 2 (sin θ −
/// cos θ), with the solution u = (6 sin θ − 2 cos θ)/5 + C exp(2θ).
fn turns_back(slips: f64, [mut still, mut moving]: [f64; 2]) -> f64 {
    let particular = |angle: f64| (6.0 * angle.sin() - 2.0 * angle.cos()) / 5.0;
    let constant = (0.2 - particular(slips)) / (2.0 * slips).exp();
    for _ in 0..60 {
        let middle = 0.5 * (still + moving);
        let squared_speed = particular(middle) + constant * (2.0 * middle).exp();
        *(if squared_speed < 0.0 { &mut still } else { &mut moving }) = middle;
    }
    still
}

#[test]
fn grain_slides_back_in_a_slow_drum() {
    let found = angles(97.0, "-0.1930,10.158");
    let slips = TAU / 8.0 + (0.2 / 2.0_f64.sqrt()).asin();
    let (highest, lowest) = (turns_back(slips, [TAU / 4.0, slips]), turns_back(slips, [0.0, slips]));
    let extreme = |found: &[(f64, f64)], sign: f64| {
        let best = found.iter().enumerate().max_by(|a, b| (sign * a.1.1).total_cmp(&(sign * b.1.1)));
        best.map(|(place, (_, angle))| (place, *angle)).expect("frames")
    };
    let (top, angle) = extreme(&found, 1.0);
    assert!((angle - highest).abs() < FACES, "{angle} rad, {highest} expected");
    let (_, angle) = extreme(&found[top..], -1.0);
    assert!((angle - lowest).abs() < 2.0 * FACES, "{angle} rad, {lowest} expected");
}
