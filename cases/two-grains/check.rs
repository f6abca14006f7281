//! Case of two grains that push each other apart.

use crate::support::{COULOMB, Case};
use amberfield_core::Vector3;

const DISTANCE_M: f64 = 8e-4;
const SPEED_M_S: f64 = 0.103_576_54;
const CHARGE_C: f64 = 1e-12;
/// Tolerance of E in the scene; force, energy and path have errors of the same size.
const TOLERANCE: f64 = 1e-3;

#[test]
fn distance_doubles_in_the_expected_time() {
    let case = Case::new("two-grains");
    let run = case.run(&[]);
    let grains = run.last_particles();
    let places = grains.positions();
    let distance = (places[1] - places[0]).norm();
    assert!((distance / DISTANCE_M - 1.0).abs() < TOLERANCE, "{distance} m apart");
    let speeds = grains.column("vx_m_s");
    assert!(((speeds[1] - speeds[0]) / SPEED_M_S - 1.0).abs() < TOLERANCE, "{speeds:?}");
    // The centre of mass stays where it was: action is reaction to the tolerance, over a path of 0.2 mm.
    let moved = (places[0] + places[1]) * 0.5 - Vector3::repeat(1e-3);
    assert!(moved.norm() < TOLERANCE * 2e-4, "centre of mass moved by {moved:?} m");
}

#[test]
fn field_energy_becomes_motion() {
    let history = Case::new("two-grains").run(&[]).history();
    let kinetic = *history.column("kinetic_J").last().unwrap();
    let gained = COULOMB * CHARGE_C * CHARGE_C / DISTANCE_M;
    // Twice the tolerance of the force: energy is its integral over the path.
    assert!((kinetic / gained - 1.0).abs() < 2.0 * TOLERANCE, "{kinetic:e} J, expected {gained:e} J");
}
