//! Limits on the time step: computed at the start, watched while running.

use super::state::Progress;
use crate::contacts::material_pairs::PairTable;
use crate::error::DemError;
use crate::gas_stage::{FlowLimits, UniformGas};
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Material, Particles};
use amberfield_laws::{hertz_mindlin, time_step_limits};

/// `step_s = "auto"` is this fraction of the tightest guard.
pub(crate) const AUTO_FRACTION: f64 = 0.2;
/// Fraction of the shortest elastic contact time that still resolves a collision: velocity Verlet is stable
/// up to 2/π of the contact time of a linear spring; a quarter leaves four steps in a collision.
const CONTACT_TIME_FRACTION: f64 = 0.25;

/// Speed over the sticking speed beyond which what adhesion costs, less than a ninth of the energy, needs no
/// resolving.
const STICKING_SPEEDS: f64 = 3.0;

/// Largest way of a grain in a step over its radius: a longer one could lead through a wall unseen.
const WAY_IN_A_STEP: f64 = 0.5;
/// Way of a grain in a step over its radius up to which a bound on it is all that matters.
const SHORT_WAY: f64 = 0.2;

/// Name of the guard on the interval between exchanges with a gas: grains must not be held to one slip for
/// longer than it lasts.
const GAS_INTERVAL: &str = "gas interval";

/// A limit on the time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Guard {
    /// Name: `rayleigh`, `hertz`, `travel`, `wall motion`, `pull-off`, `gas response`, `gas interval`,
    /// `electric pair`,
    /// `wall image` or `plasma`.
    pub name: &'static str,
    /// Largest step [s]; infinite when nothing limits it at present.
    pub limit_s: f64,
    /// Limit over step; below 1 the step is too long.
    pub margin: f64,
}

/// Restitution that impacts of two grains of a material have at the step.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRestitution {
    /// Name of the material.
    pub material: String,
    /// Restitution of the material.
    pub asked: f64,
    /// Restitution at the step, on the mean.
    pub found: f64,
}

/// Limits on the time step, without the step.
#[derive(Clone, Debug)]
pub(crate) struct Limits {
    /// Radius of the smallest grain that moves [m].
    smallest: f64,
    /// Rayleigh time of the tightest grain [s].
    rayleigh: f64,
    /// min over grains of contact time · speed^{1/5} [s·(m/s)^{1/5}] for two equal grains.
    hertz: f64,
    /// Stretch at which contacts break; `None` where none stretches.
    pull_off: Option<PullOff>,
    /// Gas that slows the grains and does not flow.
    gas: Option<UniformGas>,
    /// Limits of a gas that flows.
    flow: Option<FlowLimits>,
    /// Electric limits; `None` without charges.
    electric: Option<ElectricLimits>,
    /// Bound on the speed of walls that move [m/s]; zero where all are at rest.
    walls: f64,
    /// Whether a run has been told that its step breaks a guard.
    warned: bool,
}

/// Limits that the tensile part of JKR's contacts sets.
#[derive(Clone, Copy, Debug)]
struct PullOff {
    /// Shortest stretch at which a contact breaks [m].
    stretch: f64,
    /// Shortest time in which a contact that meets at its sticking speed is stretched as far [s].
    time: f64,
}

impl PullOff {
    /// Limits of contacts of equal grains, and of a grain and a wall, with any material.
    fn of(particles: &Particles, table: &PairTable, materials: usize) -> Option<Self> {
        let mut found: Option<Self> = None;
        for i in 0..particles.len() {
            // A grain that never moves has its stretch with others, and no time of its own.
            let mass = if particles.is_fixed(i) { f64::INFINITY } else { particles.mass(i) };
            let radius = particles.radius[i];
            for other in 0..materials {
                let Some(scale) = table.jkr(particles.material[i].0, other as u16, 0.5 * radius) else {
                    continue;
                };
                let stretch = scale.longest_stretch();
                let time = stretch / (4.0 * scale.cycle_work() / mass).sqrt();
                let known = found.unwrap_or(Self { stretch, time });
                found = Some(Self { stretch: known.stretch.min(stretch), time: known.time.min(time) });
            }
        }
        found
    }

    /// Largest step [s] in which grains of a largest speed [m/s] do not pass over the stretch unseen. Those
    /// that are much faster than the speed below which they stick do not feel it.
    fn limit(self, speed: f64) -> f64 {
        (self.stretch / (2.0 * speed)).max(self.time / STICKING_SPEEDS)
    }
}

/// Electric limits of the time step.
#[derive(Clone, Copy, Debug)]
struct ElectricLimits {
    /// Pair of touching grains [s].
    pair: f64,
    /// Grain that touches a conducting or insulating face of the domain [s]: images of either sign are as
    /// stiff.
    wall_image: f64,
    /// Interval between field evaluations at which the cloud is unstable, over the interval's steps [s].
    plasma: f64,
}

