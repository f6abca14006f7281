//! Loop of a run over its steps.

use super::folder::RunFolder;
use super::health::{Allowed, Health};
use super::observer::Observer;
use super::record::{Clock, Record};
use super::schedule::{Every, Schedule};
use super::setup::CaseContents;
use super::summary::{Ending, write_summary};
use crate::failure::Failure;
use crate::interrupt;
use amberfield_core::{ContactRules, WallRule};
use amberfield_dem::{ElectricEnergy, Energies, Simulation, State};
use amberfield_scene::{SavedGrains, Scene, write_checkpoint};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::time::Instant;

/// Content of a checkpoint.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Saved {
    /// State of the simulation.
    pub(crate) state: State,
    /// Interval of the rows of the history.
    pub(crate) history: Every,
    /// Wall time of the run so far [s].
    pub(crate) wall_s: f64,
    /// Wall time of each stage so far [s].
    pub(crate) stage_s: Vec<f64>,
    /// Contents of the field solver's case; `None` without one.
    pub(crate) case: Option<CaseContents>,
    /// Energies and charges to which later ones are compared.
    pub(crate) health: Health,
}

/// Earlier part of a run that is continued.
pub(crate) struct EarlierPart {
    /// Interval of the rows of the history.
    pub(crate) history: Every,
    /// Times that it took.
    pub(crate) clock: Clock,
    /// Energies and charges to which later ones are compared.
    pub(crate) health: Health,
}

/// Run in progress.
pub(crate) struct Session<'a> {
    pub(crate) folder: &'a RunFolder,
    pub(crate) scene: &'a Scene,
    pub(crate) simulation: Simulation,
    pub(crate) schedule: Schedule,
    pub(crate) record: Record,
    health: Health,
    /// Step of the last checkpoint.
    saved: Option<u64>,
    /// Contents of the field solver's case.
    case: Option<CaseContents>,
    /// Energies at a resume [J].
    at_resume: Option<Energies>,
    /// Times of earlier parts of the run.
    pub(crate) earlier: Clock,
    /// Begin of this part of the run.
    pub(crate) begun: Instant,
}

impl<'a> Session<'a> {
    /// Starts a new run.
    pub(crate) fn start(
        folder: &'a RunFolder,
        scene: &'a Scene,
        mut simulation: Simulation,
        case: Option<CaseContents>,
    ) -> Result<Self, Failure> {
        let schedule = schedule(scene, &simulation, None)?;
        let energies = forecast_energies(&mut simulation)?;
        let health = Health::new(&simulation, &energies, Allowed::new(scene, &simulation));
        let record = Record::create(folder, scene, &simulation)?;
        let earlier = Clock { wall_s: 0.0, stages: Vec::new() };
        let (at_resume, saved) = (None, None);
        let begun = Instant::now();
        Ok(Self {
            folder,
            scene,
            simulation,
            schedule,
            record,
            health,
            saved,
            case,
            at_resume,
            earlier,
            begun,
        })
    }

    /// Continues a run from a checkpoint.
    pub(crate) fn resume(
        folder: &'a RunFolder,
        scene: &'a Scene,
        mut simulation: Simulation,
        earlier: EarlierPart,
        case: Option<CaseContents>,
    ) -> Result<Self, Failure> {
        let schedule = schedule(scene, &simulation, Some(earlier.history))?;
        // Only a run that goes on may take later rows away.
        let energies = simulation.energies(ElectricEnergy::Evaluated);
        let at_resume = Some(energies.map_err(|error| Failure::while_running(&error))?);
        let record = Record::resume(folder, scene, &simulation, &schedule)?;
        let EarlierPart { clock: earlier, health, .. } = earlier;
        let (saved, begun) = (None, Instant::now());
        Ok(Self {
            folder,
            scene,
            simulation,
            schedule,
            record,
            health,
            saved,
            case,
            at_resume,
            earlier,
            begun,
        })
    }

    /// Makes steps until the end, at most `most` of them, or until the user interrupts.
    ///
    /// It writes the outputs that are due, and all outputs at the end.
    pub(crate) fn go(&mut self, most: Option<u64>, observer: &mut dyn Observer) -> Result<Ending, Failure> {
        let first = self.simulation.step_index();
        let stop =
            most.map_or(self.schedule.total, |most| self.schedule.total.min(first.saturating_add(most)));
        if first == 0 {
            self.row()?;
            self.frame(observer)?;
        }
        let before = match self.at_resume.take() {
            Some(energies) => energies,
            None => self.energies()?,
        };

        let ending = loop {
            let step = self.simulation.step_index();
            if step >= stop {
                break if step >= self.schedule.total { Ending::Complete } else { Ending::Steps };
            }
            if interrupt::asked() {
                break Ending::Interrupted;
            }
            if let Err(error) = self.step(observer) {
                // The step is not complete, so only the state before it can be saved, if it was kept.
                if let Some(state) = self.simulation.rescued() {
                    let path = self.checkpoint_of(state.step_index());
                    self.save(state)?;
                    tracing::warn!("the state before it is saved; continue with --resume {}", path.display());
                }
                // The cause (a full disk, for example) may also prevent the summary. The first error is
                // reported.
                if let Err(unwritten) =
                    write_summary(self, first, &before, Ending::Failed, Some(error.message()))
                {
                    tracing::warn!("{}", unwritten.message());
                }
                return Err(error);
            }
        };

        self.row()?;
        self.frame(observer)?;
        self.checkpoint()?;
        write_summary(self, first, &before, ending, None)?;
        Ok(ending)
    }

