//! Case of an electrode in a floor: its field, and the grains that it lifts.

use crate::support::{Case, full_size};
use amberfield_core::Vector3;
use std::f64::consts::PI;
use std::fmt::Write as _;

const VOLTS: f64 = 1000.0;
const HALF_WIDTH_M: f64 = 4e-3;
const PERIOD_M: f64 = 0.02;
const HEIGHT_M: f64 = 0.01;
/// Largest error of E, over the larger of |E| and V₀/H.
const MOST: f64 = 1.2e-2;

/// Field E [V/m] of the electrode alone, by its Fourier series.
fn exact(place: Vector3<f64>) -> Vector3<f64> {
    let mut e = Vector3::z() * (2.0 * HALF_WIDTH_M / PERIOD_M * VOLTS / HEIGHT_M);
    for n in 1..=60 {
        let k = 2.0 * PI * f64::from(n) / PERIOD_M;
        let amplitude = 2.0 * VOLTS / (f64::from(n) * PI) * (k * HALF_WIDTH_M).sin() / (k * HEIGHT_M).sinh();
        let (phase, above) = (k * (place.x - 0.5 * PERIOD_M), k * (HEIGHT_M - place.z));
        e.x += amplitude * k * phase.sin() * above.sinh();
        e.z += amplitude * k * phase.cos() * above.cosh();
    }
    e
}

#[test]
fn field_is_that_of_the_series_and_grains_over_the_electrode_rise() {
    let case = Case::new("electrode-channel");
    let places: Vec<Vector3<f64>> = (0..60)
        .map(|index| {
            let (across, up) = (f64::from(index % 10), f64::from(index / 10));
            Vector3::new(1e-3 + 2e-3 * across, 1e-3 + 4e-4 * across, 3.5e-3 + 1.2e-3 * up)
        })
        .collect();
    // The charges are too small to change the field.
    let mut probes = "id,x_m,y_m,z_m,radius_m,charge_C\n".to_owned();
    for (id, place) in places.iter().enumerate() {
        writeln!(probes, "{id},{},{},{},0,1e-20", place.x, place.y, place.z).expect("a string");
    }
    case.write("probes.csv", &probes);
    let scene = std::fs::read_to_string(case.path("scene.toml")).expect("a scene");
    let line = scene.lines().find(|line| line.starts_with("generate")).expect("it makes its grains");
    case.replace("scene.toml", line, "file = \"probes.csv\"");
    for (found, place) in case.field(&[]).field().iter().zip(&places) {
        let exact = exact(*place);
        let error = (found - exact).norm() / exact.norm().max(VOLTS / HEIGHT_M);
        assert!(error < MOST, "{error:e} at {place:?}");
    }

    let (end, share) = if full_size() { ("end_s = 0.1", 0.8) } else { ("end_s = 0.05", 0.7) };
    case.replace("scene.toml", "file = \"probes.csv\"", line);
    case.replace("scene.toml", "end_s = 0.1", end);
    let over: Vec<_> = case.run(&[]).last_particles().positions();
    let over: Vec<_> = over.iter().filter(|place| (place.x - 0.5 * PERIOD_M).abs() < HALF_WIDTH_M).collect();
    let lifted = over.iter().filter(|place| place.z > 0.9 * HEIGHT_M).count();
    assert!(lifted as f64 > share * over.len() as f64, "{lifted} of {}", over.len());
}
