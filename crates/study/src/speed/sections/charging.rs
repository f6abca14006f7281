//! Cost of charge transfer in a step of a dense bed whose field is given.

use crate::Context;
use crate::beds;
use crate::page::{Table, figure};
use crate::timing::{median, on_threads};
use amberfield_core::{ChargeTransfer, CouplingInterval, FieldSettings, Tuning};
use amberfield_dem::{FieldStageSetup, Setup, Simulation};
use amberfield_study::Store;
use amberfield_study::templates::fill;
use anyhow::Result;
use minijinja::context;
use serde::{Deserialize, Serialize};
use std::time::Instant;

const NAME: &str = "charging";
const FRACTION: f64 = 0.64;
/// Cut-off distance of the transfer [m].
const CUTOFF_M: f64 = 5e-7;
const ROUNDS: usize = 5;
/// Steps between two evaluations of the field, whose time does not count.
const INTERVAL: u32 = 30;
/// Largest cost of charge transfer, over the step without it.
const GOAL: f64 = 0.15;

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    charging: bool,
    grains: usize,
    threads: usize,
    contacts_per_grain: f64,
    ns_per_grain_step: f64,
    ns_of_charging: f64,
}

pub(crate) fn measure(context: &Context) -> Result<()> {
    let (grains, steps) = if context.quick { (2000, 20) } else { (100_000, 60) };
    let mut rows = Vec::new();
    let bed = beds::relaxed(grains, FRACTION);
    for threads in [1, 2] {
        let (first, second) = on_threads(threads, || compare(&bed, steps, threads))?;
        println!("{first:?}\n{second:?}");
        rows.extend([first, second]);
    }
    Ok(context.store.save(NAME, &rows)?)
}

/// The bed without and with charging, taking turns.
fn compare(bed: &Setup, steps: usize, threads: usize) -> Result<(Row, Row)> {
    let grains = bed.particles.len();
    let mut runs = [run(bed, false)?, run(bed, true)?];
    let mut seconds = [Vec::new(), Vec::new()];
    for round in 0..=ROUNDS {
        for (run, seconds) in runs.iter_mut().zip(&mut seconds) {
            let (start, field) = (Instant::now(), seconds_of(run, "field"));
            for _ in 0..steps {
                run.step()?;
            }
            // The first round warms up.
            if round > 0 {
                seconds.push(start.elapsed().as_secs_f64() - (seconds_of(run, "field") - field));
            }
        }
    }
    let per = 1e9 / (steps * grains) as f64;
    let row = |charging: bool, seconds: &mut Vec<f64>, run: &Simulation| Row {
        charging,
        grains,
        threads,
        contacts_per_grain: run.contacts() as f64 / grains as f64,
        ns_per_grain_step: median(seconds) * per,
        ns_of_charging: seconds_of(run, "charging") * per / (ROUNDS + 1) as f64,
    };
    let [without, with] = &runs;
    let [of_without, of_with] = &mut seconds;
    Ok((row(false, of_without, without), row(true, of_with, with)))
}

/// Seconds of a stage so far; 0 if it is not built.
fn seconds_of(run: &Simulation, stage: &str) -> f64 {
    run.stage_seconds().into_iter().filter(|(name, _)| *name == stage).map(|(_, seconds)| seconds).sum()
}

/// A bed of two work functions.
fn run(bed: &Setup, charging: bool) -> Result<Simulation> {
    let mut scene = bed.clone();
    let grains = scene.particles.len();
    let mut other = beds::glass();
    scene.materials[0].work_function_ev = Some(4.5);
    other.work_function_ev = Some(4.6);
    scene.materials.push(other);
    for (n, material) in scene.particles.material.iter_mut().enumerate() {
        material.0 = (n % 2) as u16;
    }
    scene.particles.charge = (0..grains).map(|n| if n % 2 == 0 { 1e-14 } else { -1e-14 }).collect();
    let settings = FieldSettings {
        tuning: Tuning::Model,
        coupling_interval: CouplingInterval::Steps(INTERVAL),
        ..FieldSettings::default()
    };
    let field = FieldStageSetup::new(settings, vec![true; grains]);
    let transfer = charging.then(|| ChargeTransfer::new(CUTOFF_M));
    scene.field = Some(FieldStageSetup { transfer, ..field });
    Ok(Simulation::new(scene)?)
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table = Table::new(&[
        "threads",
        "contacts per grain",
        "step [ns/grain]",
        "with charging",
        "more [%]",
        "the stage itself [%]",
    ]);
    let mut worst = 0.0_f64;
    for pair in rows.chunks_exact(2) {
        let [without, with] = pair else { continue };
        let more = with.ns_per_grain_step / without.ns_per_grain_step - 1.0;
        worst = worst.max(more);
        table.row(&[
            with.threads.to_string(),
            figure(Some(with.contacts_per_grain), 2),
            figure(Some(without.ns_per_grain_step), 1),
            figure(Some(with.ns_per_grain_step), 1),
            figure(Some(100.0 * more), 1),
            figure(Some(100.0 * with.ns_of_charging / without.ns_per_grain_step), 1),
        ]);
    }
    let values = context! {
        date,
        grains => rows[0].grains,
        fraction => FRACTION,
        interval => INTERVAL,
        rounds => ROUNDS,
        table => table.to_string(),
        goal => 100.0 * GOAL,
        met => worst <= GOAL,
        worst => 100.0 * worst,
    };
    Ok(Some(fill(include_str!("../../../templates/speed/charging.md"), values)))
}
