//! The complete state of a run, for checkpoints: every stage's own, one after another.

use super::exits::WaysOut;
use crate::DemError;
use crate::books::BooksState;
use crate::charging::ChargingState;
use crate::contacts::memory::ContactsState;
use crate::feeding::FeedingState;
use crate::field_stage::FieldState;
use crate::motion::grains::GrainsState;
use crate::setup::Setup;
use amberfield_core::{Domain, Particles};
use amberfield_field::Choice;
use amberfield_gas::ExchangeState;
use serde::{Deserialize, Serialize};

/// Progress of a run through time and its lists.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Progress {
    /// Steps done, or in progress within a step.
    pub(crate) step_index: u64,
    /// Time step [s].
    pub(crate) step_s: f64,
    /// Skin of the neighbour lists [m].
    pub(crate) skin_m: f64,
    /// Bound on any grain's displacement since the lists were built [m].
    pub(crate) travel: f64,
    /// Largest speed of the last drift [m/s].
    pub(crate) speed: f64,
    /// Largest speed over radius of the last drift [1/s].
    pub(crate) pace: f64,
}

impl Progress {
    /// Simulated time [s].
    pub(crate) fn time_s(&self) -> f64 {
        self.step_index as f64 * self.step_s
    }
}

/// Everything that a run needs to go on bit for bit, given the same [`crate::Setup`]. Opaque; serialise it
/// with serde. The order of the fields, and of theirs, is that of a checkpoint's bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    pub(crate) progress: Progress,
    pub(crate) grains: GrainsState,
    pub(crate) contacts: ContactsState,
    pub(crate) field: Option<FieldState>,
    pub(crate) charging: Option<ChargingState>,
    /// State of a gas that flows; not in a [`crate::Simulation::state`].
    pub(crate) gas: Option<ExchangeState>,
    pub(crate) ways_out: WaysOut,
    pub(crate) feeding: Option<FeedingState>,
    pub(crate) books: Option<BooksState>,
}

impl State {
    /// Number of steps done.
    #[must_use]
    pub fn step_index(&self) -> u64 {
        self.progress.step_index
    }

    /// Simulated time [s].
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.progress.time_s()
    }

    /// Grains that are still there, given those of the set-up, in their order; positions inside the domain.
    ///
    /// # Errors
    /// A state of other grains than those of the set-up.
    pub fn particles(&self, start: &Particles, domain: &Domain) -> Result<Particles, DemError> {
        let grains = &self.grains;
        let arrays = [grains.centre.len(), grains.velocity.len(), grains.angular.len()];
        let fits = arrays.iter().all(|length| *length == grains.original.len())
            && grains.original.iter().all(|original| original.index() < start.len())
            && self.charging.as_ref().is_none_or(|charging| {
                // A run that was to end earlier knows fewer of the grains that feeds bring.
                grains.original.iter().all(|original| original.index() < charging.charge.len())
            });
        if !fits {
            return Err(DemError::State("its grains are not those of the scene".to_owned()));
        }
        let mut order: Vec<usize> = (0..grains.original.len()).collect();
        order.sort_unstable_by_key(|&index| grains.original[index]);
        let grain = |index: usize| {
            let original = grains.original[index].index();
            let mut grain = start.grain(original);
            grain.position = domain.wrap(grains.centre[index]);
            grain.velocity = grains.velocity[index];
            grain.angular_velocity = grains.angular[index];
            if let Some(charging) = &self.charging {
                grain.charge = charging.charge[original];
            }
            grain
        };
        let there: Particles = order.into_iter().map(grain).collect();
        Ok(Particles { fixed_groups: start.fixed_groups.clone(), ..there })
    }

    /// Fits the charges to the grains of a merged set-up that ends at another time: feeds bring more, or
    /// fewer of those that have not come yet.
    pub(crate) fn follow_end(&mut self, setup: &Setup) {
        let (Some(charging), Some(_)) = (&mut self.charging, &self.feeding) else { return };
        let total = setup.particles.len();
        for charges in [&mut charging.charge, &mut charging.evaluated] {
            charges.truncate(total);
            let known = charges.len();
            charges.extend(&setup.particles.charge[known..]);
        }
    }

    /// Whether a field solver that the scene has was lost, and the internal grid goes on.
    #[must_use]
    pub fn has_lost_solver(&self) -> bool {
        self.field.as_ref().is_some_and(|field| !field.has_solver)
    }

    /// Parameters of the field in force; `None` without a field stage.
    #[must_use]
    pub fn choice(&self) -> Option<&Choice> {
        self.field.as_ref().map(|f| &f.choice)
    }
}