impl Limits {
    pub(crate) fn new(
        particles: &Particles,
        materials: &[Material],
        table: &PairTable,
        gas: Option<UniformGas>,
    ) -> Self {
        let (mut rayleigh, mut hertz) = (f64::INFINITY, f64::INFINITY);
        // A pair of which one never moves has all of the other's mass: it is no tighter than two equal ones.
        for i in particles.moving() {
            let (radius, material) = (particles.radius[i], &materials[particles.material[i].0 as usize]);
            let shear = hertz_mindlin::shear_modulus(material.young_pa, material.poisson);
            let density = particles.density[i];
            rayleigh = rayleigh.min(time_step_limits::rayleigh(radius, density, shear, material.poisson));
            let young = table.stiffest(particles.material[i]);
            let mass = particles.mass(i);
            hertz = hertz.min(hertz_mindlin::contact_time(young, 0.5 * radius, 0.5 * mass, 1.0));
        }
        let smallest = particles.moving().map(|i| particles.radius[i]).fold(f64::INFINITY, f64::min);
        let pull_off = PullOff::of(particles, table, materials.len());
        let (flow, electric, walls, warned) = (None, None, 0.0, false);
        Self { smallest, rayleigh, hertz, pull_off, gas, flow, electric, walls, warned }
    }

    /// Takes the plasma limit of a new evaluation of the field.
    pub(crate) fn set_plasma(&mut self, plasma: f64) {
        if let Some(electric) = &mut self.electric {
            electric.plasma = plasma;
        }
    }

    /// Takes a bound on the speed of walls that move [m/s].
    pub(crate) fn set_walls(&mut self, speed: f64) {
        self.walls = speed;
    }

    /// Bound on the speed of walls over the smallest radius [1/s].
    pub(crate) fn pace_of_walls(&self) -> f64 {
        if self.walls > 0.0 { self.walls / self.smallest } else { 0.0 }
    }

    /// Takes the limits of a gas that flows.
    pub(crate) fn set_flow(&mut self, flow: FlowLimits) {
        self.flow = Some(flow);
    }

    /// Takes the limits of charged grains, with the plasma limit of the last evaluation of the field [s].
    pub(crate) fn set_electric(&mut self, stiffness: Stiffness, plasma: f64) {
        let Stiffness { pair, wall_image } = stiffness;
        self.electric = Some(ElectricLimits { pair, wall_image, plasma });
    }

    /// Fails where a step breaks a guard; where that is allowed, warns of it once.
    pub(crate) fn watch(&mut self, progress: &Progress, allow_unstable: bool) -> Result<(), DemError> {
        let Some(broken) = self.broken(progress) else { return Ok(()) };
        if !allow_unstable {
            return Err(broken);
        }
        if !self.warned {
            tracing::warn!("{broken}");
            self.warned = true;
        }
        Ok(())
    }

    /// Largest speed over radius of grains [1/s], at a largest speed [m/s]; a bound on it where grains move
    /// little in a step [s].
    pub(crate) fn pace(&self, grains: &Grains, step: f64, speed: f64) -> f64 {
        let bound = speed / self.smallest;
        if step * bound <= SHORT_WAY {
            return bound;
        }
        let motion = grains.velocity.iter().zip(&grains.centre);
        motion.map(|(velocity, centre)| velocity.norm() / centre[3]).fold(0.0, f64::max)
    }

    /// Steps of a length [s] in the shortest contact of two equal grains that meet at a speed [m/s].
    pub(crate) fn steps_in_contact(&self, step: f64, speed: f64) -> f64 {
        self.hertz * speed.powf(-0.2) / step
    }

    /// Whether a grain moves too far in a step [s], at a largest speed over radius [1/s].
    pub(crate) fn is_too_fast(&self, step: f64, pace: f64) -> bool {
        step * pace > WAY_IN_A_STEP
    }

    /// All guards for the step and the grains' largest speed (two of them head-on).
    pub(crate) fn guards(&self, progress: &Progress) -> impl Iterator<Item = Guard> + use<> {
        let Progress { step_s: step, speed, pace, .. } = *progress;
        let hertz = CONTACT_TIME_FRACTION * self.hertz * (2.0 * speed).max(speed + self.walls).powf(-0.2);
        let pace_of_walls = self.pace_of_walls();
        let walls = (pace_of_walls > 0.0).then(|| ("wall motion", WAY_IN_A_STEP / pace_of_walls));
        let electric = self
            .electric
            .map(|e| [("electric pair", e.pair), ("wall image", e.wall_image), ("plasma", e.plasma)]);
        let pull_off = self.pull_off.map(|limits| ("pull-off", limits.limit(speed)));
        let gas = self.gas.map(|gas| ("gas response", gas.limit(speed)));
        let flow = self
            .flow
            .map(|f| [("gas response", f.response_s), (GAS_INTERVAL, f.response_s / f.steps as f64)]);
        [("rayleigh", self.rayleigh), ("hertz", hertz), ("travel", WAY_IN_A_STEP / pace)]
            .into_iter()
            .chain(pull_off)
            .chain(walls)
            .chain(gas)
            .chain(flow.into_iter().flatten())
            .chain(electric.into_iter().flatten())
            .map(move |(name, limit_s)| Guard { name, limit_s, margin: limit_s / step })
    }

