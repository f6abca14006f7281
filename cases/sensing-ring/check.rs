//! Case of a charge that flies through a sensing ring: induced charge and image current in closed form.

use crate::support::{Case, full_size};
use std::f64::consts::PI;

/// Charge [C] and speed [m/s] of the grain, and where it starts [m].
const CHARGE_C: f64 = 1e-12;
const SPEED_M_S: f64 = 2.0;
const START_M: f64 = -0.024;
/// Radius of the pipe and half the length of the ring [m].
const PIPE_M: f64 = 0.01;
const HALF_RING_M: f64 = 5e-3;
/// Error of the induced charge over the grain's charge, and of the current over the largest one.
const CHARGE: f64 = 1e-2;
const CURRENT: f64 = 2e-2;

/// Modified Bessel function I₀, by its series.
fn bessel_i0(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..200 {
        term *= (x / (2.0 * f64::from(k))).powi(2);
        sum += term;
    }
    sum
}

/// Charge and image current of a ring in an endless grounded pipe, for a grain on the axis at x [m]:
///
/// Q = −(2q/π) ∫ sin(kb) cos(kx)/(k I₀(kR)) dk,  I = dQ/dt = (2qv/π) ∫ sin(kb) sin(kx)/I₀(kR) dk
///
/// from 0 to ∞, with b half the ring's length (Smythe, Static and Dynamic Electricity, 3rd ed., chapter 5).
fn exact(x: f64) -> [f64; 2] {
    let (b, x) = (HALF_RING_M / PIPE_M, x / PIPE_M);
    let (cells, end) = (4000, 40.0);
    let width = end / f64::from(cells);
    let (mut charge, mut current) = (0.0, 0.0);
    for cell in 0..cells {
        let k = (f64::from(cell) + 0.5) * width;
        let weight = width * (k * b).sin() / bessel_i0(k);
        charge += weight * (k * x).cos() / k;
        current += weight * (k * x).sin();
    }
    [-2.0 / PI * CHARGE_C * charge, 2.0 / PI * CHARGE_C * SPEED_M_S / PIPE_M * current]
}

#[test]
fn ring_has_the_charge_and_the_current_of_the_closed_form() {
    let case = Case::new("sensing-ring");
    if !full_size() {
        case.replace("scene.toml", "history_every_s = 4e-4", "history_every_s = 2e-3");
    }
    let history = case.run(&[]).history();
    let column = |name: &str| history.column(name);
    let (times, charges, currents) =
        (column("time_s"), column("conductor_C_ring.stl"), column("conductor_A_ring.stl"));
    assert!(times.len() > 12, "{} rows", times.len());
    let at = |time: f64| exact(START_M + SPEED_M_S * time);
    let largest = times.iter().map(|time| at(*time)[1].abs()).fold(0.0, f64::max);
    let (mut worst_charge, mut worst_current): (f64, f64) = (0.0, 0.0);
    for ((time, charge), current) in times.iter().zip(charges).zip(currents) {
        let [expected, expected_current] = at(*time);
        worst_charge = worst_charge.max((charge - expected).abs() / CHARGE_C);
        worst_current = worst_current.max((current - expected_current).abs() / largest);
    }
    assert!(worst_charge < CHARGE && worst_current < CURRENT, "{worst_charge:e} {worst_current:e}");
    // The whole pipe has minus the grain's charge, while the grain is far from its ends.
    let (inlet, outlet) = (column("conductor_C_inlet.stl"), column("conductor_C_outlet.stl"));
    let middle = times.iter().position(|time| (START_M + SPEED_M_S * time).abs() < 1e-4);
    let middle = middle.expect("a row in the middle of the pipe");
    let all = inlet[middle] + charges[middle] + outlet[middle];
    assert!((all / CHARGE_C + 1.0).abs() < CHARGE, "{all:e} C");
    assert!((inlet[middle] / outlet[middle] - 1.0).abs() < CHARGE, "both sides are alike");
}
