//! Contacts of grains with each other and with walls: who is near whom, the law, what contacts remember.
//!
//! Nothing here knows of fields, gases or charges: `examples/bare_bed.rs` compiles this folder and
//! `motion/` alone, and `cargo xtask leaving-out` compares a whole run with it.

pub(crate) mod batch;
pub(crate) mod cells;
pub(crate) mod law;
pub(crate) mod loose;
pub(crate) mod material_pairs;
pub(crate) mod memory;
pub(crate) mod neighbours;
pub(crate) mod normal;
pub(crate) mod pairs;
pub(crate) mod walls;

use crate::motion::chunks::Loads;
use crate::motion::grains::Grains;
use amberfield_core::Domain;
use material_pairs::{Features, PairTable};
use memory::{CarriedPair, ContactsState, Follow, WallHistory};
use neighbours::Neighbours;
use pairs::pair_forces;
use walls::ContactWalls;

/// All contacts of a scene.
#[derive(Debug)]
pub(crate) struct Contacts {
    /// Constants of every pair of materials.
    pub(crate) table: PairTable,
    /// Terms of the contact law that the scene needs.
    pub(crate) features: Features,
    /// Pairs of grains that are near each other.
    pub(crate) neighbours: Neighbours,
    /// Walls and the grains near them; `None` without walls.
    pub(crate) walls: Option<ContactWalls>,
}

/// Overlaps over the smaller radius.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depths {
    /// Largest of grains with each other.
    pub(crate) grains: f64,
    /// Largest of grains with walls.
    pub(crate) walls: f64,
}

impl Contacts {
    /// Sums what grains do to each other into `loads`, which are overwritten; what acts on other chunks waits
    /// in the outboxes. `step` [s] advances the springs.
    pub(crate) fn push_grains(
        &mut self,
        grains: &Grains,
        step: f64,
        follow: Option<Follow>,
        loads: &mut Loads,
    ) {
        pair_forces(grains, &mut self.neighbours, &self.table, step, follow, loads);
    }

    /// Adds what walls do to grains at a time [s]; `step` [s] advances the springs.
    pub(crate) fn push_off_walls(&mut self, grains: &Grains, time: f64, step: f64, loads: &mut Loads) {
        if let Some(walls) = &mut self.walls {
            walls.forces(grains, &self.table, self.features, step, loads);
            walls.book_motion(grains, &self.table, time, step);
        }
    }

    /// Moves walls to a time [s], after a step [s].
    pub(crate) fn move_walls(&mut self, time: f64, step: f64) {
        if let Some(walls) = &mut self.walls {
            walls.advance(time, step);
        }
    }

    /// Largest overlaps over the smaller radius at the last evaluation.
    pub(crate) fn depths(&self) -> Depths {
        let grains = self.neighbours.lists.iter().map(|list| list.deepest).fold(0.0, f64::max);
        Depths { grains, walls: self.walls.as_ref().map_or(0.0, ContactWalls::deepest) }
    }

    /// Number of touching contacts, of grains and with walls, at the last evaluation.
    pub(crate) fn count(&self) -> usize {
        self.neighbours.contacts() + self.walls.as_ref().map_or(0, ContactWalls::contacts)
    }

    /// Histories of the contacts with walls; they find their grains again in any order.
    pub(crate) fn wall_histories(&self, grains: &Grains) -> Vec<WallHistory> {
        self.walls.as_ref().map(|walls| walls.histories(grains)).unwrap_or_default()
    }

    /// Lists anew who is near whom, within a `skin` [m]; grains after the first `listed` are loose.
    /// `order[new] = old` tells where each grain was when the present lists were built, so that histories
    /// move along; those of walls were taken before.
    pub(crate) fn list(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        listed: usize,
        order: &[u32],
        skin: f64,
        wall_histories: &[WallHistory],
    ) {
        self.neighbours.build(domain, grains, listed, order);
        if let Some(walls) = &mut self.walls {
            walls.build(domain, grains, skin, wall_histories);
        }
    }

    /// State for a checkpoint.
    pub(crate) fn state(&self, grains: &Grains) -> ContactsState {
        ContactsState {
            reference: self.neighbours.reference.clone(),
            listed: self.neighbours.listed,
            pairs: self.neighbours.histories(grains),
            walls: self.wall_histories(grains),
            touched: self.walls.as_ref().map(|walls| walls.touched(grains)).unwrap_or_default(),
            moving: self.walls.as_ref().and_then(ContactWalls::moving_state),
        }
    }

    /// Gives contacts the memory that they had in another run: pairs sorted by [`CarriedPair::key`], walls by
    /// grain.
    pub(crate) fn carry(&mut self, grains: &Grains, pairs: &[CarriedPair], walls: &[WallHistory]) {
        self.neighbours.carry(grains, pairs);
        if let Some(of_walls) = &mut self.walls {
            of_walls.carry(grains, walls);
        }
    }

    /// Lists grains that stand where a state's lists were built, and puts its histories back; `Err` says
    /// which of them finds no contact.
    pub(crate) fn restore(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        skin: f64,
        state: &ContactsState,
    ) -> Result<(), String> {
        if let Some(walls) = &mut self.walls {
            walls.restore_moving(state.moving.as_ref())?;
        }
        let order: Vec<u32> = (0..grains.len() as u32).collect();
        let listed = state.listed;
        if listed > grains.len() {
            return Err(format!("its lists know {listed} of {} grains", grains.len()));
        }
        self.list(domain, grains, listed, &order, skin, &state.walls);
        self.neighbours.restore(grains, &state.pairs)
    }
}
