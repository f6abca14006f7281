//! The loop of a run.

use super::folder::RunFolder;
use super::health::{Allowed, Health};
use super::record::{Clock, Record};
use super::schedule::{Every, Schedule};
use super::summary::{Ending, write_summary};
use crate::failure::Failure;
use crate::interrupt;
use crate::progress::Progress;
use amberfield_dem::{ElectricEnergy, Energies, Simulation, State};
use amberfield_scene::{Scene, write_checkpoint};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Instant;

/// What a checkpoint holds.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Saved {
    /// The simulation.
    pub(crate) state: State,
    /// Schedule of the history.
    pub(crate) history: Every,
    /// Seconds that the run took so far.
    pub(crate) wall_s: f64,
    /// The same for each stage.
    pub(crate) stage_s: Vec<f64>,
}

/// A run in progress.
pub(crate) struct Session<'a> {
    pub(crate) folder: &'a RunFolder,
    pub(crate) scene: &'a Scene,
    pub(crate) simulation: Simulation,
    pub(crate) schedule: Schedule,
    pub(crate) record: Record,
    health: Health,
    /// Seconds of earlier parts of the run.
    pub(crate) earlier: Clock,
    pub(crate) begun: Instant,
}

impl<'a> Session<'a> {
    /// A new run.
    pub(crate) fn start(
        folder: &'a RunFolder,
        scene: &'a Scene,
        mut simulation: Simulation,
    ) -> Result<Self, Failure> {
        let schedule = schedule(scene, &simulation, None)?;
        let record = Record::create(folder, scene, &simulation)?;
        let health = health(scene, &mut simulation)?;
        let earlier = Clock { wall_s: 0.0, stages: Vec::new() };
        Ok(Self { folder, scene, simulation, schedule, record, health, earlier, begun: Instant::now() })
    }

    /// A run that goes on from a checkpoint with its schedule of the history and its clock.
    pub(crate) fn resume(
        folder: &'a RunFolder,
        scene: &'a Scene,
        mut simulation: Simulation,
        (history, earlier): (Every, Clock),
    ) -> Result<Self, Failure> {
        let schedule = schedule(scene, &simulation, Some(history))?;
        let record = Record::resume(folder, scene, &simulation, &schedule)?;
        let health = health(scene, &mut simulation)?;
        Ok(Self { folder, scene, simulation, schedule, record, health, earlier, begun: Instant::now() })
    }

    /// Steps until the end, at most `most` steps, or until the user interrupts; writes what is due and the end.
    pub(crate) fn go(&mut self, most: Option<u64>, progress: &mut Progress) -> Result<Ending, Failure> {
        let first = self.simulation.step_index();
        let stop =
            most.map_or(self.schedule.total, |most| self.schedule.total.min(first.saturating_add(most)));
        if first == 0 {
            self.row()?;
            self.record.frame(self.folder, self.scene, &self.simulation)?;
        }
        let before = self.energies()?;
        let ending = loop {
            let step = self.simulation.step_index();
            if step >= stop {
                break if step >= self.schedule.total { Ending::Complete } else { Ending::Steps };
            }
            if interrupt::asked() {
                break Ending::Interrupted;
            }
            if let Err(error) = self.step(progress) {
                // The grains are between two steps: what can be saved is the state before, if it was kept.
                if let Some(state) = self.simulation.rescued() {
                    let path = self.checkpoint_of(state.step_index());
                    self.save(state)?;
                    tracing::warn!("the state before it is saved; go on with --resume {}", path.display());
                }
                // What made it fail may forbid to write this too, and is what must be said.
                if let Err(unwritten) =
                    write_summary(self, first, &before, Ending::Failed, Some(error.message()))
                {
                    tracing::warn!("{}", unwritten.message());
                }
                return Err(error);
            }
        };
        self.row()?;
        self.record.frame(self.folder, self.scene, &self.simulation)?;
        self.checkpoint()?;
        write_summary(self, first, &before, ending, None)?;
        Ok(ending)
    }

