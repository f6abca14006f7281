//! Case of two materials that charge each other up to a predicted mean.

use crate::support::{Case, Curve, full_size, plot};
use std::fs;

/// Steady charge 2πr²εΔW/(δe) with r = 75 µm, ΔW = 0.02 eV and δ = 0.5 µm [C].
const STEADY_C: f64 = 6.2587e-13 * 0.02;
const BREAKDOWN_V_M: f64 = 2e4;
/// Share that the field of the other grains adds on average over impacts.
const MEAN: f64 = 0.02;
/// Charge under a breakdown field over the steady charge: a half, and more by impacts at which the field of
/// the other grains helps.
const LIMITED: std::ops::Range<f64> = 0.5..0.65;
/// Growth of the charge in the last third of the run, over the charge.
const CREEP: f64 = 0.03;

/// Mean charges of the two materials at one moment.
#[derive(Clone, Copy)]
struct MeanCharges {
    time_s: f64,
    /// Mean charge of the lower work function [C].
    low: f64,
    /// Mean charge of the higher work function [C].
    high: f64,
}

/// Result of a run.
struct Charging {
    /// Mean charges over time.
    means: Vec<MeanCharges>,
    /// Charges of all grains at the end [C].
    charges: Vec<f64>,
}

/// Runs the case, with a breakdown field [V/m] if there is one.
fn charge(breakdown: Option<f64>) -> Charging {
    let case = Case::new("two-materials");
    if let Some(limit) = breakdown {
        let text = fs::read_to_string(case.path("scene.toml")).expect("a scene");
        case.write("scene.toml", &format!("{text}\n[charge_transfer]\nbreakdown_field_V_m = {limit:e}\n"));
    }
    if !full_size() {
        case.replace("scene.toml", "end_s = 0.07", "end_s = 0.006");
        case.replace("scene.toml", "\nevery_s = 0.01", "\nevery_s = 0.001");
    }
    let names = fs::read_to_string(case.path("grains.csv")).expect("grains");
    let high: Vec<bool> = names.lines().skip(1).map(|line| line.ends_with("high")).collect();
    let run = case.run(&[]);
    let mut means = Vec::new();
    let mut last = Vec::new();
    for frame in run.frames() {
        let charge = frame.grains.column("charge_C");
        let mean = |of: bool| {
            let some = charge.iter().zip(&high).filter(|(_, high)| **high == of).map(|(charge, _)| charge);
            2.0 * some.sum::<f64>() / charge.len() as f64
        };
        let moved: f64 = charge.iter().map(|charge| charge.abs()).sum();
        assert!(charge.iter().sum::<f64>().abs() <= 1e-12 * moved, "no charge is lost");
        means.push(MeanCharges { time_s: frame.time_s, low: mean(false), high: mean(true) });
        last = charge.to_vec();
    }
    for (of, sign) in [(false, 1.0), (true, -1.0)] {
        let all = last.iter().zip(&high).filter(|(_, high)| **high == of).count() as f64;
        let right =
            last.iter().zip(&high).filter(|(q, high)| **high == of && sign * **q > 0.0).count() as f64;
        assert!(right > 0.9 * all, "{right} of {all} have the sign of their work function");
    }
    Charging { means, charges: last }
}

#[test]
fn the_higher_work_function_ends_negative_at_the_predicted_mean() {
    let Charging { means: free, charges } = charge(None);
    let limited = charge(Some(BREAKDOWN_V_M)).means;
    let last = |means: &[MeanCharges]| *means.last().expect("a frame");
    let MeanCharges { low, high, .. } = last(&free);
    assert!((low + high).abs() < 1e-9 * STEADY_C);
    let limit = last(&limited).low;
    if full_size() {
        assert!((low / STEADY_C - 1.0).abs() < MEAN, "{low:e} for {STEADY_C:e}");
        assert!(LIMITED.contains(&(limit / STEADY_C)), "{limit:e}");
        let before = limited[2 * limited.len() / 3].low;
        assert!(limit - before < CREEP * limit, "{before:e} {limit:e}");
    }
    assert!(limit < low && low < (1.0 + MEAN) * STEADY_C, "{limit:e} {low:e}");
    assert!(limit > 0.2 * STEADY_C && limit < LIMITED.end * STEADY_C, "{limit:e}");
    let curve = |name: &str, means: &[MeanCharges], of: fn(&MeanCharges) -> f64| {
        let points = means.iter().map(|means| (means.time_s, of(means))).collect();
        Curve { name: name.to_owned(), points }
    };
    let predicted =
        Curve { name: "predicted".into(), points: vec![(0.0, STEADY_C), (last(&free).time_s, STEADY_C)] };
    let curves = vec![
        curve("4.00 eV", &free, |means| means.low),
        curve("4.02 eV", &free, |means| means.high),
        curve("4.00 eV, breakdown at 20 kV/m", &limited, |means| means.low),
        predicted,
    ];
    plot("two-materials", "mean-charge", ["time [s]", "mean charge [C]"], false, curves);
    let bins = 40;
    let width = 4.0 * STEADY_C / f64::from(bins);
    let count = |bin: i32| {
        let low = width * f64::from(bin) - 2.0 * STEADY_C;
        (low + 0.5 * width, charges.iter().filter(|q| (low..low + width).contains(q)).count() as f64)
    };
    let curve = Curve { name: "at the end".into(), points: (0..bins).map(count).collect() };
    plot("two-materials", "charge-histogram", ["charge [C]", "grains in a bin"], false, vec![curve]);
}
