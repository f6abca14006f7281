//! Grains that come while the run goes on.

use super::Simulation;
use crate::contacts::loose::MOST_LOOSE;
use crate::error::DemError;
use crate::feeding::{Brought, FeedAccount, Feeding, Surroundings};
use crate::gas_stage::GasStage;

impl Simulation {
    /// Lets the grains in that are due and find a place. Those that are alone there need no list until
    /// others are built; else lists are built anew.
    pub(super) fn admit_grains(&mut self) -> Result<(), DemError> {
        let Some(feeding) = &mut self.feeding else { return Ok(()) };
        if !feeding.looks_in(self.progress.step_index) {
            return Ok(());
        }
        if let Some(walls) = &mut self.contacts.walls {
            walls.settle();
        }
        let newcomers = feeding.newcomers(&Surroundings {
            domain: &self.domain,
            particles: &self.particles,
            grains: &self.grains,
            contacts: &self.contacts,
            gravity: self.time.gravity_m_s2,
            skin_m: self.progress.skin_m,
            travel_m: self.progress.travel,
            step_index: self.progress.step_index,
            step_s: self.progress.step_s,
        })?;
        if newcomers.is_empty() {
            return Ok(());
        }
        let are_loose = newcomers.iter().all(|newcomer| newcomer.is_alone)
            && self.contacts.loose().len() + newcomers.len() <= MOST_LOOSE;
        if !are_loose {
            // What contacts have yet to trade is known by the old lists.
            self.trade_between_grains();
        }
        let turns = self.contacts.features.rotation();
        for newcomer in &newcomers {
            self.grains.admit(&self.particles, newcomer, turns);
            if are_loose {
                self.contacts.append(&self.grains);
            }
            if let Some(feeding) = &mut self.feeding {
                feeding.book(&self.particles, newcomer, self.time.gravity_m_s2);
            }
            if let Some(books) = &mut self.books {
                books.book_entry(&self.particles, newcomer.original as usize);
            }
        }
        self.admit_to_field(newcomers.len());
        if let Some(gas) = self.gas.as_mut().and_then(GasStage::flowing_mut) {
            gas.admit(newcomers.len());
        }
        self.resize_scratch();
        if are_loose {
            return Ok(());
        }
        self.rebuild(&[]);
        self.watch_guards()
    }

    /// Lets the last `count` grains feel and make the field. Velocities in the middle of the step are without
    /// the half of it that the kick adds at its end.
    fn admit_to_field(&mut self, count: usize) {
        let Some(field) = &mut self.field else { return };
        let brought = field.admit(&self.domain, &self.grains, &self.particles, count);
        for i in self.grains.len() - count..self.grains.len() {
            let gained = field.force_on(i) * (0.5 * self.progress.step_s * self.grains.inverse_mass[i]);
            self.grains.velocity[i] -= gained;
        }
        if let Some(feeding) = &mut self.feeding {
            feeding.state.brought.electric += brought;
        }
    }

    /// Accounts of the feeds, sorted by name; none without feeds.
    #[must_use]
    pub fn feeds(&self) -> Vec<FeedAccount> {
        self.feeding.iter().flat_map(Feeding::accounts).collect()
    }

    /// Energies and charge that grains brought when they came; zero without feeds.
    #[must_use]
    pub fn brought(&self) -> Brought {
        self.feeding.as_ref().map_or_else(Brought::default, |feeding| feeding.state.brought)
    }
}