    /// The step that `auto` stands for [s].
    pub(crate) fn auto_step(&self, progress: &Progress) -> f64 {
        let tightest = self.guards(progress).map(|g| g.limit_s).fold(f64::INFINITY, f64::min);
        AUTO_FRACTION * tightest
    }

    /// The guard that a step breaks, if any.
    pub(crate) fn broken(&self, progress: &Progress) -> Option<DemError> {
        let (step, time_s) = (progress.step_s, progress.time_s());
        let tightest = self.guards(progress).min_by(|a, b| a.limit_s.total_cmp(&b.limit_s))?;
        // `!(a <= b)`: a limit that is not a number is broken too.
        let holds = step <= tightest.limit_s;
        if let (false, GAS_INTERVAL, Some(FlowLimits { steps, response_s })) =
            (holds, tightest.name, self.flow)
        {
            return Some(DemError::GasInterval { interval_s: steps as f64 * step, response_s, time_s });
        }
        (!holds).then_some(DemError::Unstable {
            guard: tightest.name,
            step_s: step,
            limit_s: tightest.limit_s,
            time_s,
        })
    }
}

/// Stiffness limits of charged grains at contact [s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stiffness {
    /// Pair of touching grains [s].
    pub(crate) pair: f64,
    /// Grain that touches a face of the domain which mirrors its charge [s].
    pub(crate) wall_image: f64,
}

impl Stiffness {
    /// Tighter limits of two.
    pub(crate) fn tighter(self, other: Self) -> Self {
        Self { pair: self.pair.min(other.pair), wall_image: self.wall_image.min(other.wall_image) }
    }
}

/// Stiffness limits of a grain of the set-up with its like, at contact.
pub(crate) fn electric_stiffness_of(
    domain: &Domain,
    particles: &Particles,
    grain: usize,
    permittivity: f64,
) -> Stiffness {
    let (charge, radius, mass) = (particles.charge[grain], particles.radius[grain], particles.mass(grain));
    let mirror = domain.faces().iter().flatten().any(|face| face.is_conductor() || face.is_insulating());
    let pair = time_step_limits::pair_stiffness(charge, charge, permittivity, 2.0 * radius);
    let wall = time_step_limits::wall_image_stiffness(charge, permittivity, radius);
    Stiffness {
        pair: time_step_limits::stiffness_limit(0.5 * mass, pair),
        wall_image: if mirror { time_step_limits::stiffness_limit(mass, wall) } else { f64::INFINITY },
    }
}

/// Lower bounds of the stiffness limits: the lightest, smallest and most charged grain in one.
pub(crate) fn electric_stiffness_bound(
    grains: &Grains,
    particles: &Particles,
    member: &[bool],
    permittivity: f64,
) -> Stiffness {
    let (mut charge, mut inverse_mass, mut radius) = (0.0_f64, 0.0_f64, f64::INFINITY);
    for (i, &original) in grains.original.iter().enumerate() {
        if member[original.index()] {
            charge = charge.max(particles.charge[original.index()].abs());
            inverse_mass = inverse_mass.max(grains.inverse_mass[i]);
            radius = radius.min(grains.centre[i][3]);
        }
    }
    let mass = 1.0 / inverse_mass;
    let pair = time_step_limits::pair_stiffness(charge, charge, permittivity, 2.0 * radius);
    let wall = time_step_limits::wall_image_stiffness(charge, permittivity, radius);
    Stiffness {
        pair: time_step_limits::stiffness_limit(0.5 * mass, pair),
        wall_image: time_step_limits::stiffness_limit(mass, wall),
    }
}

/// Stiffness limits of the grains as they are. The pairs are every member with its like and the listed pairs,
/// all at contact.
pub(crate) fn electric_stiffness(
    domain: &Domain,
    grains: &Grains,
    particles: &Particles,
    member: &[bool],
    permittivity: f64,
    pairs: impl Iterator<Item = (usize, usize)>,
) -> Stiffness {
    let mirror = domain.faces().iter().flatten().any(|face| face.is_conductor() || face.is_insulating());
    let charge = |i: usize| {
        let original = grains.original[i].index();
        if member[original] { particles.charge[original] } else { 0.0 }
    };
    let limit = |i: usize, j: usize| {
        let mass = 1.0 / (grains.inverse_mass[i] + grains.inverse_mass[j]);
        let distance = grains.centre[i][3] + grains.centre[j][3];
        let k = time_step_limits::pair_stiffness(charge(i), charge(j), permittivity, distance);
        time_step_limits::stiffness_limit(mass, k)
    };
    let (mut pair, mut wall) = (f64::INFINITY, f64::INFINITY);
    for i in 0..grains.len() {
        pair = pair.min(limit(i, i));
        if mirror {
            let k = time_step_limits::wall_image_stiffness(charge(i), permittivity, grains.centre[i][3]);
            wall = wall.min(time_step_limits::stiffness_limit(1.0 / grains.inverse_mass[i], k));
        }
    }
    for (i, j) in pairs {
        pair = pair.min(limit(i, j));
    }
    Stiffness { pair, wall_image: wall }
}
