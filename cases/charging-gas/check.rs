//! Case of a charging gas: charging curves of soft and stiffer grains, both corrected.

use crate::support::{Case, Curve, full_size, plot};

const YOUNG_PA: [f64; 2] = [1e5, 5e6];
/// Largest difference of two means, over the spread of the replicas; the mean of a few replicas is uncertain
/// by about their spread.
const SPREADS: f64 = 1.5;
/// Share by which soft grains have fewer impacts: a soft contact lasts 0.1 ms of the 4 ms between two impacts
/// on a wall, and a stiff contact a fifth of that. Impacts between grains add to it.
const SLOWER: f64 = 0.1;

/// Row of a charging curve.
#[derive(Clone, Copy)]
struct Moment {
    time_s: f64,
    collisions: f64,
    charge_c: f64,
}

/// Charging curve of a run.
fn run(young: f64, seed: u32) -> Vec<Moment> {
    let case = Case::new("charging-gas");
    case.replace("scene.toml", "young_Pa = 5e6", &format!("young_Pa = {young:e}"));
    case.replace("scene.toml", "seed = 1", &format!("seed = {seed}"));
    if !full_size() {
        case.replace("scene.toml", "end_s = 0.03", "end_s = 0.005");
        case.replace("scene.toml", "\nevery_s = 0.03", "\nevery_s = 0.005");
    }
    if young < 1e6 {
        case.replace("scene.toml", "step_s = 3e-7", "step_s = 1e-6");
    }
    let run = case.run(&[]);
    let history = run.history();
    let (time, collisions) = (history.column("time_s"), history.column("collisions"));
    let (charge, wall) = (history.column("net_charge_C"), history.column("wall_charge_C"));
    for (charge, wall) in charge.iter().zip(wall) {
        assert!((charge + wall).abs() <= 1e-12 * charge.abs(), "{charge:e} {wall:e}");
    }
    let moment =
        |row: usize| Moment { time_s: time[row], collisions: collisions[row], charge_c: charge[row] };
    (0..time.len()).map(moment).collect()
}

/// Smallest, mean and largest value.
fn spread(values: &[f64]) -> [f64; 3] {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    [low, values.iter().sum::<f64>() / values.len() as f64, high]
}

/// Horizontal axis of a plot of the charge.
struct Abscissa {
    /// Name of the plot.
    plot: &'static str,
    label: &'static str,
    of: fn(&Moment) -> f64,
}

#[test]
fn corrected_charging_curves_coincide() {
    let seeds = if full_size() { 1..=3 } else { 1..=2 };
    let runs = YOUNG_PA.map(|young| seeds.clone().map(|seed| run(young, seed)).collect::<Vec<_>>());
    let end = |curve: &Vec<Moment>| curve[curve.len() - 1];
    let spreads = |of: fn(Moment) -> f64| {
        runs.each_ref().map(|runs| spread(&runs.iter().map(|run| of(end(run))).collect::<Vec<_>>()))
    };
    let [soft, stiff] = spreads(|end| end.charge_c / end.collisions);
    let spread = (soft[2] - soft[0]).max(stiff[2] - stiff[0]);
    assert!(soft[2] < 0.0 && stiff[2] < 0.0, "the higher work function ends negative");
    assert!((soft[1] - stiff[1]).abs() < SPREADS * spread, "charge per collision: {soft:?} {stiff:?}");
    let [soft, stiff] = spreads(|end| end.charge_c);
    assert!((soft[1] / stiff[1] - 1.0).abs() < SLOWER, "charge: {soft:?} {stiff:?}");
    let over_time = Abscissa { plot: "charge", label: "time [s]", of: |moment| moment.time_s };
    let over_collisions =
        Abscissa { plot: "charge-over-collisions", label: "collisions", of: |moment| moment.collisions };
    for x in [over_time, over_collisions] {
        let curve = |young: f64, seed: usize, run: &[Moment]| Curve {
            name: format!("Y = {young:e} Pa, replica {}", seed + 1),
            points: run.iter().map(|moment| ((x.of)(moment), moment.charge_c)).collect(),
        };
        let all = YOUNG_PA.iter().zip(&runs).flat_map(|(young, runs)| {
            runs.iter().enumerate().map(move |(seed, run)| curve(*young, seed, run))
        });
        plot("charging-gas", x.plot, [x.label, "charge of all grains [C]"], false, all.collect());
    }
}
