//! Two materials charge each other up to a predicted mean.

use crate::support::{Case, Curve, full_size, plot};
use std::fs;

/// 2πr²εΔW/(δe) with r = 75 µm, ΔW = 0.02 eV, δ = 0.5 µm [C].
const STEADY_C: f64 = 6.2587e-13 * 0.02;
const BREAKDOWN_V_M: f64 = 2e4;
/// What the field of the others adds on average over impacts.
const MEAN: f64 = 0.02;
/// Under a breakdown field: half of the steady charge, and what impacts add at which the field of the others helps.
const LIMITED: std::ops::Range<f64> = 0.5..0.65;
/// Growth of the charge in the last third of the run, over the charge.
const CREEP: f64 = 0.03;

/// Mean charges of the two materials over time [C], and the last frame's charges.
fn means(breakdown: Option<f64>) -> (Vec<[f64; 3]>, Vec<f64>) {
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
    let mut frames = Vec::new();
    let mut last = Vec::new();
    for (time, table) in run.frames() {
        let charge = table.column("charge_C");
        let mean = |of: bool| {
            let some = charge.iter().zip(&high).filter(|(_, high)| **high == of).map(|(charge, _)| charge);
            2.0 * some.sum::<f64>() / charge.len() as f64
        };
        let moved: f64 = charge.iter().map(|charge| charge.abs()).sum();
        assert!(charge.iter().sum::<f64>().abs() <= 1e-12 * moved, "no charge is lost");
        frames.push([time, mean(false), mean(true)]);
        last = charge.to_vec();
    }
    for (of, sign) in [(false, 1.0), (true, -1.0)] {
        let all = last.iter().zip(&high).filter(|(_, high)| **high == of).count() as f64;
        let right =
            last.iter().zip(&high).filter(|(q, high)| **high == of && sign * **q > 0.0).count() as f64;
        assert!(right > 0.9 * all, "{right} of {all} have the sign of their work function");
    }
    (frames, last)
}

#[test]
fn the_higher_work_function_ends_negative_at_the_predicted_mean() {
    let (free, charges) = means(None);
    let (limited, _) = means(Some(BREAKDOWN_V_M));
    let last = |frames: &[[f64; 3]]| *frames.last().expect("a frame");
    let [_, low, high] = last(&free);
    assert!((low + high).abs() < 1e-9 * STEADY_C);
    let limit = last(&limited)[1];
    if full_size() {
        assert!((low / STEADY_C - 1.0).abs() < MEAN, "{low:e} for {STEADY_C:e}");
        assert!(LIMITED.contains(&(limit / STEADY_C)), "{limit:e}");
        let before = limited[2 * limited.len() / 3][1];
        assert!(limit - before < CREEP * limit, "{before:e} {limit:e}");
    }
    assert!(limit < low && low < (1.0 + MEAN) * STEADY_C, "{limit:e} {low:e}");
    assert!(limit > 0.2 * STEADY_C && limit < LIMITED.end * STEADY_C, "{limit:e}");
    let curve = |name: &str, frames: &[[f64; 3]], of: usize| {
        let points = frames.iter().map(|frame| (frame[0], frame[of])).collect();
        Curve { name: name.to_owned(), points }
    };
    let predicted =
        Curve { name: "predicted".into(), points: vec![(0.0, STEADY_C), (last(&free)[0], STEADY_C)] };
    let curves = vec![
        curve("4.00 eV", &free, 1),
        curve("4.02 eV", &free, 2),
        curve("4.00 eV, breakdown at 20 kV/m", &limited, 1),
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
