//! Case of grains that a chute charges and a Faraday cup collects.

use crate::support::{Case, full_size};
use amberfield_core::Vector3;
use amberfield_oracle::HertzImpact;
use std::f64::consts::PI;

const GRAVITY_M_S2: f64 = 9.81;
/// Radius of the single grain [m].
const RADIUS_M: f64 = 5e-4;
/// Round-off of some thousand transfers, over the charge that they moved.
const ROUND_OFF: f64 = 1e-12;
/// Error of the largest overlap with a hundred steps in a contact.
const OVERLAP: f64 = 1e-4;

/// Charge at which a contact of a grain with the chute has no driving term, 2πr²εΔW/(δe) [C].
fn steady_charge_c(radius_m: f64) -> f64 {
    let permittivity = 1.0 / (4.0 * PI * crate::support::COULOMB);
    2.0 * PI * radius_m * radius_m * permittivity * 0.5 / 5e-7
}

#[test]
fn cup_chute_and_grains_in_flight_add_up_to_nothing() {
    for charging in ["grounded", "insulating"] {
        let case = Case::new("faraday-cup");
        case.replace("scene.toml", "charging = \"grounded\"", &format!("charging = \"{charging}\""));
        let mut fed = 500;
        if !full_size() {
            fed = 100;
            case.replace("scene.toml", "count = 500", "count = 100");
            case.replace("scene.toml", "end_s = 0.8", "end_s = 0.4");
            case.replace("scene.toml", "history_every_s = 1e-3", "history_every_s = 2e-3");
        }
        let run = case.run(&[]);
        let history = run.history();
        let column = |name: &str| history.column(name);
        let moved = column("contact_charge_C");
        let (cup, chute, flying) = (column("outlet_C_cup"), column("wall_charge_C"), column("net_charge_C"));
        for row in 0..moved.len() {
            let sum = cup[row] + chute[row] + flying[row];
            assert!(
                sum.abs() <= ROUND_OFF * moved[row],
                "{charging}, row {row}: {sum:e} of {:e}",
                moved[row]
            );
        }
        let last = moved.len() - 1;
        let caught = column("outlet_grains_cup")[last];
        assert!((caught - f64::from(fed)).abs() < 0.5, "{charging}: {caught} of {fed} grains in the cup");
        assert!(chute[last] > 0.0, "the higher work function, the grains', ends negative");

        let grains = case.table("run/outlets_grains.csv");
        let (charges, radii) = (grains.column("charge_C"), grains.column("radius_m"));
        let sum: f64 = charges.iter().sum();
        assert!((sum - cup[last]).abs() <= ROUND_OFF * moved[last], "{sum:e} C in rows, {:e}", cup[last]);
        for (charge, radius) in charges.iter().zip(radii) {
            assert!((-steady_charge_c(*radius)..0.0).contains(charge), "{charging}: {charge:e} C");
        }
    }
}

/// Normal of the chute: 60 mm along x, 35 mm down.
fn normal() -> Vector3<f64> {
    Vector3::new(35.0, 0.0, 60.0).normalize()
}

#[test]
fn one_impact_brings_the_charge_of_the_closed_form() {
    let case = Case::new("faraday-cup");
    for [from, to] in [
        ["count = 500", "count = 1"],
        ["{ uniform = { min = 4e-4, max = 6e-4 } }", "5e-4"],
        ["restitution = 0.5", "restitution = 1.0"],
        ["friction = 0.2", "friction = 0.0"],
        ["step_s = \"auto\"", "step_s = 2e-6"],
        ["end_s = 0.8", "end_s = 0.25"],
        ["\nevery_s = 0.05", "\nevery_s = 0.002"],
        ["[\"vtk\", \"png\"]", "[\"csv\"]"],
    ] {
        case.replace("scene.toml", from, to);
    }
    let run = case.run(&[]);
    // Energy of the motion across the chute, over the mass, soon after the grain has come.
    let frames = run.frames();
    let frame = frames.iter().find(|frame| !frame.grains.positions().is_empty()).expect("the grain");
    let velocity = ["vx_m_s", "vy_m_s", "vz_m_s"].map(|name| frame.grains.column(name)[0]);
    let across = normal().dot(&Vector3::from(velocity));
    let gap = normal().dot(&(frame.grains.positions()[0] - Vector3::new(-0.03, 0.0, 0.06))) - RADIUS_M;
    let pull = GRAVITY_M_S2 * normal().z;
    let pair = HertzImpact::equal_spheres(RADIUS_M, 1000.0, 1e6, 0.3, 1.0);
    let overlap = (0..20).fold(0.0, |overlap, _| {
        let speed = (across * across + 2.0 * pull * (gap + overlap)).sqrt();
        let (reduced_mass, reduced_radius) = (2.0 * pair.reduced_mass, RADIUS_M);
        HertzImpact { reduced_mass, reduced_radius, speed, ..pair }.largest_overlap()
    });
    let expected = -steady_charge_c(RADIUS_M) * (1.0 - (-overlap / (2.0 * RADIUS_M)).exp());

    let history = run.history();
    let last = |name: &str| *history.column(name).last().expect("a row");
    assert!((last("collisions") - 1.0).abs() < 0.5, "{} impacts", last("collisions"));
    let cup = last("outlet_C_cup");
    assert!((cup / expected - 1.0).abs() < OVERLAP, "{cup:e} C in the cup, expected {expected:e} C");
}
