//! Contacts of another run, from whose checkpoint a set-up has its grains.

use super::Simulation;
use super::state::State;
use crate::contacts::material_pairs::PairTable;
use crate::contacts::memory::{CarriedPair, ContactsState, PairHistory, WallHistory};
use crate::contacts::walls::{SAME_CONTACT, of_grain};
use crate::error::DemError;
use crate::motion::grains::{GrainsState, Original};
use crate::setup::Setup;
use amberfield_core::{ContactRules, MaterialId, Vector3, WallRule};

/// Overlap with a wall over that in the run before, up to which it is no new one.
const AS_DEEP: f64 = 1.000_001;

/// Run from whose checkpoint a set-up has its grains.
#[derive(Clone, Debug)]
pub struct Earlier {
    /// State of that run. The grains of the set-up are those that are in it, in the order of its set-up.
    pub state: State,
    /// Rules of its contacts.
    pub rules: ContactRules,
    /// Whether the scene is the same but for where its grains come from, so that forces go on too.
    pub is_same: bool,
}

/// Memory of the contacts of another run, by the order of the set-up.
#[derive(Debug)]
pub(super) struct Carried {
    /// Pairs that have the same rules in both runs, sorted by [`CarriedPair::key`].
    pairs: Vec<CarriedPair>,
    /// Contacts with walls that are the same in both runs, sorted by grain.
    walls: Vec<WallHistory>,
    /// Keys of all pairs that touched, sorted.
    touched: Vec<[Original; 2]>,
    /// All contacts with walls, sorted by grain.
    at_walls: Vec<WallHistory>,
    /// Loads of each grain at the last step; `None` where the scenes differ.
    loads: Option<GrainLoads>,
}

/// Loads of grains.
#[derive(Debug)]
struct GrainLoads {
    /// Forces without gravity [N].
    force: Vec<Vector3<f64>>,
    /// Torques [N·m]; empty where nothing can turn a grain.
    torque: Vec<Vector3<f64>>,
    /// Rates at which contacts slow grains [1/s].
    slowing: Vec<f64>,
}

impl Carried {
    /// Memory of contacts for a set-up that is not merged with its feeds yet.
    fn new(setup: &Setup, earlier: Earlier) -> Result<Self, DemError> {
        let Earlier { state: State { grains, contacts, .. }, rules, is_same } = earlier;
        let misfit = || DemError::State("its grains are not those of the set-up".to_owned());
        let place = Places::new(setup, &grains).ok_or_else(misfit)?;
        let rules = Rules::new(setup, &rules);
        let (mut touched, mut pairs) = (Vec::new(), Vec::new());
        for history in &contacts.pairs {
            let pair = carried_pair(history, &grains, &place).ok_or_else(misfit)?;
            touched.push(CarriedPair::key(pair.grains));
            let [a, b] = pair.grains.map(|grain| setup.particles.material[grain.index()]);
            if rules.are_same(a, b) {
                pairs.push(pair);
            }
        }
        touched.sort_unstable();
        pairs.sort_unstable_by_key(|pair| CarriedPair::key(pair.grains));
        let (mut walls, mut at_walls) = (Vec::new(), Vec::new());
        let ContactsState { walls: histories, touched: numbers, .. } = contacts;
        for (history, &wall) in histories.iter().zip(&numbers) {
            let grain = place.of(history.grain).ok_or_else(misfit)?;
            // Triangles are those of another body; the next evaluation finds the one that is touched.
            let history = WallHistory { grain, triangle: 0, ..*history };
            at_walls.push(history);
            if rules.know_wall(setup.particles.material[grain.index()], wall) {
                walls.push(history);
            }
        }
        walls.sort_by_key(|history| history.grain);
        at_walls.sort_by_key(|history| history.grain);
        let loads = is_same.then(|| GrainLoads::new(&grains, &place));
        Ok(Self { pairs, walls, touched, at_walls, loads })
    }

    /// Whether a pair touched.
    pub(super) fn has_pair(&self, pair: [Original; 2]) -> bool {
        self.touched.binary_search(&CarriedPair::key(pair)).is_ok()
    }

    /// Whether a grain touched a wall in nearly a direction, as deep as an overlap [m].
    pub(super) fn has_wall(&self, grain: Original, normal: &Vector3<f64>, overlap: f64) -> bool {
        of_grain(&self.at_walls, grain).iter().any(|history| {
            normal.dot(&Vector3::from(history.normal)) > SAME_CONTACT && overlap <= AS_DEEP * history.overlap
        })
    }
}

/// Memory of a pair by the order of the set-up; `None` for one of unknown grains.
fn carried_pair(history: &PairHistory, grains: &GrainsState, places: &Places) -> Option<CarriedPair> {
    let first = places.of(*grains.original.get(history.i as usize)?)?;
    let second = places.of(history.partner)?;
    Some(CarriedPair { grains: [first, second], spring: history.spring, rolling: history.rolling })
}

/// Places of the grains of a state among those of the set-up.
struct Places {
    /// Indices in the other set-up's order, sorted: the grain of each is the one of that index in this one.
    sorted: Vec<Original>,
}

