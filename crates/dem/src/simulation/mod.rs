//! One run: the stages of a scene and the order in which they act.

pub(crate) mod books;
mod check_motion;
pub(crate) mod checks;
pub(crate) mod earlier;
mod electric;
pub(crate) mod energy;
pub(crate) mod exits;
mod feeds;
pub(crate) mod guards;
mod observe;
pub(crate) mod outlook;
mod overlaps;
mod plan;
mod start;
pub(crate) mod state;
pub(crate) mod timing;

pub use overlaps::Deepest;

use crate::books::Books;
use crate::charging::Charging;
use crate::contacts::loose::MOST_LOOSE;
use crate::contacts::{Contacts, Depths};
use crate::error::DemError;
use crate::feeding::Feeding;
use crate::field_stage::{Extras, FieldStage};
use crate::gas_stage::GasStage;
use crate::motion::chunks::{Loads, chunk_count};
use crate::motion::grains::{Grains, SortKey};
use crate::motion::verlet::{Bounds, ChunkMotion, drift, kick};
use crate::outlets::Outlets;
use amberfield_core::{Domain, Particles, Plan, TimeSettings};
use exits::{Exit, WaysOut};
use guards::Limits;
use state::{Progress, State};
use timing::{Stage, StageClock};

/// Margin of the displacement test against round-off.
pub(crate) const HALF_SKIN: f64 = 0.499_999;

/// A run: the stages of a scene.
///
/// A step ([`Self::step`]) runs them in this order; the equations are in `docs/equations.md`, the sections
/// are named here:
///
/// 1. *Begin*: count the step; keep the state where another process may be lost in it; potentials that
///    change go on to the step's end ("Potentials that change").
/// 2. *Drift*: first half of velocity Verlet ("Motion"); walls that move go where they are at the new time.
/// 3. *Exits*: grains beyond an open face, or at a face that mirrors charges, end the run or are removed;
///    those in an outlet are removed.
/// 4. *Lists*: wrap periodic axes, sort grains in space, list neighbours anew, where a grain may have used
///    up half the skin; look at the guards ("Time step").
/// 5. *Feeds*: grains that are due come where there is room for them, every few steps; where they are alone
///    they need no list yet.
/// 6. *Grains*: contact forces of grains on each other, F_n and F_t ("Motion").
/// 7. *Walls*: contact forces of walls, by the same law; overlaps are watched.
/// 8. *Gas*: drag, buoyancy and lift, after an exchange with a gas that flows where one is due ("Gas").
/// 9. *Charging*: contact areas A are followed; what they grew by moves charge, dT/dA ("Charge transfer").
/// 10. *Field*: E is evaluated where it is due ("Electric field"), else extrapolated; qE is added.
/// 11. *Guards*: are looked at again where gas or field are new ("Time step").
/// 12. *Kick*: second half of velocity Verlet ("Motion").
///
/// After an error of [`Self::step`] the grains are between two steps: do not step on.
#[derive(Debug)]
pub struct Simulation {
    /// Box, with its periodic axes.
    domain: Domain,
    /// Box that grains may not leave: infinite along periodic axes.
    bounds: Bounds,
    /// Settings of the run.
    time: TimeSettings,
    /// Particles as set up: ids, sizes, charges; their motion is in `grains`.
    particles: Particles,
    plan: Plan,
    progress: Progress,
    grains: Grains,
    contacts: Contacts,
    gas: Option<GasStage>,
    charging: Option<Charging>,
    field: Option<FieldStage>,
    feeding: Option<Feeding>,
    outlets: Option<Outlets>,
    books: Option<Books>,
    limits: Limits,
    /// Largest overlaps that the run may have at present.
    allowed: Depths,
    scratch: Scratch,
    ways_out: WaysOut,
    /// Grains that have left since somebody asked.
    exits: Vec<Exit>,
    /// State before a step in which another process may be lost.
    rescued: Option<State>,
    watch: StageClock,
}

/// Memory in which a step works; nothing in it is state.
#[derive(Debug, Default)]
struct Scratch {
    /// Forces, torques and dampings in the making.
    loads: Loads,
    /// Findings of the drift, by chunk.
    motion: Vec<ChunkMotion>,
    /// Keys of the sort.
    keys: Vec<SortKey>,
    /// Order of the sort.
    order: Vec<u32>,
    /// Charges of walls and contacts that take part in an evaluation of the field.
    extras: Extras,
}

