//! Charges in a step: contacts that trade them, the field that they make, and the guards that they set.

use super::Simulation;
use super::guards::{Stiffness, electric_stiffness, electric_stiffness_bound, electric_stiffness_of};
use super::state::Progress;
use super::timing::Stage;
use crate::charging::{ChargedSpot, Charging, Ledger, Round};
use crate::error::DemError;
use crate::feeding::Feeding;
use crate::field_stage::{FieldStage, Moment};

impl Simulation {
    /// Follows the areas of contacts, and moves the charge that is due: between grains every few steps, with
    /// walls in every step.
    pub(super) fn charge_contacts(&mut self) {
        if self.charging.is_none() {
            return;
        }
        self.follow_contact_areas();
        let most = self.field.as_ref().map_or(u64::MAX, FieldStage::most_steps_of_trades);
        if Charging::is_due(self.progress.step_index, most) {
            self.trade_between_grains();
        }
        self.trade_with_walls();
        self.watch.lap(Stage::Charging);
    }

    /// Follows the areas of contacts without moving charge.
    pub(super) fn follow_contact_areas(&mut self) {
        if let Some(charging) = &mut self.charging {
            charging.follow_areas(self.progress.step_index, &self.grains, &mut self.contacts);
        }
    }

    /// Evaluates the field where it is due: its interval has ended, or the charges have changed too much;
    /// whether it was.
    pub(super) fn evaluate_field_where_due(&mut self) -> Result<bool, DemError> {
        let Progress { step_s, speed, .. } = self.progress;
        if let Some(field) = &mut self.field {
            field.book_impacts(&self.domain, &self.grains, &self.contacts, step_s);
        }
        let interval_ended = self.field.as_mut().is_some_and(|field| field.is_due(step_s, speed));
        let turned = self.field.as_ref().is_some_and(FieldStage::impacts_are_due);
        let due = interval_ended || turned || self.charges_have_changed();
        if due {
            self.evaluate_field()?;
        } else if let Some(field) = &mut self.field {
            field.book_forecast(&self.grains);
        }
        Ok(due)
    }

    /// Whether charges have changed, or contacts have relaxed, so much that the field is due before its
    /// interval ends.
    fn charges_have_changed(&mut self) -> bool {
        let Some(field) = &mut self.field else { return false };
        let relaxed = self.charging.as_ref().is_some_and(Charging::wants_field);
        field.charges_have_changed(&self.grains) || (relaxed && field.is_automatic())
    }

    /// Evaluates the field at the present positions and charges, and at the contacts that trade.
    pub(super) fn evaluate_field(&mut self) -> Result<(), DemError> {
        let Progress { step_s, speed, skin_m, .. } = self.progress;
        let time_s = self.progress.time_s();
        self.trade_between_grains();
        let Some(field) = &mut self.field else { return Ok(()) };
        let extras = &mut self.scratch.extras;
        if let Some(charging) = &mut self.charging {
            if let Some(walls) = &mut self.contacts.walls {
                walls.settle();
            }
            let round = Round {
                domain: &self.domain,
                grains: &self.grains,
                contacts: &mut self.contacts,
                field: &mut *field,
                charge: &mut self.particles.charge,
            };
            charging.ask_field(&round, speed * step_s, skin_m, extras);
        }
        let moment = Moment { time_s, step_s };
        field.evaluate(&self.domain, &self.grains, &self.particles, extras, moment)?;
        self.limits.set_plasma(field.plasma_limit);
        if let Some(charging) = &mut self.charging {
            charging.take_field(field, &mut self.contacts, &self.particles.charge);
        }
        Ok(())
    }

    /// Adds the electric forces of a step: E as it was evaluated in it, or on the line through the last two
    /// evaluations.
    pub(super) fn add_electric_forces(&mut self) {
        self.add_electric_forces_at_start();
        if let Some(field) = &mut self.field {
            field.book_step();
            self.watch.lap(Stage::Field);
        }
    }

    /// Adds the electric forces without booking a step.
    pub(super) fn add_electric_forces_at_start(&mut self) {
        let Progress { step_s, skin_m, .. } = self.progress;
        if let Some(field) = &mut self.field {
            field.add_forces(&self.grains, skin_m, step_s, &mut self.scratch.loads.force);
        }
    }

    /// Moves what is due between pairs of grains.
    pub(super) fn trade_between_grains(&mut self) {
        self.trade(Charging::trade_between_grains);
    }

    /// Moves what is due between grains and walls.
    fn trade_with_walls(&mut self) {
        self.trade(Charging::trade_with_walls);
    }

    /// Runs a round of trade, where charge is traded at all.
    fn trade(&mut self, round_of: fn(&mut Charging, Round<'_>)) {
        let (Some(charging), Some(field)) = (&mut self.charging, &mut self.field) else { return };
        let round = Round {
            domain: &self.domain,
            grains: &self.grains,
            contacts: &mut self.contacts,
            field,
            charge: &mut self.particles.charge,
        };
        round_of(charging, round);
    }

    /// Checks the guards anew at the present speed and charges. The pairs are looked at only where a bound
    /// for any of them does not do.
    pub(super) fn watch_guards(&mut self) -> Result<(), DemError> {
        if let Some(field) = &self.field {
            let (grains, particles) = (&self.grains, &self.particles);
            let bound = electric_stiffness_bound(grains, particles, &field.member, field.permittivity());
            self.limits.set_electric(bound, field.plasma_limit);
            if self.limits.broken(&self.progress).is_some() {
                self.update_electric_limits();
            }
        }
        self.watch_guards_where(true)
    }

    /// Checks the guards as they are, at the present speed, where something is `new`: charges and pairs are
    /// looked at when lists are rebuilt; an exchange with a gas or an evaluation of the field changes
    /// density and speeds.
    pub(super) fn watch_guards_where(&mut self, new: bool) -> Result<(), DemError> {
        if !new {
            return Ok(());
        }
        self.limits.watch(&self.progress, self.time.allow_unstable)
    }

    /// Computes the electric guards of the present pairs.
    pub(super) fn update_electric_limits(&mut self) {
        if let (Some(stiffness), Some(field)) = (self.electric_stiffness(), &self.field) {
            self.limits.set_electric(stiffness, field.plasma_limit);
        }
    }

    /// Stiffness limits of the present pairs, and of grains that have yet to come with their like; `None`
    /// without a field.
    pub(super) fn electric_stiffness(&self) -> Option<Stiffness> {
        let field = self.field.as_ref()?;
        let now = electric_stiffness(
            &self.domain,
            &self.grains,
            &self.particles,
            &field.member,
            field.permittivity(),
            self.contacts.neighbours.pairs().map(|pair| (pair.i, pair.j)),
        );
        let later = self.feeding.iter().flat_map(Feeding::still_to_come).filter(|grain| field.member[*grain]);
        let like = later
            .map(|grain| electric_stiffness_of(&self.domain, &self.particles, grain, field.permittivity()));
        Some(like.fold(now, Stiffness::tighter))
    }

    /// Charge that charge transfer has moved, walls by their number; `None` without it.
    #[must_use]
    pub fn ledger(&self) -> Option<&Ledger> {
        self.charging.as_ref().map(|charging| &charging.ledger)
    }

    /// Spots of walls that have been charged, with the charge per area at each [C/m²].
    pub fn charged_spots(&self) -> impl Iterator<Item = (&ChargedSpot, f64)> {
        self.charging.iter().flat_map(|charging| charging.spots(&self.domain))
    }
}

#[cfg(test)]
mod tests;
