//! Whole runs against a much finer one: trajectories as long as they are determined, statistics after that.

use super::description::{Motion, Study, Sweep};
use super::laboratory::{Laboratory, Moved, Provenance};
use super::points::command;
use amberfield_oracle::{rms_difference, rms_scalar};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// A perturbation over a radius, and the growth up to which trajectories count.
const NUDGE: f64 = 1e-12;
const GROWTH: f64 = 10.0;
/// Looks at a run, evenly in time.
pub(super) const LOOKS: usize = 100;

/// A run with its settings, as it stands in the CSV.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionRow {
    /// Day of the measurement.
    pub date: String,
    /// Version of the program.
    pub version: String,
    /// Processor.
    pub processor: String,
    /// Threads.
    pub threads: usize,
    /// Name of the scene that moves.
    pub problem: String,
    /// Settings.
    pub method: String,
    /// Value of the swept key.
    pub value: String,
    /// Wall-clock time of the run [s].
    pub seconds: Option<f64>,
    /// Steps.
    pub steps: Option<u64>,
    /// Evaluations of the field.
    pub evaluations: Option<u64>,
    /// Time up to which trajectories count: a perturbation has grown tenfold by then [s].
    pub horizon_s: Option<f64>,
    /// RMS deviation from the reference at that time, over the RMS way since the start.
    pub position_error: Option<f64>,
    /// RMS deviation of the charges at that time, over the RMS of what has moved; empty where nothing has.
    pub charge_error: Option<f64>,
    /// Mean height at the end, as the number of standard deviations of the replicas away from their mean.
    pub height: Option<f64>,
    /// Kinetic energy at the end, likewise.
    pub kinetic: Option<f64>,
    /// Contacts per grain at the end, likewise.
    pub contacts: Option<f64>,
    /// Command that repeats the run.
    pub command: String,
    /// Reason why the run failed.
    pub failure: String,
}

/// Runs every motion of a study with every setting; `done` hears of each run.
pub fn run_motions<L: Laboratory>(
    study: &Study,
    folder: &Path,
    laboratory: &mut L,
    mut done: impl FnMut(&MotionRow),
) {
    let provenance = laboratory.provenance();
    for motion in &study.motions {
        let scene = folder.join(&motion.scene);
        match Truth::find(motion, &scene, laboratory) {
            Ok(truth) => {
                for (name, set, value) in settings(motion) {
                    let row = MotionRow {
                        method: name,
                        value,
                        command: command("run", &scene, &set),
                        ..row(&provenance, motion)
                    };
                    let row = match laboratory.simulate(&scene, &set, 0.0, LOOKS) {
                        Ok(moved) => truth.compare(&moved, row),
                        Err(failure) => MotionRow { failure, ..row },
                    };
                    done(&row);
                }
            }
            Err(reason) => {
                done(&MotionRow { failure: format!("no truth: {reason}"), ..row(&provenance, motion) });
            }
        }
    }
}

fn row(provenance: &Provenance, motion: &Motion) -> MotionRow {
    MotionRow {
        date: provenance.date.clone(),
        version: provenance.version.clone(),
        processor: provenance.processor.clone(),
        threads: provenance.threads,
        problem: motion.name.clone(),
        ..MotionRow::default()
    }
}

/// Name, overrides and swept value of every run.
fn settings(motion: &Motion) -> Vec<(String, Vec<String>, String)> {
    let of = |method: &super::Method| {
        let name = method.name.clone();
        let base = [&motion.set[..], &motion.reference, &method.set].concat();
        Sweep::overrides(method.sweep.as_ref())
            .into_iter()
            .map(move |(swept, value)| (name.clone(), [&base[..], &swept].concat(), value))
            .collect::<Vec<_>>()
    };
    motion.variants.iter().flat_map(of).collect()
}

/// The reference run, how far it is determined, and how replicas spread.
struct Truth {
    reference: Moved,
    /// Number of the last look that counts.
    horizon: usize,
    /// Mean and standard deviation over the replicas of height, kinetic energy and contacts.
    spread: [(f64, f64); 3],
}

impl Truth {
    fn find<L: Laboratory>(motion: &Motion, scene: &Path, laboratory: &mut L) -> Result<Self, String> {
        let set = [&motion.set[..], &motion.reference].concat();
        let reference = laboratory.simulate(scene, &set, 0.0, LOOKS)?;
        let nudged = laboratory.simulate(scene, &set, NUDGE, LOOKS)?;
        let apart: Vec<f64> =
            reference.positions.iter().zip(&nudged.positions).map(|(a, b)| rms_difference(a, b)).collect();
        let within = apart.iter().take_while(|distance| **distance <= GROWTH * apart[0]).count();
        let mut statistics = vec![reference.statistics()];
        for (seed, _) in Sweep::overrides(motion.replicas.as_ref()) {
            statistics
                .push(laboratory.simulate(scene, &[&set[..], &seed].concat(), 0.0, LOOKS)?.statistics());
        }
        let spread = [0, 1, 2].map(|k| {
            let count = statistics.len() as f64;
            let mean = statistics.iter().map(|values| values[k]).sum::<f64>() / count;
            let square = statistics.iter().map(|values| (values[k] - mean).powi(2)).sum::<f64>();
            (mean, (square / (count - 1.0)).sqrt())
        });
        Ok(Self { reference, horizon: within.max(1) - 1, spread })
    }

    fn compare(&self, moved: &Moved, row: MotionRow) -> MotionRow {
        let (at, reference) = (self.horizon, &self.reference);
        if moved.positions.get(at).is_none_or(|places| places.len() != reference.positions[at].len()) {
            return MotionRow { failure: "other grains than in the reference".to_owned(), ..row };
        }
        let way = rms_difference(&reference.positions[at], &reference.positions[0]);
        let exchanged = rms_change(&reference.charges[at], &reference.charges[0]);
        let statistics = moved.statistics();
        let [height, kinetic, contacts] = [0, 1, 2].map(|k| {
            let (mean, deviation) = self.spread[k];
            (deviation > 0.0).then(|| (statistics[k] - mean) / deviation)
        });
        MotionRow {
            seconds: Some(moved.seconds),
            steps: Some(moved.steps),
            evaluations: Some(moved.evaluations),
            horizon_s: Some(reference.end_s * at as f64 / LOOKS as f64),
            position_error: Some(rms_difference(&moved.positions[at], &reference.positions[at]) / way),
            charge_error: (exchanged > 0.0)
                .then(|| rms_change(&moved.charges[at], &reference.charges[at]) / exchanged),
            height,
            kinetic,
            contacts,
            ..row
        }
    }
}

fn rms_change(a: &[f64], b: &[f64]) -> f64 {
    rms_scalar(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}