impl Simulation {
    /// Advances by one step.
    ///
    /// # Errors
    /// A grain that leaves or whose position is not finite, a step that a guard no longer allows, a field
    /// that fails.
    pub fn step(&mut self) -> Result<(), DemError> {
        let step_s = self.progress.step_s;
        self.begin_step();
        self.move_walls();
        let outside = self.drift();
        let gone = if outside || self.outlets.is_some() { self.handle_exits()? } else { Vec::new() };
        self.renew_lists(&gone)?;
        self.admit_grains()?;
        self.push_grains(step_s);
        self.push_off_walls(step_s);
        self.watch_overlaps()?;
        let exchanged = self.exchange_with_gas()?;
        self.add_gas_forces(step_s);
        self.charge_contacts();
        let evaluated = self.evaluate_field_where_due()?;
        self.add_electric_forces();
        self.watch_guards_where(exchanged || evaluated)?;
        self.kick(step_s);
        Ok(())
    }

    /// The state before the step that failed, where a field solver was asked in it: nothing is lost with the
    /// solver.
    pub fn rescued(&mut self) -> Option<State> {
        self.rescued.take()
    }

    /// Counts the step, and keeps the state before it where a field solver may be lost in it. Potentials that
    /// change are those of the step's end from here on.
    fn begin_step(&mut self) {
        self.watch.start();
        let Progress { step_s, speed, .. } = self.progress;
        let may_be_lost = self.field.as_ref().is_some_and(|field| field.may_be_lost(step_s, speed));
        // Only its solver knows the state of a gas that flows.
        let flows = self.gas.as_ref().is_some_and(|gas| gas.flowing().is_some());
        self.rescued = (may_be_lost && !flows).then(|| self.state());
        self.progress.step_index += 1;
        let time_s = self.progress.time_s();
        if let Some(field) = &mut self.field {
            field.advance(time_s, step_s, &self.grains);
        }
    }

    /// Moves walls that move to the end of the step, and their charge with them.
    fn move_walls(&mut self) {
        self.contacts.move_walls(self.progress.time_s(), self.progress.step_s);
        self.carry_charge_of_walls();
    }

    /// Takes the charge of walls that move to where they are.
    fn carry_charge_of_walls(&mut self) {
        if let (Some(charging), Some(walls)) = (&mut self.charging, &self.contacts.walls) {
            charging.follow_walls(&self.domain, walls);
        }
    }

    /// Moves the grains; whether one of them may leave now.
    fn drift(&mut self) -> bool {
        let gravity = self.time.gravity_m_s2;
        let step_s = self.progress.step_s;
        let motion = drift(&mut self.grains, gravity, step_s, &self.bounds, &mut self.scratch.motion);
        self.progress.speed = motion.speed;
        self.progress.pace = self.limits.pace(&self.grains, step_s, motion.speed);
        motion.outside || self.touches_face()
    }

    /// Lists anew who is near whom where that may have changed: grains (ascending sorted indices) are gone,
    /// or one may have moved by half the skin.
    fn renew_lists(&mut self, gone: &[usize]) -> Result<(), DemError> {
        self.watch.lap(Stage::Integrate);
        self.progress.travel += self.progress.step_s * self.progress.speed;
        let are_old = self.has_used_up_skin() || self.walls_have_moved() || !gone.is_empty();
        if are_old {
            self.rebuild(gone);
        }
        if are_old || self.limits.is_too_fast(self.progress.step_s, self.progress.pace) {
            self.watch_guards()?;
        }
        self.watch.lap(Stage::Neighbours);
        Ok(())
    }

    /// Whether a grain may have moved by half the skin since the lists were built. The travel is only a
    /// bound; when it is used up, the displacements themselves decide.
    fn has_used_up_skin(&mut self) -> bool {
        let limit = HALF_SKIN * self.progress.skin_m;
        if self.progress.travel <= limit {
            return false;
        }
        self.contacts.renew_loose(&self.domain, &mut self.grains, self.progress.travel);
        let reference = &self.contacts.neighbours.reference;
        let displacement2 = reference
            .iter()
            .enumerate()
            .map(|(i, x)| (self.grains.position(i) - x).norm_squared())
            .fold(0.0, f64::max);
        self.progress.travel = displacement2.sqrt();
        self.progress.travel > limit
    }

    /// Whether a wall may have moved by its share of the skin since the lists were built: a half, or what
    /// leaves enough for a look at whether it stands on a face.
    fn walls_have_moved(&self) -> bool {
        let Some(walls) = &self.contacts.walls else { return false };
        let travel = walls.travel();
        travel > 0.0 && travel > self.ways_out.share_of_walls() * self.progress.skin_m
    }

