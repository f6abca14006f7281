//! Case of a column of grains that collapses.

use crate::support::{Case, full_size};

const GRAIN_RADIUS_M: f64 = 5e-4;
/// Run-out over the height of the column (Lube et al., 2004).
const SPREAD: f64 = 1.24;
/// Scatter of experiments and effect of the finite size, see the README.
const SCATTER: f64 = 0.15;
/// Kinetic energy of a heap at rest over the energy set free; no picture could show such a motion.
const REST: f64 = 1e-12;

#[test]
fn heap_spreads_as_far_as_measured_and_rests() {
    let case = Case::new("heap");
    let (mut radius, mut height) = (0.012, 0.009);
    if !full_size() {
        // A column half as wide and half as high has an eighth of the grains, and they fall for a shorter
        // time.
        (radius, height) = (0.006, 0.0045);
        case.replace("scene.toml", "count = 4000", "count = 500");
        case.replace(
            "scene.toml",
            "radius_m = 0.012, length_m = 0.009",
            "radius_m = 0.006, length_m = 0.0045",
        );
        case.replace("scene.toml", "end_s = 0.9", "end_s = 0.55");
    }
    let run = case.run(&[]);
    let places = run.last_particles().positions();
    let mean_square = places.iter().map(|place| place.xy().norm_squared()).sum::<f64>() / places.len() as f64;
    let edge = (10.0 / 3.0 * mean_square).sqrt() + GRAIN_RADIUS_M;
    let expected = radius + SPREAD * height;
    assert!((edge / expected - 1.0).abs() < SCATTER, "edge at {edge} m, expected {expected} m");

    let history = run.history();
    let (kinetic, gravity) = (history.column("kinetic_J"), history.column("gravity_J"));
    let set_free = gravity[0] - gravity[gravity.len() - 1];
    let moving = kinetic[kinetic.len() - 1];
    assert!(set_free > 0.0 && moving < REST * set_free, "{moving:e} J left of {set_free:e} J");
}
