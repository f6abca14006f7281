//! Starting a run, afresh or from a checkpoint.

use super::earlier::Carried;
use super::exits::WaysOut;
use super::guards::Limits;
use super::state::{Progress, State};
use super::timing::StageClock;
use super::{Scratch, Simulation, checks, overlaps};
use crate::books::Books;
use crate::charging::Charging;
use crate::contacts::cells::{LinkedCells, levels_of, shifts};
use crate::contacts::material_pairs::{Features, PairTable};
use crate::contacts::neighbours::Neighbours;
use crate::contacts::walls::{ContactWalls, Sticking};
use crate::contacts::{Contacts, Depths};
use crate::error::{DemError, SceneKey};
use crate::feeding::{self, Feeding};
use crate::field_stage::FieldStage;
use crate::gas_stage::GasStage;
use crate::motion::grains::Grains;
use crate::motion::verlet::Bounds;
use crate::outlets::Outlets;
use crate::setup::{FieldStageSetup, Setup};
use amberfield_core::{Axis, Domain, Particles, Step, Vector3, Wall};

/// Length of the step that is no step [s]: forces at the start are computed where grains stand, and neither
/// springs nor velocities advance.
const AT_START: f64 = 0.0;

impl Simulation {
    /// Checks a scene, builds its stages and computes the forces at the start.
    ///
    /// # Errors
    /// Values that are impossible, overlaps, a step beyond a stability guard, a field that cannot be
    /// computed.
    pub fn new(setup: Setup) -> Result<Self, DemError> {
        Self::begin(setup, None)
    }

    /// Starts a run, with what its contacts have from another one.
    pub(super) fn begin(mut setup: Setup, carried: Option<&Carried>) -> Result<Self, DemError> {
        feeding::merge(&mut setup);
        checks::check(&setup)?;
        let skin = checks::skin(&setup);
        checks::check_periods(&setup, skin)?;
        let mut run = Self::assemble(setup, skin, None)?;
        run.leave_out_what_has_yet_to_come();
        run.rebuild(&[]);
        checks::check_centres(&run.grains, &run.contacts, &run.particles)?;
        run.carry(carried);
        run.contacts.push_grains(&run.grains, AT_START, None, &mut run.scratch.loads);
        run.push_off_walls(AT_START);
        run.check_overlaps(carried)?;
        run.choose_step()?;
        run.forces_at_start()?;
        run.carry_exactly(carried);
        Ok(run)
    }

