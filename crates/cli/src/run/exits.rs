//! Grains that left: `exits.csv`, a row for each, and a line of the log for each face and row of the history.

use super::folder::RunFolder;
use crate::failure::Failure;
use amberfield_core::OnExit;
use amberfield_dem::{Exit, Simulation};
use amberfield_scene::files::EXITS;
use amberfield_scene::{HistoryFile, HistoryValue, Scene};
use std::collections::BTreeMap;

/// Name of the file.
pub(crate) const FILE: &str = EXITS.path;

/// Sums over the grains that left through a face.
#[derive(Clone, Copy, Debug, Default)]
struct Through {
    grains: u64,
    /// Charge [C].
    charge: f64,
}

/// Open file of grains that left.
#[derive(Debug)]
pub(crate) struct Exits {
    rows: HistoryFile,
    /// Grains that left since the log was told, by face.
    untold: BTreeMap<&'static str, Through>,
}

impl Exits {
    /// Creates the file of a new run; `None` where grains that leave end the run.
    pub(crate) fn create(folder: &RunFolder, scene: &Scene) -> Result<Option<Self>, Failure> {
        let create = || HistoryFile::create(&folder.file(FILE), &EXITS.heading());
        Ok(is_written(scene).then(create).transpose()?.map(Self::of))
    }

    /// Opens the file of a run that is continued; rows after its step are removed.
    pub(crate) fn resume(
        folder: &RunFolder,
        scene: &Scene,
        simulation: &Simulation,
    ) -> Result<Option<Self>, Failure> {
        let columns = EXITS.heading();
        let resume = || HistoryFile::resume(&folder.file(FILE), &columns, simulation.step_index(), |_| true);
        Ok(is_written(scene).then(resume).transpose()?.map(Self::of))
    }

    fn of(rows: HistoryFile) -> Self {
        Self { rows, untold: BTreeMap::new() }
    }

    /// Appends grains that left.
    pub(crate) fn append(&mut self, exits: &[Exit]) -> Result<(), Failure> {
        for exit in exits {
            let Exit { step, time_s, id, face, position: x, velocity: v, radius, charge } = *exit;
            let mut row = vec![HistoryValue::Count(step), HistoryValue::Number(time_s)];
            row.extend([HistoryValue::Count(id), HistoryValue::Text(face)]);
            let numbers = [x.x, x.y, x.z, v.x, v.y, v.z, radius, charge];
            row.extend(numbers.map(HistoryValue::Number));
            self.rows.append(&row)?;
            let through = self.untold.entry(face).or_default();
            through.grains += 1;
            through.charge += charge;
        }
        Ok(())
    }

    /// Tells the log how many grains left through each face since it was told last.
    pub(crate) fn tell(&mut self, time_s: f64) {
        for (face, Through { grains, charge }) in std::mem::take(&mut self.untold) {
            tracing::info!(
                "{grains} grain(s) left through {face} with {charge:.3e} C, up to t = {time_s:e} s"
            );
        }
    }
}

/// Whether the scene lets grains leave.
fn is_written(scene: &Scene) -> bool {
    scene.time.as_ref().is_some_and(|time| time.on_exit == OnExit::Delete)
}
