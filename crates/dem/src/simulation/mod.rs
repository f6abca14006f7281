//! One run: the stages of a scene and the order in which they act.

mod charge;
pub(crate) mod checks;
pub(crate) mod energy;
pub(crate) mod guards;
mod observe;
mod plan;
mod start;
pub(crate) mod state;
pub(crate) mod timing;

pub use observe::Deepest;

use crate::charging::Charging;
use crate::contacts::material_pairs::{Features, PairTable};
use crate::contacts::neighbours::Neighbours;
use crate::contacts::pairs::pair_forces;
use crate::contacts::walls::Walls;
use crate::error::DemError;
use crate::field_stage::{Extras, FieldStage};
use crate::gas_stage::GasStage;
use crate::motion::grains::Grains;
use crate::motion::verlet::{Bounds, ChunkMotion, drift, kick};
use crate::simulation::guards::{ElectricLimits, Limits, electric_stiffness, electric_stiffness_bound};
use crate::simulation::state::State;
use crate::simulation::timing::{Stage, Stopwatch};
use amberfield_core::{Domain, OnExit, Particles, Plan, TimeSettings, Vector3};
use charge::Trade;

/// Margin of the displacement test against round-off.
const HALF_SKIN: f64 = 0.499_999;

/// A run. After an error of [`Self::step`] the grains are between two steps: do not step on.
#[derive(Debug)]
pub struct Simulation {
    domain: Domain,
    time: TimeSettings,
    /// Grains as set up: ids, sizes, charges; motion is in `grains`.
    particles: Particles,
    plan: Plan,
    table: PairTable,
    features: Features,
    periodic: bool,
    bounds: Bounds,
    limits: Limits,
    step_s: f64,
    skin: f64,
    step_index: u64,
    grains: Grains,
    neighbours: Neighbours,
    walls: Option<Walls>,
    gas: Option<GasStage>,
    field: Option<FieldStage>,
    charging: Option<Charging>,
    extras: Extras,
    /// Bound on any grain's displacement since the lists were built [m].
    travel: f64,
    /// Largest speed of the last drift [m/s].
    speed: f64,
    /// Forces and torques in the making.
    new_force: Vec<Vector3<f64>>,
    new_torque: Vec<Vector3<f64>>,
    motion: Vec<ChunkMotion>,
    /// Scratch of the sort.
    keys: Vec<(u64, u32, u32)>,
    order: Vec<u32>,
    warned_unstable: bool,
    /// State before a step in which another process may be lost.
    rescued: Option<State>,
    watch: Stopwatch,
}

impl Simulation {
    /// Advances by one step.
    ///
    /// # Errors
    /// A grain that leaves or whose position is not finite, a step that a guard no longer allows, a field that
    /// fails.
    pub fn step(&mut self) -> Result<(), DemError> {
        self.watch.start();
        let may_be_lost = self.field.as_ref().is_some_and(|field| field.may_be_lost(self.step_s, self.speed));
        // Only its solver knows the state of a gas that flows.
        let flows = self.gas.as_ref().is_some_and(|gas| gas.flowing().is_some());
        self.rescued = (may_be_lost && !flows).then(|| self.state());
        self.step_index += 1;
        let motion =
            drift(&mut self.grains, self.time.gravity_m_s2, self.step_s, &self.bounds, &mut self.motion);
        self.speed = motion.speed;
        let left = motion.outside && self.handle_exits()?;
        self.watch.lap(Stage::Integrate);
        self.travel += self.step_s * motion.speed;
        if left || self.must_rebuild() {
            self.rebuild();
            self.watch_guards()?;
        }
        self.watch.lap(Stage::Neighbours);
        self.forces(self.step_s)?;
        kick(&mut self.grains, &self.neighbours, self.step_s, &mut self.new_force, &mut self.new_torque);
        self.watch.lap(Stage::Integrate);
        Ok(())
    }

    /// The state before the step that failed, where a field solver was asked in it: nothing is lost with the solver.
    pub fn rescued(&mut self) -> Option<State> {
        self.rescued.take()
    }

