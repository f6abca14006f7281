//! Forces of the grains on each wall: `wall_forces.csv`, a row for each wall with each row of the history.

use super::folder::RunFolder;
use crate::failure::Failure;
use amberfield_dem::Simulation;
use amberfield_scene::files::WALL_FORCES;
use amberfield_scene::{HistoryFile, HistoryValue};

/// Name of the file.
pub(crate) const FILE: &str = WALL_FORCES.path;

/// Open file of forces on walls.
#[derive(Debug)]
pub(crate) struct WallForces {
    rows: HistoryFile,
}

impl WallForces {
    /// Creates the file of a new run; `None` where the run has no walls.
    pub(crate) fn create(folder: &RunFolder, simulation: &Simulation) -> Result<Option<Self>, Failure> {
        let create = || HistoryFile::create(&folder.file(FILE), &WALL_FORCES.heading());
        Ok(simulation.plan().has("walls").then(create).transpose()?.map(|rows| Self { rows }))
    }

    /// Opens the file of a run that is continued after a step; rows that are not due are removed.
    pub(crate) fn resume(
        folder: &RunFolder,
        simulation: &Simulation,
        is_due: impl Fn(u64) -> bool,
    ) -> Result<Option<Self>, Failure> {
        let (columns, reached) = (WALL_FORCES.heading(), simulation.step_index());
        let resume = || HistoryFile::resume(&folder.file(FILE), &columns, reached, is_due);
        Ok(simulation.plan().has("walls").then(resume).transpose()?.map(|rows| Self { rows }))
    }

    /// Appends the forces of the last step; none before the first step of a run that is continued.
    pub(crate) fn append(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let head = [HistoryValue::Count(simulation.step_index()), HistoryValue::Number(simulation.time_s())];
        for (wall, load) in (0..).zip(simulation.wall_loads().unwrap_or_default()) {
            let mut row = head.to_vec();
            row.push(HistoryValue::Count(wall));
            let vectors = [load.normal, load.tangential, load.torque];
            row.extend(vectors.iter().flat_map(|vector| vector.iter()).map(|x| HistoryValue::Number(*x)));
            self.rows.append(&row)?;
        }
        Ok(())
    }
}