    /// Makes one step and writes the outputs that are due.
    fn step(&mut self, observer: &mut dyn Observer) -> Result<(), Failure> {
        self.simulation.step().map_err(|error| Failure::while_running(&error))?;
        self.write_what_is_due(observer).map_err(|failure| match self.folder.newest_checkpoint() {
            Some(path) => failure.with(&format!("; the last checkpoint before that is {}", path.display())),
            None => failure.with("; there is no checkpoint before that"),
        })?;
        observer.step(self.simulation.step_index(), self.simulation.time_s());
        Ok(())
    }

    /// Writes the outputs that are due after a step, and checks that the run is sound.
    fn write_what_is_due(&mut self, observer: &mut dyn Observer) -> Result<(), Failure> {
        self.record.exits(&mut self.simulation)?;
        let step = self.simulation.step_index();
        let row = self.schedule.history.is_due(step);
        let checkpoint = self.schedule.checkpoint_is_due(step);
        // An unsound state must not become the checkpoint from which a run is continued.
        if row || checkpoint {
            let energies = forecast_energies(&mut self.simulation)?;
            if row {
                let clock = self.clock();
                self.record.row(&mut self.simulation, &energies, &clock)?;
            }
            if let Err(failure) = self.health.check(&mut self.simulation, &energies) {
                self.frame(observer)?;
                return Err(failure.with("; the last files in particles/ show that moment"));
            }
        }
        if self.schedule.frame_is_due(step) {
            self.frame(observer)?;
        }
        if checkpoint {
            self.checkpoint()?;
        }
        Ok(())
    }

    /// Writes the files of the grains, once for each step, and tells of them.
    fn frame(&mut self, observer: &mut dyn Observer) -> Result<(), Failure> {
        let written = self.record.frame(self.folder, self.scene, &self.simulation)?;
        if written && observer.frame(&self.simulation).is_break() {
            interrupt::ask();
        }
        Ok(())
    }

    /// Appends a row to the history.
    fn row(&mut self) -> Result<(), Failure> {
        let energies = forecast_energies(&mut self.simulation)?;
        let clock = self.clock();
        self.record.row(&mut self.simulation, &energies, &clock)
    }

    /// Path of the checkpoint of the present step.
    pub(crate) fn checkpoint_path(&self) -> PathBuf {
        self.checkpoint_of(self.simulation.step_index())
    }

    /// Path of the checkpoint of a step.
    fn checkpoint_of(&self, step: u64) -> PathBuf {
        self.folder.file(&format!("checkpoints/step_{step:012}.amber"))
    }

    /// Writes a checkpoint of the present step, once for each step.
    fn checkpoint(&mut self) -> Result<(), Failure> {
        let step = self.simulation.step_index();
        if self.saved.replace(step) == Some(step) {
            return Ok(());
        }
        let state = self.simulation.checkpoint().map_err(|error| Failure::while_running(&error))?;
        self.save(state)
    }

    /// Writes a checkpoint of a state.
    fn save(&mut self, state: State) -> Result<(), Failure> {
        let clock = self.clock();
        let step = state.step_index();
        let grains = self.grains_of(&state)?;
        let saved = Saved {
            state,
            history: self.schedule.history,
            wall_s: clock.wall_s,
            stage_s: clock.stages,
            case: self.case.clone(),
            health: self.health,
        };
        let path = self.checkpoint_of(step);
        write_checkpoint(&path, self.scene.physics(), &grains, &saved)?;
        tracing::debug!(step, "checkpoint {}", path.display());
        Ok(())
    }

    /// Grains of a state, with what other scenes must know of them.
    fn grains_of(&self, state: &State) -> Result<SavedGrains, Failure> {
        let Scene { materials, pairs, rolling_model, cohesion, walls, groups, .. } = self.scene;
        let particles =
            self.simulation.particles_of(state).map_err(|error| Failure::while_running(&error))?;
        let rules = ContactRules {
            materials: materials.clone(),
            pairs: pairs.clone(),
            rolling_model: *rolling_model,
            cohesion: *cohesion,
            walls: walls.iter().map(WallRule::of).collect(),
        };
        Ok(SavedGrains { particles, groups: groups.clone(), rules })
    }

    /// Times of the run so far.
    pub(crate) fn clock(&self) -> Clock {
        let stages = self.simulation.stage_seconds();
        let earlier = self.earlier.stages.iter().copied().chain(std::iter::repeat(0.0));
        Clock {
            wall_s: self.earlier.wall_s + self.begun.elapsed().as_secs_f64(),
            stages: stages.iter().zip(earlier).map(|((_, seconds), earlier)| seconds + earlier).collect(),
        }
    }

    /// Energies at the present step [J].
    pub(crate) fn energies(&mut self) -> Result<Energies, Failure> {
        self.simulation.energies(ElectricEnergy::Evaluated).map_err(|error| Failure::while_running(&error))
    }
}

/// Energies [J] with a forecast of the field, which costs no evaluation.
fn forecast_energies(simulation: &mut Simulation) -> Result<Energies, Failure> {
    simulation.energies(ElectricEnergy::Forecast).map_err(|error| Failure::while_running(&error))
}

fn schedule(scene: &Scene, simulation: &Simulation, history: Option<Every>) -> Result<Schedule, Failure> {
    let time = scene.time.as_ref().ok_or_else(|| Failure::bad_input("the scene has no [time]; add it"))?;
    Ok(Schedule::new(time, &scene.output, simulation.step_s(), history))
}