    /// Goes on from a checkpoint of the same scene, bit for bit.
    ///
    /// # Errors
    /// As [`Self::new`], and a state that does not fit the scene.
    pub fn resume(mut setup: Setup, mut state: State) -> Result<Self, DemError> {
        feeding::merge(&mut setup);
        state.follow_end(&setup);
        checks::check(&setup)?;
        checks::check_state(&setup, &state)?;
        if let Some(charging) = &state.charging {
            setup.particles.charge.clone_from(&charging.charge);
        }
        let skin = state.progress.skin_m;
        let mut run = Self::assemble(setup, skin, Some(&state))?;
        run.grains.take_order(&state.grains.original);
        // Lists are built from the centres from which they were built before.
        run.grains.place(&state.contacts.reference);
        run.contacts.restore(&run.domain, &run.grains, skin, &state.contacts).map_err(DemError::State)?;
        if let (Some(feeding), Some(saved)) = (&mut run.feeding, &state.feeding) {
            feeding.restore(saved).map_err(DemError::State)?;
        }
        if let (Some(books), Some(saved)) = (&mut run.books, &state.books) {
            books.restore(saved).map_err(DemError::State)?;
        }
        if let (Some(charging), Some(saved)) = (&mut run.charging, &state.charging) {
            charging.restore(&run.domain, saved, &mut run.contacts.neighbours).map_err(DemError::State)?;
        }
        run.grains.restore(state.grains);
        run.progress = state.progress;
        if let Some(field) = &mut run.field {
            field.set_time(run.progress.time_s(), run.progress.step_s);
        }
        run.contacts.move_walls(run.progress.time_s(), AT_START);
        run.carry_charge_of_walls();
        run.allowed = overlaps::allowed(run.depths(), run.time.allow_overlap);
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
            progress: self.progress,
            grains: self.grains.state(),
            contacts: self.contacts.state(&self.grains),
            field: self.field.as_ref().map(FieldStage::state),
            charging: self.charging.as_ref().map(|c| c.state(&self.particles, &self.contacts.neighbours)),
            gas: None,
            ways_out: self.ways_out,
            feeding: self.feeding.as_ref().map(|feeding| feeding.state.clone()),
            books: self.books.as_ref().map(|books| books.state.clone()),
        }
    }

    /// Builds the stages that a scene needs; grains are in the set-up's order, nothing is listed yet.
    fn assemble(setup: Setup, skin_m: f64, state: Option<&State>) -> Result<Self, DemError> {
        let ways_out = state.map_or_else(|| WaysOut::new(&setup), |state| state.ways_out);
        let (books, outlets) = (Books::new(&setup), Outlets::new(&setup.outlets));
        let outlet_count = setup.outlets.len();
        let Setup { domain, materials, rolling_model, cohesion, pairs, .. } = setup;
        let Setup { particles, walls, time, gas, field, feeds, .. } = setup;
        let table = PairTable::new(&materials, &pairs, cohesion);
        let stretch = table.longest_stretch(particles.radius.iter().copied().fold(0.0, f64::max));
        let transfer = field.as_ref().and_then(|field| field.transfer);
        let features = Features { charging: transfer.is_some(), rolling_model, ..table.features() };
        let (level, level_radius) = levels_of(particles.radius.iter().copied());
        let feeding = Feeding::new(feeds, &particles, &level);
        let shifts = shifts(&domain);
        let (wall_count, field_asked) = (walls.len(), field.is_some());
        let sticking = Sticking { cohesion, stretch };
        let walls = contact_walls(&walls, shifts, features.charging, sticking, &domain)?;
        let neighbours = Neighbours::new(LinkedCells::new(level_radius, skin_m + stretch), shifts, features);
        let contacts = Contacts { table, features, neighbours, walls };
        let charging = field.as_ref().zip(transfer).map(|(field, transfer)| {
            Charging::new(transfer, &field.settings, &materials, &particles, wall_count)
        });
        let field = field.map(|field| field_stage(&domain, field, &particles, state)).transpose()?.flatten();
        let saved_gas = state.and_then(|state| state.gas.as_ref());
        let gas = gas.map(|gas| GasStage::new(gas, time.gravity_m_s2, &particles, saved_gas)).transpose()?;
        let bounds = bounds(&domain);
        let plan = super::plan::plan(&super::plan::Planned {
            features,
            periodic: bounds.is_periodic(),
            walls: wall_count,
            moving: contacts.walls.as_ref().is_some_and(ContactWalls::move_at_all),
            levels: contacts.neighbours.level_count(),
            fixed: particles.len() - particles.moving().count(),
            feeding: feeding.as_ref(),
            outlets: outlet_count,
            gas: gas.as_ref(),
            transfer: transfer.as_ref(),
            field_asked,
            field: field.as_ref(),
        });
        let uniform_gas = gas.as_ref().and_then(GasStage::uniform);
        let mut run = Self {
            plan,
            progress: progress_at_start(skin_m, &particles),
            grains: Grains::new(&particles, level, features.rotation()),
            limits: Limits::new(&particles, &materials, &contacts.table, uniform_gas),
            domain,
            bounds,
            time,
            particles,
            contacts,
            gas,
            charging,
            field,
            feeding,
            outlets,
            books,
            allowed: Depths { grains: f64::INFINITY, walls: f64::INFINITY },
            scratch: Scratch::default(),
            ways_out,
            exits: Vec::new(),
            rescued: None,
            watch: StageClock::default(),
        };
        run.limit_walls();
        run.carry_charge_of_walls();
        run.resize_scratch();
        Ok(run)
    }

    /// Drops the grains that feeds have yet to bring; they come by their index in the set-up.
    fn leave_out_what_has_yet_to_come(&mut self) {
        if let Some(feeding) = &self.feeding {
            let starters: Vec<u32> = (0..feeding.starters as u32).collect();
            self.grains.reorder(&starters);
            self.resize_scratch();
        }
    }

    /// Tells the limits how fast walls may be.
    fn limit_walls(&mut self) {
        let speed = self.contacts.walls.as_ref().and_then(|walls| walls.fastest(self.time.end_s));
        self.limits.set_walls(speed.unwrap_or(0.0));
    }

    /// Fixes the step and evaluates the field for the first time: its plasma limit needs a step and the
    /// automatic step needs the limit.
    fn choose_step(&mut self) -> Result<(), DemError> {
        self.update_electric_limits();
        self.progress.step_s = match self.time.step {
            Step::Seconds(step) => step,
            Step::Auto => self.auto_step(),
        };
        if !self.progress.step_s.is_finite() {
            let problem = "step_s = \"auto\" needs at least one grain that moves; give a number";
            return Err(SceneKey::of("time", &["step_s"]).refuse(problem.to_owned()));
        }
        if self.field.is_some() {
            self.evaluate_field()?;
            self.update_electric_limits();
            let shorter = self.auto_step();
            if self.time.step == Step::Auto && shorter < self.progress.step_s {
                self.progress.step_s = shorter;
                self.evaluate_field()?;
            }
        }
        if let Some(field) = &mut self.field {
            field.check_step(&self.domain, self.progress.step_s)?;
            field.set_time(self.progress.time_s(), self.progress.step_s);
        }
        self.set_step_of_gas();
        self.watch_guards()
    }

    /// Length of an automatic step [s], within the limits of the grains, of what changes with time, and of
    /// what the charges that feeds bring may ever set.
    fn auto_step(&self) -> f64 {
        let now = self.limits.auto_step(&self.progress);
        let Some(field) = &self.field else { return now };
        let comes = self.feeding.as_ref().map(|_| field.least_plasma_limit(&self.particles));
        now.min(field.longest_step_s(&self.domain)).min(comes.unwrap_or(f64::INFINITY))
    }

    /// Tells a gas that flows how long a step is.
    fn set_step_of_gas(&mut self) {
        if let Some(gas) = self.gas.as_mut().and_then(GasStage::flowing_mut) {
            gas.set_step(self.progress.step_s);
            self.limits.set_flow(gas.limits());
        }
    }

    /// Computes the forces with which the first step begins: the stages of a step that make forces, without
    /// motion, trade or a new field, which was evaluated just before.
    fn forces_at_start(&mut self) -> Result<(), DemError> {
        self.push_grains(AT_START);
        self.push_off_walls(AT_START);
        let exchanged = self.exchange_with_gas()?;
        self.add_gas_forces(AT_START);
        self.follow_contact_areas();
        self.add_electric_forces_at_start();
        self.watch_guards_where(exchanged)?;
        self.kick(AT_START);
        Ok(())
    }
}

