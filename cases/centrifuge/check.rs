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

#[test]
fn grain_slides_back_in_a_slow_drum() {
    let found = angles(97.0, "-0.1930,10.158");
    let highest = found.iter().map(|(_, angle)| *angle).fold(f64::MIN, f64::max);
    let slips = 0.25 * TAU / 2.0 + (0.2 / 2.0_f64.sqrt()).asin();
    assert!(highest < slips + FACES && highest > slips - 2.0 * FACES, "{highest} rad, {slips} expected");
    let last = found[found.len() - 1].1;
    assert!((last - TAU / 8.0).abs() < 2.0 * FACES, "{last} rad at the end");
}
