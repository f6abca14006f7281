//! Starting a run, afresh or from a checkpoint.

use super::Simulation;
use crate::charging::Charging;
use crate::contacts::cells::{Cells, levels_of, shifts};
use crate::contacts::material_pairs::{Features, PairTable};
use crate::contacts::neighbours::Neighbours;
use crate::contacts::walls::Walls;
use crate::error::DemError;
use crate::field_stage::{Extras, FieldStage};
use crate::gas_stage::GasStage;
use crate::motion::grains::Grains;
use crate::motion::verlet::{Bounds, kick};
use crate::setup::{FieldStageSetup, Setup};
use crate::simulation::checks;
use crate::simulation::guards::Limits;
use crate::simulation::state::State;
use crate::simulation::timing::Stopwatch;
use amberfield_core::{Axis, Domain, Particles, Step, Vector3};

impl Simulation {
    /// Checks a scene, builds its stages and computes the forces at the start.
    ///
    /// # Errors
    /// Values that are impossible, overlaps, a step beyond a stability guard, a field that cannot be computed.
    pub fn new(setup: Setup) -> Result<Self, DemError> {
        checks::check(&setup)?;
        let skin = checks::skin(&setup);
        checks::check_periods(&setup, skin)?;
        let mut run = Self::assemble(setup, skin, None)?;
        run.rebuild();
        let allow = run.time.allow_overlap;
        checks::check_overlaps(&run.grains, &run.neighbours, &run.particles, allow)?;
        if let (Some(walls), false) = (&run.walls, allow)
            && let Some(error) = walls.too_deep(&run.grains, &run.particles)
        {
            return Err(error);
        }
        run.choose_step()?;
        run.forces(0.0)?;
        run.settle_forces();
        Ok(run)
    }

    /// Goes on from a checkpoint of the same scene, bit for bit.
    ///
    /// # Errors
    /// As [`Self::new`], and a state that does not fit the scene.
    pub fn resume(mut setup: Setup, state: State) -> Result<Self, DemError> {
        checks::check(&setup)?;
        check_state(&setup, &state)?;
        if let Some(charging) = &state.charging {
            setup.particles.charge.clone_from(&charging.charge);
        }
        let mut run = Self::assemble(setup, state.skin_m, Some(&state))?;
        run.grains.reorder(&state.original);
        let count = state.original.len();
        // Lists are built from the centres they were built from before.
        let place = |grains: &mut Grains, centres: &[Vector3<f64>]| {
            for (c, x) in grains.centre.iter_mut().zip(centres) {
                (c[0], c[1], c[2]) = (x.x, x.y, x.z);
            }
        };
        place(&mut run.grains, &state.reference);
        let order: Vec<u32> = (0..count as u32).collect();
        run.neighbours.build(&run.domain, &run.grains, &order);
        if let Some(walls) = &mut run.walls {
            walls.build(&run.domain, &run.grains, run.skin, &state.walls);
        }
        run.neighbours.restore(&run.grains, &state.pairs).map_err(DemError::State)?;
        if let (Some(charging), Some(saved)) = (&mut run.charging, &state.charging) {
            charging.restore(saved, &mut run.neighbours).map_err(DemError::State)?;
        }
        place(&mut run.grains, &state.centre);
        run.grains.velocity = state.velocity;
        run.grains.angular = state.angular;
        run.grains.force = state.force;
        run.grains.torque = state.torque;
        run.step_index = state.step_index;
        run.step_s = state.step_s;
        run.travel = state.travel;
        run.speed = state.speed;
        run.resize_scratch();
        run.update_electric_limits();
        run.set_step_of_gas();
        Ok(run)
    }

    /// The complete state, with that of a gas that flows.
    ///
    /// # Errors
    /// A solver of the flow that is lost.
    pub fn checkpoint(&mut self) -> Result<State, DemError> {
        let gas = self.gas.as_mut().and_then(GasStage::flowing_mut);
        let gas = gas.map(|gas| gas.state()).transpose()?;
        Ok(State { gas, ..self.state() })
    }

    /// The complete state of a scene whose gas does not flow.
    #[must_use]
    pub fn state(&self) -> State {
        State {
            step_index: self.step_index,
            step_s: self.step_s,
            skin_m: self.skin,
            travel: self.travel,
            speed: self.speed,
            original: self.grains.original.clone(),
            centre: (0..self.grains.len()).map(|i| self.grains.position(i)).collect(),
            velocity: self.grains.velocity.clone(),
            angular: self.grains.angular.clone(),
            force: self.grains.force.clone(),
            torque: self.grains.torque.clone(),
            reference: self.neighbours.reference.clone(),
            pairs: self.neighbours.histories(&self.grains),
            walls: self.walls.as_ref().map(|w| w.histories(&self.grains)).unwrap_or_default(),
            field: self.field.as_ref().map(FieldStage::state),
            charging: self.charging.as_ref().map(|c| c.state(&self.particles, &self.neighbours)),
            gas: None,
        }
    }

