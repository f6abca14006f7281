//! Grains that come while the run goes on.

use super::Simulation;
use crate::error::DemError;
use crate::feeding::{Brought, FeedAccount, Feeding, Surroundings};
use crate::gas_stage::GasStage;

impl Simulation {
    /// Lets the grains in that are due and find a place; whether any came. The lists still lack them: the
    /// rebuild that must follow adds them.
    pub(super) fn admit_grains(&mut self) -> Result<bool, DemError> {
        let Some(feeding) = &mut self.feeding else { return Ok(false) };
        if let Some(walls) = &mut self.contacts.walls {
            walls.settle();
        }
        let newcomers = feeding.newcomers(&Surroundings {
            domain: &self.domain,
            particles: &self.particles,
            grains: &self.grains,
            walls: self.contacts.walls.as_ref(),
            gravity: self.time.gravity_m_s2,
            skin_m: self.progress.skin_m,
            step_index: self.progress.step_index,
            step_s: self.progress.step_s,
        })?;
        if newcomers.is_empty() {
            return Ok(false);
        }
        // What contacts have yet to trade is known by the old lists.
        self.trade_between_grains();
        let turns = self.contacts.features.rotation();
        for newcomer in &newcomers {
            self.grains.admit(&self.particles, newcomer, turns);
            if let Some(feeding) = &mut self.feeding {
                feeding.book(&self.particles, newcomer, self.time.gravity_m_s2);
            }
            if let Some(books) = &mut self.books {
                books.book_entry(&self.particles, newcomer.original as usize);
            }
        }
        if let Some(field) = &mut self.field {
            field.admit(&self.domain, &self.grains, &self.particles, newcomers.len());
        }
        if let Some(gas) = self.gas.as_mut().and_then(GasStage::flowing_mut) {
            gas.admit(newcomers.len());
        }
        self.resize_scratch();
        Ok(true)
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
