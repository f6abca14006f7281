//! Whether a run is still sound: looked at with every row of the history and before every checkpoint.

use crate::failure::Failure;
use amberfield_core::{Axis, Vector3};
use amberfield_dem::{ElectricEnergy, Energies, Simulation};
use amberfield_scene::Scene;

/// Largest overlap over the smaller radius.
const DEEPEST: f64 = 0.5;
/// Kinetic energy over all that was ever there to be released; the field of electrodes is counted by half.
const ENERGY: f64 = 10.0;
/// Kinetic energy over the sizes of all energies that may be round-off.
const ROUND_OFF: f64 = 1e-9;
/// Change of the charge of grains and walls over the sizes of all charges.
const CHARGE: f64 = 1e-9;

/// What a run had to start with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Health {
    grains: usize,
    /// Kinetic energy at the start [J].
    kinetic: f64,
    /// Highest potential energy so far: gravity, contacts, field [J].
    highest: f64,
    /// Charge of grains and walls [C].
    charge: f64,
    allowed: Allowed,
}

/// What is no sign of trouble in a scene.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Allowed {
    /// Deep overlaps.
    overlap: bool,
    /// Energy that comes from outside: by contacts that charge, forces that are limited, a gas, or round and round a period.
    work: bool,
}

impl Allowed {
    pub(crate) fn new(scene: &Scene) -> Self {
        let gravity = scene.time.as_ref().map_or_else(Vector3::zeros, |time| time.gravity_m_s2);
        let field = scene.electric_field.as_ref().map(|field| &field.field);
        let external = field.map_or_else(Vector3::zeros, |field| field.external_field_v_m);
        let domain = scene.domain.as_ref();
        let round = Axis::ALL.into_iter().any(|axis| {
            let pull = gravity[axis.index()].abs() + external[axis.index()].abs();
            pull > 0.0 && domain.is_some_and(|domain| domain.is_periodic(axis))
        });
        let limited = field.is_some_and(|field| field.force_limit.is_some());
        let charging =
            scene.electric_field.as_ref().is_some_and(|field| field.enable_collision_charge_transfer);
        Self {
            overlap: scene.time.as_ref().is_some_and(|time| time.allow_overlap),
            work: round || limited || scene.gas.is_some() || charging,
        }
    }
}

impl Health {
    /// Of a run that begins or goes on now.
    pub(crate) fn new(simulation: &Simulation, energies: &Energies, allowed: Allowed) -> Self {
        Self {
            grains: simulation.len(),
            kinetic: energies.kinetic,
            highest: potential(energies),
            charge: charge(simulation).0,
            allowed,
        }
    }

    /// Looks at a run; says what is wrong, at which grain. The energies may be forecasts: what looks wrong by them is looked at again.
    pub(crate) fn check(&mut self, simulation: &mut Simulation, energies: &Energies) -> Result<(), Failure> {
        if simulation.len() != self.grains {
            // Grains that left took their energy and charge along.
            *self = Self::new(simulation, energies, self.allowed);
        }
        let time_s = simulation.time_s();
        if let Some(id) = simulation.not_finite() {
            return Err(unsound(
                format!("grain {id} is nowhere: its position or velocity is no number"),
                time_s,
            ));
        }
        if let Some(deepest) = simulation.deepest().filter(|d| !self.allowed.overlap && d.share > DEEPEST) {
            let other = deepest.other.map_or_else(|| "a wall".to_owned(), |id| format!("grain {id}"));
            return Err(unsound(
                format!(
                    "grain {} {} overlaps {other} by {:.3e} m, {:.2} of its radius: more than {DEEPEST}",
                    deepest.id,
                    whereabouts(simulation, deepest.id),
                    deepest.overlap_m,
                    deepest.share
                ),
                time_s,
            ));
        }
        self.highest = self.highest.max(potential(energies));
        if self.is_too_fast(energies) {
            let exact = simulation
                .energies(ElectricEnergy::Evaluated)
                .map_err(|error| Failure::while_running(&error))?;
            if self.is_too_fast(&exact) {
                let (id, _) = simulation.fastest().unwrap_or_default();
                return Err(unsound(
                    format!(
                        "the grains have {:.3e} J of kinetic energy, more than {ENERGY} times the {:.3e} J that were there to be released; the fastest is grain {id} {}",
                        exact.kinetic,
                        self.released(&exact),
                        whereabouts(simulation, id)
                    ),
                    time_s,
                ));
            }
        }
        let (now, sizes) = charge(simulation);
        if (now - self.charge).abs() > CHARGE * sizes {
            return Err(unsound(
                format!("the charge of grains and walls has gone from {:e} C to {now:e} C", self.charge),
                time_s,
            ));
        }
        Ok(())
    }

    /// What the grains had, and could have got by now [J].
    fn released(&self, energies: &Energies) -> f64 {
        (self.kinetic + self.highest - potential(energies)).max(0.0)
    }

    fn is_too_fast(&self, energies: &Energies) -> bool {
        let sizes = energies.gravity.abs() + energies.contact.abs() + energies.electric.unwrap_or(0.0).abs();
        let most = ENERGY * self.released(energies) + ROUND_OFF * sizes;
        !self.allowed.work && energies.kinetic > most
    }
}

fn unsound(what: String, time_s: f64) -> Failure {
    Failure::outside_tolerance(format!(
        "at t = {time_s:e} s {what}; the motion is no longer sound: make time.step_s smaller, the grains stiffer, or look at what holds this grain"
    ))
}

/// Place and velocity of a grain, in words.
fn whereabouts(simulation: &Simulation, id: u64) -> String {
    let particles = simulation.particles();
    let index = particles.id.iter().position(|known| *known == id);
    index.map_or_else(String::new, |index| {
        let [x, v] = [particles.position[index], particles.velocity[index]];
        format!(
            "(at ({:.4e}, {:.4e}, {:.4e}) m with ({:.3e}, {:.3e}, {:.3e}) m/s)",
            x.x, x.y, x.z, v.x, v.y, v.z
        )
    })
}

fn potential(energies: &Energies) -> f64 {
    energies.gravity + energies.contact + energies.electric.unwrap_or(0.0)
}

/// Charge of grains and walls, and the sizes of all charges [C].
fn charge(simulation: &Simulation) -> (f64, f64) {
    let particles = simulation.particles();
    let (walls, moved) =
        simulation.ledger().map_or((0.0, 0.0), |ledger| (ledger.walls.iter().sum(), ledger.moved));
    let sizes: f64 = particles.charge.iter().map(|charge| charge.abs()).sum();
    (particles.net_charge() + walls, sizes + moved)
}
