//! Case of charged grains that fall between two plates into two bins.

use crate::support::{Case, full_size};
use std::fs;

const GRAVITY_M_S2: f64 = 9.81;
/// Field between the plates, 2V/d [V/m].
const FIELD_V_M: f64 = 32e3;
/// Half of the width over which centres of grains enter: the region less a radius [m].
const HALF_WIDTH_M: f64 = 2e-3 - 2.5e-4;
/// Mean height of fall, from the middle of the feed to the top of the bins [m].
const FALL_M: f64 = 0.295;
/// Allowed error of a deflection: images in the plates and the field's error make a few 1e-4.
const DEFLECTION: f64 = 1e-3;

/// Purity of the bins without neighbours: 2.3 % of a normal distribution are beyond two standard deviations.
const ALONE: f64 = 0.977;
/// Most of the grains that collisions may throw into the wrong bin: 0.11 at full size, where grains that fall
/// through the feed meet new ones, and 0.02 at smoke size, where the feed ends before.
const COLLISIONS: f64 = 0.15;
/// Three standard deviations of the purity of 180 grains of which 2 % are wrong.
const CHANCE: f64 = 0.033;

/// Grain in a bin.
struct Grain {
    is_right: bool,
    is_quartz: bool,
    x_m: f64,
    /// Velocity across the plates [m/s].
    across_m_s: f64,
    /// Velocity of the fall [m/s].
    fall_m_s: f64,
    mass_kg: f64,
    charge_c: f64,
}

/// Runs the case; returns the grains in the bins.
fn separate(case: &Case) -> Vec<Grain> {
    let run = case.run(&[]);
    let table = fs::read_to_string(run.path("outlets_grains.csv")).expect("grains");
    let grain = |line: &str| {
        // step, time_s, outlet, id, material, place, velocity, radius, mass, charge
        let cells: Vec<&str> = line.split(',').collect();
        let number = |cell: usize| cells[cell].parse().expect("a number");
        Grain {
            is_right: cells[2] == "right",
            is_quartz: cells[4] == "quartz",
            x_m: number(5),
            across_m_s: number(8),
            fall_m_s: -number(10),
            mass_kg: number(12),
            charge_c: number(13),
        }
    };
    table.lines().skip(1).map(grain).collect()
}

#[test]
fn grain_without_neighbours_is_deflected_as_by_an_even_field() {
    let case = Case::new("separator");
    // One grain of each material, one after the other, from the middle of a slot without width.
    case.replace("scene.toml", "rate_per_s = 16000", "rate_per_s = 10");
    case.replace("scene.toml", "end_s = 0.1\nseed = 1", "count = 1\nseed = 1");
    case.replace("scene.toml", "end_s = 0.1\nseed = 2", "count = 1\nstart_s = 0.3\nseed = 2");
    case.replace("scene.toml", "std = 1e-12", "std = 0.0");
    case.replace("scene.toml", "[-0.002,", "[-0.000251,");
    case.replace("scene.toml", "[0.002,", "[0.000251,");
    case.replace("scene.toml", "end_s = 0.36", "end_s = 0.6");
    case.replace("scene.toml", "tolerance = 2e-2", "tolerance = 1e-3\ncoupling_interval = 1");
    let grains = separate(&case);
    assert_eq!(grains.len(), 2);
    for grain in grains {
        let falls_s = grain.fall_m_s / GRAVITY_M_S2;
        let acceleration = grain.charge_c * FIELD_V_M / grain.mass_kg;
        let expected = 0.5 * acceleration * falls_s * falls_s;
        assert!((grain.x_m / expected - 1.0).abs() < DEFLECTION, "{} m, expected {expected}", grain.x_m);
        let speed = acceleration * falls_s;
        assert!((grain.across_m_s / speed - 1.0).abs() < DEFLECTION, "{} m/s", grain.across_m_s);
        assert!(grain.is_right == grain.is_quartz && grain.is_right == (grain.charge_c > 0.0));
    }
}

/// Share of the right material in a bin.
fn purity(grains: &[Grain], right: bool) -> f64 {
    let bin = grains.iter().filter(|grain| grain.is_right == right);
    bin.clone().filter(|grain| grain.is_quartz == right).count() as f64 / bin.count() as f64
}

/// Purity if no grain had neighbours: each is deflected from a place that is anywhere in the feed.
fn purity_alone(grains: &[Grain], right: bool, field_v_m: f64) -> f64 {
    let share = |grain: &Grain| {
        let deflected = grain.charge_c * field_v_m / (grain.mass_kg * GRAVITY_M_S2) * FALL_M;
        let to_the_right = (0.5 * (1.0 + deflected / HALF_WIDTH_M)).clamp(0.0, 1.0);
        if right { to_the_right } else { 1.0 - to_the_right }
    };
    let good = grains.iter().filter(|grain| grain.is_quartz == right);
    good.map(share).sum::<f64>() / grains.iter().map(share).sum::<f64>()
}

#[test]
fn neighbours_make_bins_less_pure_the_more_charge_they_carry() {
    let separated = |from: &str, to: &str| {
        let case = Case::new("separator");
        case.replace("scene.toml", from, to);
        if !full_size() {
            case.replace("scene.toml", "end_s = 0.1\n", "end_s = 0.012\n");
            case.replace("scene.toml", "end_s = 0.36", "end_s = 0.27");
            case.replace("scene.toml", "tolerance = 2e-2", "tolerance = 5e-2");
        }
        case
    };
    let strong = separate(&separated("1600 }", "1600 }"));
    // A tenth of the charge in ten times the field: the same fall of each grain alone.
    let case = separated("1600 }", "16000 }");
    case.replace("scene.toml", "2e-12, std = 1e-12", "2e-13, std = 1e-13");
    let weak = separate(&case);
    for right in [false, true] {
        let alone = [purity_alone(&strong, right, FIELD_V_M), purity_alone(&weak, right, 10.0 * FIELD_V_M)];
        let [bound, free] = [purity(&strong, right), purity(&weak, right)];
        assert!(alone.iter().all(|purity| (purity - ALONE).abs() < 0.015), "{alone:?}");
        assert!((ALONE - COLLISIONS..ALONE + CHANCE).contains(&free), "{free} with a tenth of the charge");
        assert!((0.6..free - CHANCE).contains(&bound), "{bound} with neighbours, {free} with weak ones");
    }
}