    /// Contact, wall, gas and field forces at the present positions, into `new_force` and `new_torque`; pushes
    /// across chunks wait in the outboxes.
    fn forces(&mut self, step: f64) -> Result<(), DemError> {
        let follow = self.charging.as_ref().map(|charging| charging.follow(self.step_index));
        pair_forces(
            &self.grains,
            &mut self.neighbours,
            &self.table,
            step,
            follow,
            &mut self.new_force,
            &mut self.new_torque,
        );
        self.watch.lap(Stage::Contacts);
        if let Some(walls) = &mut self.walls {
            let (force, torque) = (&mut self.new_force, &mut self.new_torque);
            walls.forces(&self.grains, &self.table, self.features, step, force, torque);
            self.watch.lap(Stage::Walls);
        }
        let exchanged = self.gas_forces(step)?;
        self.charge_contacts(step);
        // The forces at the start come with a step of zero: the field was evaluated just before.
        let speed = self.speed;
        let due = step > 0.0 && self.field.as_mut().is_some_and(|field| field.is_due(step, speed));
        let due = due || (step > 0.0 && self.charges_have_changed());
        if due {
            self.evaluate_field()?;
        }
        if let Some(field) = &mut self.field {
            field.add_forces(&self.grains, self.skin, self.step_s, &mut self.new_force);
            if step > 0.0 {
                field.book_step();
            }
            self.watch.lap(Stage::Field);
        }
        // Charges and pairs are looked at when lists are rebuilt; density and speeds are new here.
        if due || exchanged { self.watch_limits() } else { Ok(()) }
    }

    /// Gas forces into `new_force`, after an exchange with a gas that flows where one is due; whether there was one.
    fn gas_forces(&mut self, step: f64) -> Result<bool, DemError> {
        let Some(gas) = &mut self.gas else { return Ok(false) };
        let number = self.step_index;
        let flowing = gas.flowing_mut().filter(|flowing| flowing.is_due(number));
        let exchanged = flowing.is_some();
        if let Some(flowing) = flowing {
            flowing.exchange(&self.domain, &self.grains, (number, self.step_s))?;
            self.limits.set_flow(flowing.limits());
        }
        gas.add_forces(&self.grains, step, &mut self.new_force);
        self.watch.lap(Stage::Gas);
        Ok(exchanged)
    }

    /// Whether a grain may have moved by half the skin since the lists were built. The travel is only a
    /// bound; when it is used up, the displacements themselves decide.
    fn must_rebuild(&mut self) -> bool {
        let limit = HALF_SKIN * self.skin;
        if self.travel <= limit {
            return false;
        }
        let displacement2 = self
            .neighbours
            .reference
            .iter()
            .enumerate()
            .map(|(i, x)| (self.grains.position(i) - x).norm_squared())
            .fold(0.0, f64::max);
        self.travel = displacement2.sqrt();
        self.travel > limit
    }

    /// Wraps, sorts and lists the grains anew; histories move along.
    fn rebuild(&mut self) {
        self.trade(Trade::Pairs);
        if self.periodic {
            for c in &mut self.grains.centre {
                let wrapped = self.domain.wrap(Vector3::new(c[0], c[1], c[2]));
                (c[0], c[1], c[2]) = (wrapped.x, wrapped.y, wrapped.z);
            }
        }
        let wall_histories = self.walls.as_ref().map(|walls| walls.histories(&self.grains));
        self.grains.spatial_order(&mut self.keys, &mut self.order);
        let order = std::mem::take(&mut self.order);
        self.reorder(&order);
        self.order = order;
        self.neighbours.build(&self.domain, &self.grains, &self.order);
        if let Some(walls) = &mut self.walls {
            walls.build(&self.domain, &self.grains, self.skin, &wall_histories.unwrap_or_default());
        }
        self.travel = 0.0;
    }

    /// Takes in a new order of the grains, here and in the stages that keep something by grain.
    fn reorder(&mut self, order: &[u32]) {
        self.grains.reorder(order);
        if let Some(field) = &mut self.field {
            field.reorder(order);
        }
        if let Some(gas) = self.gas.as_mut().and_then(GasStage::flowing_mut) {
            gas.reorder(order);
        }
    }

    /// Handles grains outside; whether any was removed.
    fn handle_exits(&mut self) -> Result<bool, DemError> {
        let outside: Vec<usize> = (0..self.grains.len())
            .filter(|&i| self.bounds.beyond(&self.grains.centre[i]).is_some())
            .collect();
        let id = |i: usize| self.particles.id[self.grains.original[i] as usize];
        let time_s = self.time_s();
        if let Some(&i) = outside.iter().filter(|&&i| !self.is_finite(i)).min_by_key(|&&i| id(i)) {
            return Err(DemError::NotFinite { id: id(i), time_s });
        }
        if self.time.on_exit == OnExit::Stop
            && let Some(&i) = outside.iter().min_by_key(|&&i| id(i))
        {
            let (axis, side) = self.bounds.beyond(&self.grains.centre[i]).expect("listed as outside");
            let face = format!("{}_{}", ["x", "y", "z"][axis], ["min", "max"][side.unwrap_or(0)]);
            return Err(DemError::Left { id: id(i), position_m: self.grains.position(i), face, time_s });
        }
        for &i in &outside {
            tracing::warn!(id = id(i), time_s, "grain left the domain and was removed");
        }
        self.remove(&outside);
        Ok(!outside.is_empty())
    }