    /// Wraps, sorts and lists the grains anew, without those that are gone (ascending sorted indices);
    /// histories move along. Loose grains that are alone stay loose, at the end.
    fn rebuild(&mut self, gone: &[usize]) {
        self.trade_between_grains();
        let mut loose = self.contacts.still_alone(&self.domain, &self.grains, self.progress.travel);
        loose.retain(|i| gone.binary_search(i).is_err());
        loose.drain(..loose.len().saturating_sub(MOST_LOOSE / 2));
        if self.bounds.is_periodic() {
            self.grains.wrap(&self.domain);
        }
        let mut order = std::mem::take(&mut self.scratch.order);
        self.grains.spatial_order(&mut self.scratch.keys, &mut order);
        if !(gone.is_empty() && loose.is_empty()) {
            let is_in = |list: &[usize], index: u32| list.binary_search(&(index as usize)).is_ok();
            order.retain(|&i| !is_in(gone, i) && !is_in(&loose, i));
        }
        let listed = order.len();
        order.extend(loose.iter().map(|&i| i as u32));
        self.list(&order, listed);
        self.scratch.order = order;
        self.progress.travel = 0.0;
        if !gone.is_empty() {
            self.resize_scratch();
        }
    }

    /// Reorders the grains to `order[new] = old` and lists the first `listed` anew; grains that are not named
    /// are dropped.
    fn list(&mut self, order: &[u32], listed: usize) {
        // Taken before the grains are reordered: they find theirs again by the set-up's order.
        let wall_histories = self.contacts.wall_histories(&self.grains);
        self.grains.reorder(order);
        if let Some(field) = &mut self.field {
            field.reorder(order);
        }
        if let Some(gas) = self.gas.as_mut().and_then(GasStage::flowing_mut) {
            gas.reorder(order);
        }
        let skin_m = self.progress.skin_m;
        self.contacts.list(&self.domain, &self.grains, listed, order, skin_m, &wall_histories);
    }

    /// Computes the contact forces of grains on each other, for springs that advance by `step` [s]. They
    /// overwrite those of the last step; the other forces are added to them.
    fn push_grains(&mut self, step: f64) {
        let step_index = self.progress.step_index;
        let follow = self.charging.as_ref().map(|charging| charging.follow(step_index));
        self.contacts.push_grains(&self.grains, step, follow, &mut self.scratch.loads);
        self.watch.lap(Stage::Contacts);
    }

    /// Adds the contact forces of walls, for springs that advance by `step` [s].
    fn push_off_walls(&mut self, step: f64) {
        let time = self.progress.time_s();
        self.contacts.push_off_walls(&self.grains, time, step, &mut self.scratch.loads);
        self.watch.lap(Stage::Walls);
    }

    /// Exchanges momentum with a gas that flows, where that is due; whether it was.
    fn exchange_with_gas(&mut self) -> Result<bool, DemError> {
        let Progress { step_index, step_s, .. } = self.progress;
        let flowing = self.gas.as_mut().and_then(GasStage::flowing_mut);
        let Some(flowing) = flowing.filter(|flowing| flowing.is_due(step_index)) else { return Ok(false) };
        flowing.exchange(&self.domain, &self.grains, step_index, step_s)?;
        self.limits.set_flow(flowing.limits());
        Ok(true)
    }

    /// Adds the forces of a gas, whose impulse is booked for `step` [s].
    fn add_gas_forces(&mut self, step: f64) {
        let Some(gas) = &mut self.gas else { return };
        gas.add_forces(&self.grains, step, &mut self.scratch.loads.force);
        self.watch.lap(Stage::Gas);
    }

    /// Finishes the velocities with the new forces, for a step of `step` [s].
    fn kick(&mut self, step: f64) {
        let neighbours = &self.contacts.neighbours;
        let (gravity, loads) = (self.time.gravity_m_s2, &mut self.scratch.loads);
        kick(&mut self.grains, gravity, |k| neighbours.pushes(k), step, loads);
        self.watch.lap(Stage::Integrate);
    }

    /// Fits the scratch to the number of grains.
    fn resize_scratch(&mut self) {
        let count = self.grains.len();
        let turns = !self.grains.torque.is_empty();
        self.scratch.loads.resize(count, turns);
        self.scratch.motion.resize(chunk_count(count), ChunkMotion::default());
    }
}