    fn assemble(setup: Setup, skin: f64, state: Option<&State>) -> Result<Self, DemError> {
        let Setup { domain, materials, particles, walls, time, gas, field } = setup;
        let table = PairTable::new(&materials);
        let transfer = field.as_ref().and_then(|field| field.transfer);
        let features = Features { charging: transfer.is_some(), ..table.features() };
        let (level, level_radius) = levels_of(particles.radius.iter().copied());
        let shifts = shifts(&domain);
        let (wall_count, asked_for) = (walls.len(), field.is_some());
        let walls =
            if walls.is_empty() { None } else { Some(Walls::new(&walls, shifts, features.charging)?) };
        let charging = field.as_ref().zip(transfer).map(|(field, transfer)| {
            let of_field = (field.settings.relative_permittivity, field.settings.tolerance);
            Charging::new(transfer, of_field, &materials, &particles, wall_count)
        });
        let field = match field {
            Some(f) if f.transfer.is_some() || is_charged(&f, &particles) => {
                let saved = state.and_then(|s| s.field.as_ref());
                if state.is_some() && saved.is_none() {
                    return Err(DemError::State("it holds no electric field".to_owned()));
                }
                Some(FieldStage::new(&domain, f, &particles, saved)?)
            }
            _ => None,
        };
        let gas = gas.map(|gas| GasStage::new(gas, time.gravity_m_s2, &particles, state)).transpose()?;
        let neighbours = Neighbours::new(Cells::new(level_radius, skin), shifts, features);
        let periodic = Axis::ALL.into_iter().any(|axis| domain.is_periodic(axis));
        let plan = super::plan::plan(
            features,
            periodic,
            (wall_count, gas.as_ref()),
            neighbours.level_count(),
            asked_for,
            transfer.as_ref(),
            field.as_ref().map(|f| f.source.field.plan()),
        );
        let mut run = Self {
            bounds: bounds(&domain),
            domain,
            time,
            plan,
            limits: Limits::new(&particles, &materials, &table, gas.as_ref().and_then(GasStage::uniform)),
            table,
            features,
            periodic,
            step_s: 0.0,
            skin,
            step_index: 0,
            grains: Grains::new(&particles, level, features.rotation()),
            neighbours,
            walls,
            gas,
            field,
            charging,
            extras: Extras::default(),
            travel: 0.0,
            speed: particles.velocity.iter().map(|v| v.norm()).fold(0.0, f64::max),
            particles,
            new_force: Vec::new(),
            new_torque: Vec::new(),
            motion: Vec::new(),
            keys: Vec::new(),
            order: Vec::new(),
            warned_unstable: false,
            rescued: None,
            watch: Stopwatch::default(),
        };
        run.resize_scratch();
        Ok(run)
    }

    /// Fixes the step and evaluates the field for the first time: its plasma limit needs a step and the
    /// automatic step needs the limit.
    fn choose_step(&mut self) -> Result<(), DemError> {
        self.update_electric_limits();
        self.step_s = match self.time.step {
            Step::Seconds(step) => step,
            Step::Auto => self.limits.auto_step(self.speed),
        };
        if !self.step_s.is_finite() {
            return Err(DemError::Setup(
                "step_s = \"auto\" needs at least one grain; give a number".to_owned(),
            ));
        }
        if self.field.is_some() {
            self.evaluate_field()?;
            self.update_electric_limits();
            let shorter = self.limits.auto_step(self.speed);
            if self.time.step == Step::Auto && shorter < self.step_s {
                self.step_s = shorter;
                self.evaluate_field()?;
            }
        }
        self.set_step_of_gas();
        self.watch_guards()
    }

    /// Tells a gas that flows how long a step is.
    fn set_step_of_gas(&mut self) {
        if let Some(gas) = self.gas.as_mut().and_then(GasStage::flowing_mut) {
            gas.set_step(self.step_s);
            self.limits.set_flow(gas.limits());
        }
    }

    /// Takes the first forces as those of the last step, without moving.
    fn settle_forces(&mut self) {
        let step = 0.0;
        kick(&mut self.grains, &self.neighbours, step, &mut self.new_force, &mut self.new_torque);
    }
}

/// Whether any member of a field is charged.
fn is_charged(field: &FieldStageSetup, particles: &Particles) -> bool {
    field.member.iter().zip(&particles.charge).any(|(member, charge)| *member && *charge != 0.0)
}

