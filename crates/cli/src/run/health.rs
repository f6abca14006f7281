//! Checks that the physics of a run is sound, made with each row of the history and before each checkpoint.

use crate::failure::Failure;
use amberfield_core::{Axis, Vector3};
use amberfield_dem::{ElectricEnergy, Energies, Simulation};
use amberfield_scene::Scene;
use serde::{Deserialize, Serialize};

/// Largest allowed ratio of the kinetic energy to the most energy that has been released at a time. It is
/// wide because the energy in the field of electrodes is counted by half.
const ENERGY: f64 = 10.0;
/// Largest allowed change of the charge of grains and walls, over the sizes of all charges.
const CHARGE: f64 = 1e-9;

/// Quantities of a run to which later ones are compared.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Health {
    /// Number of grains that had left at the last check.
    left: usize,
    /// Energy of the field at the last check [J].
    electric: f64,
    /// Kinetic energy at the start [J].
    kinetic: f64,
    /// Highest potential energy so far: gravity, contacts, field [J].
    highest: f64,
    /// Most energy so far that the grains had from the start or from a fall of the potential energy [J].
    released: f64,
    /// Charge of grains and walls at the start [C].
    charge: f64,
    /// Largest sum of the sizes of all charges so far [C]: charges that cancel may all leave.
    sizes: f64,
    allowed: Allowed,
}

/// Facts that a scene permits, so that they are no sign of an unsound run.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Allowed {
    /// Switch for energy from outside: charging contacts, limited forces, a gas, walls that move,
    /// potentials that change, or a force along a periodic axis, which does work in each period.
    work: bool,
}

impl Allowed {
    /// Facts that a scene and its simulation permit.
    pub(crate) fn new(scene: &Scene, simulation: &Simulation) -> Self {
        let gravity = scene.time.as_ref().map_or_else(Vector3::zeros, |time| time.gravity_m_s2);
        let field = scene.electric_field.as_ref().map(|field| &field.field);
        let external = field.map_or_else(Vector3::zeros, |field| field.external_field_v_m);
        let domain = scene.domain.as_ref();
        let changing = simulation.field_changes()
            || field.is_some_and(|field| field.external_course.is_some())
            || domain.is_some_and(|domain| !domain.courses().is_empty());
        let round = Axis::ALL.into_iter().any(|axis| {
            let pull = gravity[axis.index()].abs() + external[axis.index()].abs();
            pull > 0.0 && domain.is_some_and(|domain| domain.is_periodic(axis))
        });
        let limited = field.is_some_and(|field| field.force_limit.is_some());
        let charging =
            scene.electric_field.as_ref().is_some_and(|field| field.enable_collision_charge_transfer);
        let moving = scene.walls.iter().any(|wall| !wall.motion.is_empty());
        Self { work: round || limited || scene.gas.is_some() || charging || moving || changing }
    }
}

impl Health {
    /// Quantities of a run that begins now.
    pub(crate) fn new(simulation: &Simulation, energies: &Energies, allowed: Allowed) -> Self {
        let ChargeBalance { net, sizes } = charge(simulation);
        Self {
            left: simulation.left().grains,
            electric: energies.electric.unwrap_or(0.0),
            kinetic: energies.kinetic,
            highest: potential(simulation, energies),
            released: energies.kinetic,
            charge: net,
            sizes,
            allowed,
        }
    }

    /// Checks a run; the error names the problem and the grain.
    ///
    /// The energies may use a forecast of the field. What looks wrong by them is checked again with the field
    /// itself.
    pub(crate) fn check(&mut self, simulation: &mut Simulation, energies: &Energies) -> Result<(), Failure> {
        let electric = energies.electric.unwrap_or(0.0);
        if self.left != simulation.left().grains {
            // A charge that others held back took its negative energy along: nothing that could be released.
            self.highest += (electric - self.electric).max(0.0);
        }
        (self.left, self.electric) = (simulation.left().grains, electric);
        let time_s = simulation.time_s();
        if let Some(id) = simulation.not_finite() {
            return Err(unsound(format!("the position or velocity of grain {id} is not a number"), time_s));
        }
        if self.is_too_fast(simulation, energies) {
            let exact = simulation
                .energies(ElectricEnergy::Evaluated)
                .map_err(|error| Failure::while_running(&error))?;
            if self.is_too_fast(simulation, &exact) {
                let (id, _) = simulation.fastest().unwrap_or_default();
                return Err(unsound(
                    format!(
                        "the grains have {:.3e} J of kinetic energy, more than {ENERGY} times the {:.3e} J \
                         that were ever released, and more than the error of {:.1e} J of the energies; the \
                         fastest is grain {id} {}",
                        exact.kinetic,
                        self.released,
                        exact.error,
                        whereabouts(simulation, id)
                    ),
                    time_s,
                ));
            }
        }
        let now = charge(simulation);
        self.sizes = self.sizes.max(now.sizes);
        if (now.net - self.charge).abs() > CHARGE * self.sizes {
            return Err(unsound(
                format!(
                    "the charge of grains and walls has changed from {:e} C to {:e} C",
                    self.charge, now.net
                ),
                time_s,
            ));
        }
        Ok(())
    }

    /// Takes energies; tells whether the kinetic energy is larger than what was ever released, and than the
    /// error of the energies. Where grains turn, little is released at the moment, and what is left of the
    /// kinetic energy is the error of all that was turned over before.
    fn is_too_fast(&mut self, simulation: &Simulation, energies: &Energies) -> bool {
        let potential = potential(simulation, energies);
        self.highest = self.highest.max(potential);
        let kinetic = self.kinetic + simulation.brought().kinetic;
        self.released = self.released.max(kinetic + self.highest - potential);
        !self.allowed.work && energies.kinetic > ENERGY * self.released + energies.error
    }
}

/// Failure of a run that is not sound at a time [s].
fn unsound(what: String, time_s: f64) -> Failure {
    Failure::outside_tolerance(format!(
        "at t = {time_s:e} s {what}; the motion is no longer sound: make time.step_s smaller, the grains \
         stiffer, or check what holds this grain"
    ))
}

/// Text with the position and the velocity of a grain.
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

/// Potential energy [J], with the gravity of the grains that have left; zero for each grain where a feed
/// brought it.
fn potential(simulation: &Simulation, energies: &Energies) -> f64 {
    let gravity = energies.gravity + simulation.left().gravity - simulation.brought().gravity;
    let electric = energies.electric.map_or(0.0, |electric| electric - simulation.brought().electric);
    gravity + energies.contact + electric
}

/// Charges of a run.
struct ChargeBalance {
    /// Charge of grains and walls [C].
    net: f64,
    /// Sum of the sizes of all charges, also of those that were moved [C].
    sizes: f64,
}

/// Charges of grains and walls, and of the grains that have left, less what feeds brought.
fn charge(simulation: &Simulation) -> ChargeBalance {
    let particles = simulation.particles();
    let (walls, moved) =
        simulation.ledger().map_or((0.0, 0.0), |ledger| (ledger.walls.iter().sum(), ledger.moved));
    let sizes: f64 = particles.charge.iter().map(|charge| charge.abs()).sum();
    let (left, fed) = (simulation.left().charge, simulation.brought().charge);
    ChargeBalance {
        net: particles.net_charge() + walls + left - fed,
        sizes: sizes + moved + left.abs() + fed.abs(),
    }
}