    fn step(&mut self, progress: &mut Progress) -> Result<(), Failure> {
        self.simulation.step().map_err(|error| Failure::while_running(&error))?;
        self.write_what_is_due().map_err(|failure| match self.folder.newest_checkpoint() {
            Some(path) => failure.with(&format!("; the last checkpoint before that is {}", path.display())),
            None => failure.with("; there is no checkpoint before that"),
        })?;
        progress.tell(self.simulation.step_index(), self.simulation.time_s());
        Ok(())
    }

    /// Writes what is due after a step, and looks whether the run is still sound.
    fn write_what_is_due(&mut self) -> Result<(), Failure> {
        let step = self.simulation.step_index();
        let (row, checkpoint) = (self.schedule.history.is_due(step), self.schedule.checkpoint_is_due(step));
        if row || checkpoint {
            let energies = forecast_energies(&mut self.simulation)?;
            if row {
                self.record.row(&self.simulation, &energies, &self.clock())?;
            }
            if let Err(failure) = self.health.check(&mut self.simulation, &energies) {
                self.record.frame(self.folder, self.scene, &self.simulation)?;
                return Err(failure.with("; the last files in particles/ show that moment"));
            }
        }
        if self.schedule.frame_is_due(step) {
            self.record.frame(self.folder, self.scene, &self.simulation)?;
        }
        if checkpoint {
            self.checkpoint()?;
        }
        Ok(())
    }

    fn row(&mut self) -> Result<(), Failure> {
        let energies = forecast_energies(&mut self.simulation)?;
        self.record.row(&self.simulation, &energies, &self.clock())
    }

    /// Path of the checkpoint of the present step.
    pub(crate) fn checkpoint_path(&self) -> PathBuf {
        self.checkpoint_of(self.simulation.step_index())
    }

    fn checkpoint_of(&self, step: u64) -> PathBuf {
        self.folder.file(&format!("checkpoints/step_{step:012}.amber"))
    }

    fn checkpoint(&mut self) -> Result<(), Failure> {
        let state = self.simulation.checkpoint().map_err(|error| Failure::while_running(&error))?;
        self.save(state)
    }

    fn save(&mut self, state: State) -> Result<(), Failure> {
        let clock = self.clock();
        let step = state.step_index();
        let saved =
            Saved { state, history: self.schedule.history, wall_s: clock.wall_s, stage_s: clock.stages };
        let path = self.checkpoint_of(step);
        write_checkpoint(&path, self.scene.hash(), &saved)?;
        tracing::debug!(step, "checkpoint {}", path.display());
        Ok(())
    }

    /// Seconds so far.
    pub(crate) fn clock(&self) -> Clock {
        let stages = self.simulation.stage_seconds();
        let earlier = self.earlier.stages.iter().copied().chain(std::iter::repeat(0.0));
        Clock {
            wall_s: self.earlier.wall_s + self.begun.elapsed().as_secs_f64(),
            stages: stages.iter().zip(earlier).map(|((_, seconds), earlier)| seconds + earlier).collect(),
        }
    }

    /// Energies now [J].
    pub(crate) fn energies(&mut self) -> Result<Energies, Failure> {
        self.simulation.energies(ElectricEnergy::Evaluated).map_err(|error| Failure::while_running(&error))
    }
}

fn forecast_energies(simulation: &mut Simulation) -> Result<Energies, Failure> {
    simulation.energies(ElectricEnergy::Forecast).map_err(|error| Failure::while_running(&error))
}

fn health(scene: &Scene, simulation: &mut Simulation) -> Result<Health, Failure> {
    let energies = forecast_energies(simulation)?;
    Ok(Health::new(simulation, &energies, Allowed::new(scene)))
}

fn schedule(scene: &Scene, simulation: &Simulation, history: Option<Every>) -> Result<Schedule, Failure> {
    let time = scene.time.as_ref().ok_or_else(|| Failure::bad_input("the scene has no [time]; add it"))?;
    Ok(Schedule::new(time, &scene.output, simulation.step_s(), history))
}