/// Infinite along periodic axes.
fn bounds(domain: &Domain) -> Bounds {
    let side = |corner: Vector3<f64>, infinite: f64| {
        std::array::from_fn(|a| if domain.is_periodic(Axis::ALL[a]) { infinite } else { corner[a] })
    };
    Bounds { min: side(domain.min(), f64::NEG_INFINITY), max: side(domain.max(), f64::INFINITY) }
}

fn check_state(setup: &Setup, state: &State) -> Result<(), DemError> {
    let count = state.original.len();
    let total = setup.particles.len();
    let mut seen = vec![false; total];
    for &original in &state.original {
        let slot = seen.get_mut(original as usize);
        if slot.is_none_or(|seen| std::mem::replace(seen, true)) {
            return Err(DemError::State(format!("grain {original} of {total} is unknown or named twice")));
        }
    }
    let transfers = setup.field.as_ref().is_some_and(|field| field.transfer.is_some());
    if state.charging.as_ref().map(|charging| charging.charge.len()) != transfers.then_some(total) {
        return Err(DemError::State("its charging does not match the scene's".to_owned()));
    }
    let lengths = [state.centre.len(), state.velocity.len(), state.angular.len(), state.force.len()];
    if lengths.iter().any(|&n| n != count) || state.reference.len() != count {
        return Err(DemError::State("its arrays differ in length".to_owned()));
    }
    let rotation = PairTable::new(&setup.materials).features().rotation();
    if state.torque.len() != if rotation { count } else { 0 } {
        return Err(DemError::State("its torques do not match the materials' friction".to_owned()));
    }
    let flows = setup.gas.as_ref().is_some_and(|gas| gas.gas.flow.is_some());
    if state.gas.is_some() != flows || state.gas.as_ref().is_some_and(|gas| !gas.fits(count)) {
        return Err(DemError::State("its gas does not match the scene's".to_owned()));
    }
    if state.field.as_ref().is_some_and(|f| !f.fits(count)) {
        return Err(DemError::State("its field forces differ in length".to_owned()));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{
        Boundary, Grain, GroupId, Material, MaterialId, OnExit, Skin, TimeSettings, Wall, WallCharging,
        WallShape,
    };

    /// A short column on a floor, with the given friction and rolling friction.
    fn run(friction: f64, rolling_friction: f64) -> Simulation {
        let grain = |id: u64| Grain {
            id,
            position: Vector3::new(0.0, 0.0, 1e-3 * (1.98 * id as f64 + 0.99)),
            velocity: Vector3::zeros(),
            angular_velocity: Vector3::zeros(),
            radius: 1e-3,
            density: 2500.0,
            charge: 0.0,
            material: MaterialId(0),
            group: GroupId(0),
        };
        let floor = WallShape::Plane { point: Vector3::zeros(), normal: Vector3::z() };
        let setup = Setup {
            domain: Domain::new(Vector3::repeat(-1.0), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3])
                .expect("a good scene"),
            materials: vec![Material {
                name: "glass".into(),
                density_kg_m3: 2500.0,
                young_pa: 1e7,
                young_real_pa: None,
                poisson: 0.25,
                restitution: 0.8,
                friction,
                rolling_friction,
                work_function_ev: None,
            }],
            particles: (0..5).map(grain).collect(),
            walls: vec![Wall {
                name: "floor".into(),
                shape: floor,
                material: MaterialId(0),
                charging: WallCharging::None,
                bounds_field: false,
            }],
            time: TimeSettings {
                step: Step::Seconds(1e-6),
                end_s: 1.0,
                gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
                skin: Skin::Auto,
                allow_unstable: false,
                on_exit: OnExit::Stop,
                allow_overlap: false,
            },
            gas: None,
            field: None,
        };
        let mut run = Simulation::new(setup).expect("a good scene");
        (0..50).for_each(|_| run.step().expect("a good scene"));
        assert!(run.contacts() > 3);
        run
    }

    /// Entries of tangential and rolling history, torques.
    fn memory(run: &Simulation) -> [usize; 3] {
        let lists = &run.neighbours.lists;
        [
            lists.iter().map(|l| l.spring.capacity()).sum(),
            lists.iter().map(|l| l.rolling.capacity()).sum(),
            run.grains.torque.capacity() + run.new_torque.capacity(),
        ]
    }

    #[test]
    fn scene_keeps_only_the_memory_that_it_needs() {
        let smooth = run(0.0, 0.0);
        assert_eq!(memory(&smooth), [0; 3]);
        assert!(smooth.field.is_none());
        let [tangential, rolling, torque] = memory(&run(0.3, 0.0));
        assert!(tangential > 0 && rolling == 0 && torque > 0);
        let [tangential, rolling, torque] = memory(&run(0.3, 0.1));
        assert!(tangential > 0 && rolling > 0 && torque > 0);
    }
}
