//! Charge traded at contacts that grow.
//!
//! Every step follows the contact areas. Their growth moves charge a few steps later for pairs of grains, and
//! at once at walls. The exponential update is exact for any growth, so that several steps' growth in one
//! update is the same charge.
//!
//! Contacts are taken one after another, each with the charges that the ones before it left: that keeps
//! networks of contacts bounded. The order follows the lists, which depend on the grains alone, so that
//! results do not depend on the number of threads. While contacts barely relax, halves of the grains trade
//! side by side and then with each other. Stiff contacts come after them, one by one, first to last and then
//! last to first in turn.
//!
//! The field of everything else at a contact, E_x, comes from the last evaluation of the field, see
//! `contact_field`. Between two evaluations charges change. As long as no contact has relaxed by a few per
//! cent since, that is left to the next evaluation, which the field asks for when charges have changed by its
//! tolerance. After that contacts see the present charges of the grains that touch theirs.

mod around;
mod contact_field;
mod materials;
mod pairs;
mod rounds;
mod spots;
mod state;
mod walls;

pub(crate) use rounds::Round;
pub use spots::ChargedSpot;
pub(crate) use state::ChargingState;

use crate::contacts::memory::{Follow, Foreseen, Growth, PairGrowth};
use crate::contacts::neighbours::Neighbours;
use crate::contacts::walls::{ContactWalls, Touching};
use crate::field_stage::FieldStage;
use crate::motion::grains::Grains;
use amberfield_core::{ChargeTransfer, Domain, FieldSettings, Material, Particles, Vector3};
use amberfield_laws::charge_transfer::Drive;
use amberfield_laws::dielectric_breakdown;
use around::Around;
use contact_field::{AtWall, Probe};
use materials::ChargingTable;
use pairs::MemberCharge;
use serde::{Deserialize, Serialize};
use spots::Spots;

/// Steps whose growth moves charge together.
const EVERY: u64 = 20;
/// Lag from which on contacts see the charges of the grains that touch theirs. The lag is the sum, over every
/// update since the last evaluation of the field, of the largest αΔA.
const LAG_SEEN: f64 = 0.02;
/// Lag at which the field is due.
const LAG_DUE: f64 = 0.1;
/// Account of the charge that has moved.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Σ of the sizes of all charges moved [C].
    pub moved: f64,
    /// Contacts that began, of grains and with walls.
    pub collisions: u64,
    /// Charge given to each wall [C].
    pub walls: Vec<f64>,
    /// Charge that the grains of each material gained [C].
    pub gained: Vec<f64>,
}

/// Things that a trade reads.
#[derive(Clone, Copy)]
pub(crate) struct Traders<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) grains: &'a Grains,
    pub(crate) field: &'a FieldStage,
}

impl Traders<'_> {
    /// Index in the set-up's order, if the grain takes part.
    fn member(&self, grain: usize) -> Option<usize> {
        let original = self.grains.original[grain].index();
        self.field.member[original].then_some(original)
    }
}

/// The stage that trades charge.
#[derive(Debug)]
pub(crate) struct Charging {
    settings: ChargeTransfer,
    permittivity: f64,
    coulomb: f64,
    table: ChargingTable,
    spots: Spots,
    pub(crate) ledger: Ledger,
    backwards: bool,
    /// Σ of the largest αΔA of every update since the last evaluation.
    lag: f64,
    /// Charges at the last evaluation, by the set-up's order [C].
    evaluated: Vec<f64>,
    /// Number of the last evaluation, and the steps since.
    evaluation: u64,
    age: u64,
    /// Steps whose growth between grains has not moved charge yet.
    gathered: u64,
    /// Contacts with walls that the last evaluation foresaw, sorted by grain.
    at_walls: Vec<AtWall>,
    probes: Vec<Probe>,
    around: Around,
    /// Charges in the making of a trade.
    held: Vec<MemberCharge>,
    /// Contacts with walls in the making of a trade.
    touches: Vec<Touching>,
    /// Sorted indices of the grains that traded with walls last.
    pub(crate) traded_at_walls: Vec<u32>,
}

impl Charging {
    pub(crate) fn new(
        settings: ChargeTransfer,
        field: &FieldSettings,
        materials: &[Material],
        particles: &Particles,
        walls: usize,
    ) -> Self {
        let permittivity = field.permittivity.absolute();
        let largest = particles.radius.iter().copied().fold(0.0, f64::max);
        Self {
            settings,
            permittivity,
            coulomb: field.permittivity.coulomb(),
            table: ChargingTable::new(materials, &settings, permittivity),
            spots: Spots::new(largest),
            ledger: Ledger {
                walls: vec![0.0; walls],
                gained: vec![0.0; materials.len()],
                ..Ledger::default()
            },
            backwards: false,
            lag: 0.0,
            evaluated: particles.charge.clone(),
            evaluation: 0,
            age: 0,
            gathered: 0,
            at_walls: Vec::new(),
            probes: Vec::new(),
            around: Around::default(),
            held: Vec::new(),
            touches: Vec::new(),
            traded_at_walls: Vec::new(),
        }
    }

