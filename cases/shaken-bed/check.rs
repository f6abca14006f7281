//! Case of a shaken bed that charges on its floor up to a predicted mean, and less with breakdown.

use crate::support::{COULOMB, Case, Curve, full_size, plot};
use std::f64::consts::PI;

const RADIUS_M: f64 = 2.5e-4;
const AREA_M2: f64 = 25e-6;
const FREQUENCY_HZ: f64 = 30.0;
/// Difference of the work functions over δe [V/m].
const DRIVING_V_M: f64 = 0.05 / 5e-7;
/// Breakdown field, half of that [V/m].
const BREAKDOWN_V_M: f64 = 5e4;
/// Round-off of some hundred thousand transfers, over the charge that they moved.
const ROUND_OFF: f64 = 1e-12;
/// Charge at the end over that of an even layer: more, since grains keep a distance from the one that
/// touches. A short run may miss the last per cent.
const EVEN: std::ops::Range<f64> = 0.97..1.1;
/// Charge with breakdown over that of an even layer: a half, and more by contacts at which the field of the
/// others helps.
const LIMITED: std::ops::Range<f64> = 0.5..0.7;
/// Swing of the mean charge from row to row, over the charge: grains that have more than their share of the
/// moment give some back.
const SWING: f64 = 0.02;

/// Rows of the history for each point of the plot.
const ROWS: usize = 10;

/// Charge at which a grain alone has no driving term at the plate, without its sign [C].
fn steady_charge_c() -> f64 {
    RADIUS_M * RADIUS_M * DRIVING_V_M / (2.0 * COULOMB)
}

/// Balance with all others spread evenly above the plate.
fn even_layer_c(grains: f64) -> f64 {
    steady_charge_c() / (1.0 + 2.0 * PI * RADIUS_M * RADIUS_M * grains / AREA_M2)
}

/// Mean charge of a grain over shakes.
fn charge(grains: u32, end_s: f64, breakdown: Option<f64>) -> Vec<(f64, f64)> {
    let case = Case::new("shaken-bed");
    case.replace("scene.toml", "count = 200", &format!("count = {grains}"));
    case.replace("scene.toml", "end_s = 2.5", &format!("end_s = {end_s}"));
    if let Some(field) = breakdown {
        let table = format!("[charge_transfer]\nbreakdown_field_V_m = {field:e}\n\n[output]");
        case.replace("scene.toml", "[output]", &table);
    }
    let run = case.run(&[]);
    let history = run.history();
    let (net, plate) = (history.column("net_charge_C"), history.column("wall_charge_C"));
    for (row, moved) in history.column("contact_charge_C").iter().enumerate() {
        assert!((net[row] + plate[row]).abs() <= ROUND_OFF * moved, "{:e} and {:e} C", net[row], plate[row]);
    }
    let mut most = 0.0_f64;
    for charge in net {
        let found = -charge / f64::from(grains);
        assert!(found >= most * (1.0 - SWING), "{grains} grains: {found:e} C after {most:e} C");
        most = most.max(found);
    }
    let shakes = history.column("time_s").iter().map(|time| time * FREQUENCY_HZ);
    shakes.zip(net.iter().map(|charge| charge / f64::from(grains))).collect()
}

#[test]
fn charge_grows_to_that_of_an_even_layer_and_less_with_breakdown() {
    let end = |curve: &[(f64, f64)]| -curve[curve.len() - 1].1;
    let mut curves = Vec::new();
    let runs: &[(u32, f64)] = if full_size() { &[(20, 2.5), (200, 2.5)] } else { &[(60, 1.5)] };
    for &(grains, end_s) in runs {
        let free = charge(grains, end_s, None);
        let even = even_layer_c(f64::from(grains));
        let share = end(&free) / even;
        assert!(EVEN.contains(&share), "{grains} grains: {share} of an even layer's charge");
        let limited = charge(grains, end_s, Some(BREAKDOWN_V_M));
        let share = end(&limited) / even;
        assert!(LIMITED.contains(&share), "{grains} grains, breakdown: {share} of an even layer's charge");
        let shakes = free[free.len() - 1].0;
        let expected = vec![(0.5 * shakes, -even), (shakes, -even)];
        let drawn = |curve: &[(f64, f64)]| curve.iter().step_by(ROWS).copied().collect();
        for (name, points) in
            [("", drawn(&free)), (", breakdown", drawn(&limited)), (", even layer", expected)]
        {
            curves.push(Curve { name: format!("N = {grains}{name}"), points });
        }
    }
    plot("shaken-bed", "charge", ["shakes", "charge per grain [C]"], false, curves);
}