    fn is_finite(&self, i: usize) -> bool {
        self.grains.centre[i].iter().all(|x| x.is_finite())
    }

    /// Removes grains (ascending sorted indices). The lists still have the old numbers: the rebuild that must
    /// follow needs the order from them.
    fn remove(&mut self, gone: &[usize]) {
        if gone.is_empty() {
            return;
        }
        self.trade(Trade::Pairs);
        let wall_histories = self.walls.as_ref().map(|walls| walls.histories(&self.grains));
        let mut keep: Vec<u32> = (0..self.grains.len() as u32).collect();
        keep.retain(|&i| gone.binary_search(&(i as usize)).is_err());
        self.reorder(&keep);
        self.resize_scratch();
        self.neighbours.build(&self.domain, &self.grains, &keep);
        if let Some(walls) = &mut self.walls {
            walls.build(&self.domain, &self.grains, self.skin, &wall_histories.unwrap_or_default());
        }
    }

    /// Evaluates the field now.
    fn evaluate_field(&mut self) -> Result<(), DemError> {
        let time_s = self.time_s();
        self.trade(Trade::Pairs);
        self.ask_at_contacts();
        if let Some(field) = &mut self.field {
            if let Some(solver) = field.source.field.far_solver_mut() {
                solver.at_time(time_s);
            }
            field.evaluate(&self.domain, &self.grains, &self.particles, &self.extras, self.step_s)?;
            self.limits.set_plasma(field.plasma_limit);
            if let Some(charging) = &mut self.charging {
                let charge = &self.particles.charge;
                charging.take(field.beside(), &mut self.neighbours, self.walls.as_mut(), charge);
            }
        }
        Ok(())
    }

    fn resize_scratch(&mut self) {
        let count = self.grains.len();
        self.new_force.resize(count, Vector3::zeros());
        self.new_torque.resize(if self.grains.torque.is_empty() { 0 } else { count }, Vector3::zeros());
        self.motion.resize(crate::motion::chunks::chunk_count(count), ChunkMotion::default());
    }

    /// Electric limits of the present pairs; `None` without a field.
    fn electric_limits(&self) -> Option<ElectricLimits> {
        let field = self.field.as_ref()?;
        let (pair, wall_image) = electric_stiffness(
            &self.domain,
            &self.grains,
            &self.particles,
            &field.member,
            field.permittivity(),
            self.neighbours.pairs().map(|pair| (pair.i, pair.j)),
        );
        Some(ElectricLimits { pair, wall_image, plasma: field.plasma_limit })
    }

    /// Checks the guards anew at the present speed. The pairs are looked at only where a bound for any of
    /// them does not do.
    fn watch_guards(&mut self) -> Result<(), DemError> {
        if let Some(field) = &self.field {
            let (grains, particles) = (&self.grains, &self.particles);
            let (pair, wall_image) =
                electric_stiffness_bound(grains, particles, &field.member, field.permittivity());
            self.limits.set_electric(ElectricLimits { pair, wall_image, plasma: field.plasma_limit });
            if self.limits.broken(self.step_s, self.speed, self.time_s()).is_some() {
                self.update_electric_limits();
            }
        }
        self.watch_limits()
    }

    /// Computes the electric guards of the present pairs.
    fn update_electric_limits(&mut self) {
        if let Some(limits) = self.electric_limits() {
            self.limits.set_electric(limits);
        }
    }

    /// Checks the guards as they are at the present speed.
    fn watch_limits(&mut self) -> Result<(), DemError> {
        let Some(broken) = self.limits.broken(self.step_s, self.speed, self.time_s()) else {
            return Ok(());
        };
        if !self.time.allow_unstable {
            return Err(broken);
        }
        if !self.warned_unstable {
            tracing::warn!("{broken}");
            self.warned_unstable = true;
        }
        Ok(())
    }
}
