//! Case of a ball that charges on a grounded plate, bounce by bounce.

use crate::support::{Case, Curve, full_size, plot};
use amberfield_oracle::HertzImpact;

const RADIUS_M: f64 = 75e-6;
const GRAVITY_M_S2: f64 = 9.81;
const STEADY_C: f64 = -6.2587e-13;
/// Error of the integration with more than 300 steps in a contact, 90 times in a row.
const ERROR: f64 = 5e-4;

/// Product αA_max of one bounce from a height of one diameter.
fn relaxation() -> f64 {
    let pair = HertzImpact::equal_spheres(RADIUS_M, 1000.0, 1e5, 0.3, 1.0);
    let fall = |overlap: f64| (2.0 * GRAVITY_M_S2 * (2.0 * RADIUS_M + overlap)).sqrt();
    let overlap = (0..20).fold(0.0, |overlap, _| {
        let (reduced_mass, reduced_radius) = (2.0 * pair.reduced_mass, RADIUS_M);
        HertzImpact { reduced_mass, reduced_radius, speed: fall(overlap), ..pair }.largest_overlap()
    });
    overlap / (2.0 * RADIUS_M)
}

#[test]
fn charge_follows_the_closed_form() {
    let case = Case::new("charging-on-a-wall");
    if !full_size() {
        case.replace("scene.toml", "end_s = 1.0", "end_s = 0.25");
        case.replace("scene.toml", "every_s = 0.5", "every_s = 0.25");
        case.replace("scene.toml", "history_every_s = 1e-3", "history_every_s = 1e-4");
    }
    let run = case.run(&[]);
    let history = run.history();
    let (charge, wall) = (history.column("net_charge_C"), history.column("wall_charge_C"));
    let contacts = history.column("contacts");
    // Between two bounces the charge is constant for some rows.
    let mut bounces: Vec<f64> = Vec::new();
    for row in 1..charge.len() {
        let rests = contacts[row] == 0.0 && contacts[row - 1] == 0.0 && charge[row] == charge[row - 1];
        if rests && charge[row] != 0.0 && bounces.last() != Some(&charge[row]) {
            bounces.push(charge[row]);
        }
        assert!((charge[row] + wall[row]).abs() <= 1e-13 * charge[row].abs());
    }
    assert!(bounces.len() > 15, "{}", bounces.len());
    let expected = |n: usize| STEADY_C * (1.0 - (-(n as f64 + 1.0) * relaxation()).exp());
    for (n, charge) in bounces.iter().enumerate() {
        let error = charge / expected(n) - 1.0;
        assert!(error.abs() < ERROR, "bounce {}: {charge:e} for {:e}", n + 1, expected(n));
    }
    let points = |of: &dyn Fn(usize) -> f64| (0..bounces.len()).map(|n| (n as f64 + 1.0, of(n))).collect();
    let curves = vec![
        Curve { name: "run".to_owned(), points: points(&|n| bounces[n]) },
        Curve { name: "closed form".to_owned(), points: points(&expected) },
    ];
    plot("charging-on-a-wall", "bounces", ["bounces", "charge [C]"], false, curves);
}
