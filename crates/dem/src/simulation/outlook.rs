//! Facts about a run before its first step: what `explain` tells.

use super::guards::{Guard, Limits, StepRestitution};
use super::plan::{Planned, plan};
use super::start::{bounds, contact_walls, progress_at_start};
use super::{Simulation, checks};
use crate::contacts::cells::{LinkedCells, levels_of, shifts};
use crate::contacts::material_pairs::{Features, PairTable};
use crate::contacts::walls::Sticking;
use crate::error::DemError;
use crate::feeding::{self, Feeding};
use crate::setup::Setup;
use amberfield_core::{Material, Plan, Step};
use amberfield_laws::{damped_step, restitution};

/// Fewest steps in a contact for which a restitution is stated; a guard refuses fewer.
const FEWEST_STEPS: f64 = 4.0;

/// Facts about a run.
#[derive(Clone, Debug)]
pub struct Outlook {
    /// Number of grains.
    pub grains: usize,
    /// Stages that run and stages that are left out.
    pub plan: Plan,
    /// Time step [s].
    pub step_s: f64,
    /// Neighbour-list skin [m].
    pub skin_m: f64,
    /// Limits on the time step.
    pub guards: Vec<Guard>,
    /// Largest speed of a grain, here or yet to come [m/s].
    pub fastest_m_s: f64,
    limits: Limits,
}

impl Outlook {
    /// Facts about a run of a set-up that is not started: it takes little more memory than the set-up, and
    /// overlaps are not looked for. `None` with a field or a gas, whose step depends on where grains are.
    ///
    /// # Errors
    /// Values that are impossible, and a step beyond a stability guard.
    pub fn of(setup: &Setup) -> Result<Option<Self>, DemError> {
        if setup.field.is_some() || setup.gas.is_some() {
            return Ok(None);
        }
        let mut merged = (!setup.feeds.is_empty()).then(|| setup.clone());
        merged.iter_mut().for_each(feeding::merge);
        let setup = merged.as_ref().unwrap_or(setup);
        checks::check(setup)?;
        let skin_m = checks::skin(setup);
        checks::check_periods(setup, skin_m)?;
        let Setup { domain, materials, particles, walls, time, .. } = setup;
        let table = PairTable::new(materials, &setup.pairs, setup.cohesion);
        let (level, level_radius) = levels_of(particles.radius.iter().copied());
        let built = contact_walls(walls, shifts(domain), false, Sticking::default(), domain)?;
        let moving = built.and_then(|walls| walls.fastest(time.end_s));
        let feeding = Feeding::new(setup.feeds.clone(), particles, &level);
        let plan = plan(&Planned {
            features: Features { rolling_model: setup.rolling_model, ..table.features() },
            periodic: bounds(domain).is_periodic(),
            walls: walls.len(),
            moving: moving.is_some(),
            levels: LinkedCells::new(level_radius, skin_m).level_count(),
            fixed: particles.len() - particles.moving().count(),
            feeding: feeding.as_ref(),
            outlets: setup.outlets.len(),
            gas: None,
            transfer: None,
            field_asked: false,
            field: None,
        });
        let mut limits = Limits::new(particles, materials, &table, None);
        limits.set_walls(moving.unwrap_or(0.0));
        let mut progress = progress_at_start(skin_m, particles);
        progress.step_s = match time.step {
            Step::Seconds(step) => step,
            Step::Auto => limits.auto_step(&progress),
        };
        limits.watch(&progress, time.allow_unstable)?;
        Ok(Some(Self {
            grains: particles.len() - setup.feeds.due_s.len(),
            plan,
            step_s: progress.step_s,
            skin_m,
            guards: limits.guards(&progress).collect(),
            fastest_m_s: progress.speed,
            limits,
        }))
    }

    /// Steps in the shortest contact of two equal grains that meet at a speed [m/s], and what restitution
    /// each of the materials, with itself, has in so few.
    #[must_use]
    pub fn restitutions(&self, materials: &[Material], speed: f64) -> (f64, Vec<StepRestitution>) {
        let steps = self.limits.steps_in_contact(self.step_s, speed);
        let at_step = |material: &Material| StepRestitution {
            material: material.name.clone(),
            asked: material.restitution,
            found: damped_step::restitution_in_steps(
                restitution::damping_ratio(material.restitution),
                steps.max(FEWEST_STEPS),
            ),
        };
        (steps, materials.iter().map(at_step).collect())
    }
}

impl Simulation {
    /// Facts about the run as it stands.
    #[must_use]
    pub fn outlook(&self) -> Outlook {
        Outlook {
            grains: self.len(),
            plan: self.plan.clone(),
            step_s: self.step_s(),
            skin_m: self.skin_m(),
            guards: self.guards(),
            fastest_m_s: self.fastest().map_or(0.0, |(_, speed)| speed).max(self.fastest_to_come()),
            limits: self.limits.clone(),
        }
    }

    /// Largest speed with which grains have yet to come [m/s].
    fn fastest_to_come(&self) -> f64 {
        let grains = self.feeding.iter().flat_map(Feeding::still_to_come);
        grains.map(|grain| self.particles.velocity[grain].norm()).fold(0.0, f64::max)
    }
}