/// Builds the walls of a scene, at the begin of their motions; `None` without any.
pub(super) fn contact_walls(
    walls: &[Wall],
    shifts: [[f64; 3]; 32],
    charge: bool,
    sticking: Sticking,
    domain: &Domain,
) -> Result<Option<ContactWalls>, DemError> {
    if walls.is_empty() {
        return Ok(None);
    }
    let mut built = ContactWalls::new(walls, shifts, charge, sticking).map_err(DemError::Setup)?;
    built.set_in_motion(walls, domain);
    Ok(Some(built))
}

/// Builds the field of a scene that asks for one, afresh or from a state; `None` where every charge is zero
/// and nothing makes one.
fn field_stage(
    domain: &Domain,
    setup: FieldStageSetup,
    particles: &Particles,
    state: Option<&State>,
) -> Result<Option<FieldStage>, DemError> {
    if setup.transfer.is_none() && !is_charged(&setup, particles) {
        return Ok(None);
    }
    let saved = state.map(|state| {
        let field = state.field.as_ref();
        field.ok_or_else(|| DemError::State("it holds no electric field".to_owned()))
    });
    Ok(Some(FieldStage::new(domain, setup, particles, saved.transpose()?)?))
}

/// Whether any member of a field is charged.
fn is_charged(field: &FieldStageSetup, particles: &Particles) -> bool {
    field.member.iter().zip(&particles.charge).any(|(member, charge)| *member && *charge != 0.0)
}

/// Progress of a run whose step is not known yet, with a skin of the lists [m].
pub(super) fn progress_at_start(skin_m: f64, particles: &Particles) -> Progress {
    let speed = particles.velocity.iter().map(|v| v.norm()).fold(0.0, f64::max);
    Progress { step_index: 0, step_s: 0.0, skin_m, travel: 0.0, speed, pace: pace(particles) }
}

/// Largest speed over radius [1/s].
fn pace(particles: &Particles) -> f64 {
    let motion = particles.velocity.iter().zip(&particles.radius);
    motion.map(|(velocity, radius)| velocity.norm() / radius).fold(0.0, f64::max)
}

/// The box that grains may not leave: infinite along periodic axes.
pub(super) fn bounds(domain: &Domain) -> Bounds {
    let side = |corner: Vector3<f64>, infinite: f64| {
        std::array::from_fn(|a| if domain.is_periodic(Axis::ALL[a]) { infinite } else { corner[a] })
    };
    Bounds { min: side(domain.min(), f64::NEG_INFINITY), max: side(domain.max(), f64::INFINITY) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{
        Boundary, Grain, GroupId, Material, MaterialId, OnExit, RollingModel, Skin, TimeSettings,
        WallCharging, WallShape,
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
                surface_energy_j_m2: 0.0,
                work_function_ev: None,
            }],
            rolling_model: RollingModel::default(),
            cohesion: Default::default(),
            pairs: Vec::new(),
            particles: (0..5).map(grain).collect(),
            walls: vec![Wall {
                name: "floor".into(),
                shape: floor,
                material: MaterialId(0),
                charging: WallCharging::None,
                bounds_field: false,
                motion: Vec::new(),
            }],
            time: TimeSettings {
                step: Step::Seconds(1e-6),
                end_s: 1.0,
                gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
                skin: Skin::Auto,
                allow_unstable: false,
                on_exit: OnExit::Stop,
                allow_overlap: true,
            },
            gas: None,
            field: None,
            feeds: Default::default(),
            outlets: Vec::new(),
        };
        let mut run = Simulation::new(setup).expect("a good scene");
        (0..50).for_each(|_| run.step().expect("a good scene"));
        assert!(run.contacts() > 3);
        run
    }

    /// Entries of tangential and rolling history, torques.
    fn memory(run: &Simulation) -> [usize; 3] {
        let lists = &run.contacts.neighbours.lists;
        [
            lists.iter().map(|l| l.spring.capacity()).sum(),
            lists.iter().map(|l| l.rolling.capacity()).sum(),
            run.grains.torque.capacity() + run.scratch.loads.torque.capacity(),
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
