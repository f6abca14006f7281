//! Rounds of trade: between grains every few steps, with walls in every step.

use super::{Charging, Traders};
use crate::contacts::Contacts;
use crate::field_stage::{Extras, FieldStage};
use crate::motion::grains::Grains;
use amberfield_core::Domain;

/// Time for which contacts are foreseen, over the field's present interval: the field may be evaluated later
/// than thought.
const FORESIGHT: f64 = 2.0;

/// Everything that a round of trade reads and changes.
pub(crate) struct Round<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) grains: &'a Grains,
    pub(crate) contacts: &'a mut Contacts,
    pub(crate) field: &'a mut FieldStage,
    /// Charges by the set-up's order [C].
    pub(crate) charge: &'a mut [f64],
}

impl Round<'_> {
    fn traders(&self) -> Traders<'_> {
        Traders { domain: self.domain, grains: self.grains, field: self.field }
    }
}

impl Charging {
    /// Follows the contact areas of walls in a step, 0 for the start, as the forces do those of pairs, and
    /// counts the contacts that begin.
    pub(crate) fn follow_areas(&mut self, step: u64, grains: &Grains, contacts: &mut Contacts) {
        self.age += 1;
        self.gathered += 1;
        self.ledger.collisions +=
            contacts.neighbours.lists.iter().map(|list| list.met.len() as u64).sum::<u64>();
        if let Some(walls) = &mut contacts.walls {
            self.ledger.collisions += walls.follow(grains, self.follow(step));
        }
    }

    /// Moves what is due between pairs of grains, and tells the field.
    pub(crate) fn trade_between_grains(&mut self, round: Round<'_>) {
        let Round { domain, grains, contacts, field, charge } = round;
        self.trade_pairs(Traders { domain, grains, field }, &mut contacts.neighbours, charge);
        field.recharge(0..grains.len(), &grains.original, charge);
    }

    /// Moves what is due between grains and walls, and tells the field.
    pub(crate) fn trade_with_walls(&mut self, round: Round<'_>) {
        let Round { domain, grains, contacts, field, charge } = round;
        let Some(walls) = &mut contacts.walls else { return };
        self.trade_walls(Traders { domain, grains, field }, &contacts.neighbours, walls, charge);
        let traded = self.traded_at_walls.iter().map(|&grain| grain as usize);
        field.recharge(traded, &grains.original, charge);
    }

    /// Lists the contacts at which the next evaluation gives E, and the charges of walls, into `extras`.
    /// A grain moves at most `travel` [m] in a step; pairs farther apart than the `skin` [m] are not listed.
    pub(crate) fn ask_field(&mut self, round: &Round<'_>, travel: f64, skin: f64, extras: &mut Extras) {
        extras.clear();
        let steps = FORESIGHT * round.field.intervals().steps_now as f64;
        let reach = travel * steps;
        let margins = [(2.0 * reach).min(skin), reach];
        self.ask(round.traders(), round.contacts, round.charge, margins, extras);
    }

    /// Takes E at what was asked for.
    pub(crate) fn take_field(&mut self, field: &FieldStage, contacts: &mut Contacts, charge: &[f64]) {
        self.take(field, &mut contacts.neighbours, charge);
    }
}