impl Places {
    /// Places of the grains of a state; `None` where they are not those of the set-up.
    fn new(setup: &Setup, grains: &GrainsState) -> Option<Self> {
        let mut sorted = grains.original.clone();
        sorted.sort_unstable();
        let fits = sorted.len() == setup.particles.len() && sorted.is_sorted_by(|a, b| a < b);
        fits.then_some(Self { sorted })
    }

    /// Index in this set-up of a grain of the other one.
    fn of(&self, original: Original) -> Option<Original> {
        self.sorted.binary_search(&original).ok().map(Original::new)
    }
}

impl GrainLoads {
    /// Loads of a state by the order of the set-up.
    fn new(grains: &GrainsState, places: &Places) -> Self {
        let mut order: Vec<usize> = (0..grains.original.len()).collect();
        order.sort_unstable_by_key(|&i| places.of(grains.original[i]));
        let vectors = |array: &[Vector3<f64>]| order.iter().filter_map(|&i| array.get(i).copied()).collect();
        Self {
            force: vectors(&grains.force),
            torque: vectors(&grains.torque),
            slowing: order.iter().filter_map(|&i| grains.slowing.get(i).copied()).collect(),
        }
    }
}

/// Rules of contacts in both runs.
struct Rules<'a> {
    setup: &'a Setup,
    before: &'a ContactRules,
    table: PairTable,
    table_before: PairTable,
    walls: Vec<WallRule>,
}

impl<'a> Rules<'a> {
    fn new(setup: &'a Setup, before: &'a ContactRules) -> Self {
        Self {
            setup,
            before,
            table: PairTable::new(&setup.materials, &setup.pairs, setup.cohesion),
            table_before: PairTable::new(&before.materials, &before.pairs, before.cohesion),
            walls: setup.walls.iter().map(WallRule::of).collect(),
        }
    }

    /// Number in the run before of a material, by its name.
    fn before(&self, material: MaterialId) -> Option<u16> {
        let name = &self.setup.materials.get(usize::from(material.0))?.name;
        let number = self.before.materials.iter().position(|known| known.name == *name)?;
        u16::try_from(number).ok()
    }

    /// Whether contacts of two materials had the same springs.
    fn are_same(&self, a: MaterialId, b: MaterialId) -> bool {
        let (Some(old_a), Some(old_b)) = (self.before(a), self.before(b)) else { return false };
        let (pair, pair_before) = (self.table.get(a.0, b.0), self.table_before.get(old_a, old_b));
        let work = self.table.work(a.0, b.0) == self.table_before.work(old_a, old_b);
        let rolls = pair.rolling > 0.0 && self.setup.rolling_model != self.before.rolling_model;
        pair.has_springs_of(pair_before) && work && self.setup.cohesion == self.before.cohesion && !rolls
    }

    /// Whether a wall of the run before is still there, with the same springs to grains of a material.
    fn know_wall(&self, grain: MaterialId, number: u32) -> bool {
        let Some(before) = self.before.walls.get(number as usize) else { return false };
        let is_it = |wall: &WallRule| {
            let stays = wall.is_at_rest && before.is_at_rest && wall.shape == before.shape;
            let material = self.before(wall.material) == Some(before.material.0);
            stays && material && self.are_same(grain, wall.material)
        };
        self.walls.iter().any(is_it)
    }
}

impl Simulation {
    /// Checks a scene whose grains are from a checkpoint of another run, builds its stages and computes the
    /// forces at the start. Contacts go on where their rules are the same.
    ///
    /// # Errors
    /// As [`Self::new`], without overlaps that the run had, and a state of other grains.
    pub fn filled(setup: Setup, earlier: Earlier) -> Result<Self, DemError> {
        let carried = Carried::new(&setup, earlier)?;
        Self::begin(setup, Some(&carried))
    }

    /// Gives contacts, which no force has been computed for yet, what they have from another run.
    pub(super) fn carry(&mut self, carried: Option<&Carried>) {
        let Some(carried) = carried else { return };
        self.contacts.neighbours.carry(&self.grains, &carried.pairs);
        if let Some(walls) = &mut self.contacts.walls {
            walls.build(&self.domain, &self.grains, self.progress.skin_m, &carried.walls);
        }
    }

    /// Gives contacts what they have from another run once more: evaluations at the start, which are no
    /// steps, have bent it by rounding and by dashpots.
    pub(super) fn carry_exactly(&mut self, carried: Option<&Carried>) {
        let Some(carried) = carried else { return };
        self.contacts.carry(&self.grains, &carried.pairs, &carried.walls);
        let Some(loads) = &carried.loads else { return };
        let grains = &mut self.grains;
        for i in 0..grains.len() {
            let original = grains.original[i].index();
            // Grains of feeds have yet to come.
            let Some(force) = loads.force.get(original) else { continue };
            grains.force[i] = *force;
            grains.slowing[i] = loads.slowing[original];
            if let (Some(torque), Some(before)) = (grains.torque.get_mut(i), loads.torque.get(original)) {
                *torque = *before;
            }
        }
    }
}
