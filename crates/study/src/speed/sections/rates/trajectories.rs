//! Trajectories of the bed while it lands, against a run with the field at every step.

use super::Rows;
use super::bed::Bed;
use amberfield_core::{CouplingInterval, Particles};
use amberfield_dem::{Setup, Simulation};
use amberfield_oracle::rms_difference;
use anyhow::Result;
use std::path::Path;

pub(super) const STUDY: &str = "trajectories";
pub(super) const REFERENCE_TOLERANCE: f64 = 1e-5;
const TOLERANCE: f64 = 1e-2;
/// Steps before the window: the first grains have landed.
const START: usize = 2900;
const WINDOW: usize = 256;
const INTERVALS: [u32; 6] = [2, 4, 8, 16, 32, 64];
/// Perturbation of a position [m], 1e-12 of a radius.
const PERTURBATION: f64 = 1e-12 * 1e-4;

pub(super) fn measure(path: &Path, quick: bool, rows: &mut Rows) -> Result<()> {
    let bed = Bed::read(path, &[])?;
    let (start, window) = if quick { (20, 8) } else { (START, WINDOW) };
    let before = after(bed.charged(TOLERANCE, CouplingInterval::Auto), start)?;
    let bed = bed.from(&before);
    let every = CouplingInterval::Steps(1);
    let (reference, _) = ends(bed.charged(REFERENCE_TOLERANCE, every), window)?;
    let (plain, _) = ends(bed.uncharged(), window)?;
    let mut perturbed = bed.from(&before);
    perturbed.perturb(PERTURBATION);
    let (perturbed, _) = ends(perturbed.charged(REFERENCE_TOLERANCE, every), window)?;
    let grown = deviation(&perturbed[1], &reference[1]) / deviation(&perturbed[0], &reference[0]);
    rows.add(STUDY, "1e-12 perturbation", "steps", window as f64);
    rows.add(STUDY, "1e-12 perturbation", "growth", grown);
    let effect = deviation(&plain[1], &reference[1]);
    let look = |rows: &mut Rows, case: &str, setup: Setup| -> Result<()> {
        let (end, run) = ends(setup, window)?;
        if let Some(intervals) = run.intervals() {
            rows.add(STUDY, case, "evaluations", intervals.evaluations as f64);
            rows.add(STUDY, case, "forecast error", intervals.error());
        }
        rows.add(STUDY, case, "velocity error", deviation(&end[1], &reference[1]) / effect);
        Ok(())
    };
    look(rows, "tolerance 1e-2, every step", bed.charged(TOLERANCE, every))?;
    look(rows, "tolerance 1e-2, auto", bed.charged(TOLERANCE, CouplingInterval::Auto))?;
    for interval in INTERVALS.into_iter().filter(|&interval| interval as usize <= window / 4) {
        let case = format!("reference tolerance, interval {interval}");
        look(rows, &case, bed.charged(REFERENCE_TOLERANCE, CouplingInterval::Steps(interval)))?;
        rows.add(STUDY, &case, "interval", f64::from(interval));
    }
    Ok(())
}

fn after(setup: Setup, steps: usize) -> Result<Simulation> {
    let mut simulation = Simulation::new(setup)?;
    for _ in 0..steps {
        simulation.step()?;
    }
    Ok(simulation)
}

/// Grains after an eighth of the window and at its end.
fn ends(setup: Setup, window: usize) -> Result<([Particles; 2], Simulation)> {
    let mut simulation = Simulation::new(setup)?;
    let mut first = None;
    for step in 1..=window {
        simulation.step()?;
        if step == window / 8 {
            first = Some(simulation.particles());
        }
    }
    let last = simulation.particles();
    Ok(([first.unwrap_or_else(|| last.clone()), last], simulation))
}

/// RMS difference of the velocities [m/s].
fn deviation(a: &Particles, b: &Particles) -> f64 {
    rms_difference(&a.velocity, &b.velocity)
}