    pub(crate) fn state(&self, particles: &Particles, neighbours: &Neighbours) -> ChargingState {
        let mut pairs = Vec::new();
        for (k, list) in neighbours.lists.iter().enumerate() {
            let all = list.growth.iter().zip(&list.foreseen).enumerate();
            let all = all.map(|(entry, (&growth, &foreseen))| PairGrowth {
                chunk: k as u32,
                entry: entry as u32,
                growth,
                foreseen,
            });
            let is_known =
                |pair: &PairGrowth| pair.growth != Growth::default() || pair.foreseen != Foreseen::default();
            pairs.extend(all.filter(is_known));
        }
        ChargingState {
            charge: particles.charge.clone(),
            evaluated: self.evaluated.clone(),
            pairs,
            spots: self.spots.all().to_vec(),
            ledger: self.ledger.clone(),
            backwards: self.backwards,
            lag: self.lag,
            evaluation: self.evaluation,
            age: self.age,
            gathered: self.gathered,
            at_walls: self.at_walls.clone(),
        }
    }

    /// Goes on from a state; `Err` says what does not fit.
    pub(crate) fn restore(
        &mut self,
        domain: &Domain,
        state: &ChargingState,
        neighbours: &mut Neighbours,
    ) -> Result<(), String> {
        for pair in &state.pairs {
            let list = neighbours.lists.get_mut(pair.chunk as usize);
            let entry = pair.entry as usize;
            let list = list.filter(|list| entry < list.growth.len());
            let list =
                list.ok_or_else(|| format!("charging of unknown contact {:?}", [pair.chunk, pair.entry]))?;
            (list.growth[entry], list.foreseen[entry]) = (pair.growth, pair.foreseen);
        }
        if state.ledger.walls.len() != self.ledger.walls.len()
            || state.ledger.gained.len() != self.ledger.gained.len()
            || state.evaluated.len() != self.evaluated.len()
        {
            return Err("charging of other walls or grains".to_owned());
        }
        self.evaluated.clone_from(&state.evaluated);
        self.spots.restore(domain, &state.spots);
        self.ledger = state.ledger.clone();
        (self.backwards, self.lag) = (state.backwards, state.lag);
        (self.evaluation, self.age, self.gathered) = (state.evaluation, state.age, state.gathered);
        self.at_walls.clone_from(&state.at_walls);
        Ok(())
    }

    /// Takes the charge of walls that move along with them.
    pub(crate) fn follow_walls(&mut self, domain: &Domain, walls: &ContactWalls) {
        self.spots.follow(domain, walls.placements());
    }

    /// Whether pairs trade in a step, where it may be put off for so many steps.
    pub(crate) fn is_due(step: u64, most: u64) -> bool {
        step.is_multiple_of(EVERY.min(most).max(1))
    }

    /// Rule by which contact areas are followed in a step.
    pub(crate) fn follow(&self, step: u64) -> Follow {
        Follow { moves: step > 0, beyond: self.settings.beyond_previous_maximum }
    }

    /// Whether contacts have relaxed so much that the field is due.
    pub(crate) fn wants_field(&self) -> bool {
        self.lag > LAG_DUE
    }

    /// Charged spots of walls, and the charge per area at each with its neighbours' [C/m²].
    pub(crate) fn spots(&self, domain: &Domain) -> impl Iterator<Item = (&ChargedSpot, f64)> {
        self.spots.all().iter().map(|spot| (spot, self.spots.density(domain, spot)))
    }

    /// Part of a transfer that the breakdown field allows, if there is one; `work` as in `PairCharging`.
    fn allowed(&self, drive: Drive, work: f64, transfer: f64) -> f64 {
        let Some(breakdown) = self.settings.breakdown_field_v_m else { return transfer };
        let normal_field = (drive.drive - work) / self.permittivity;
        dielectric_breakdown::bounded(transfer, normal_field, drive.decay / self.permittivity, breakdown)
    }
}

/// The place in the domain: wrapped, and on the near side of a face that rounding has passed.
fn inside(domain: &Domain, place: Vector3<f64>) -> Vector3<f64> {
    domain.wrap(place).sup(&domain.min()).inf(&domain.max())
}
