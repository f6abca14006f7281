//! The electric force on the grains, held constant between evaluations.
//!
//! `coupling_interval = "auto"`: E is evaluated anew
//!
//! * as soon as the members have moved against each other by tolerance × smallest member radius, in RMS: two
//!   touching grains that approach each other by that much change their field by about that fraction, and the
//!   tolerance is an RMS error. Falling side by side changes nothing between them and does not count;
//! * as soon as any grain may have moved by a tenth of that radius, so that no lone fast grain and no wall is
//!   forgotten;
//! * at the latest after 0.2/ω_p.
//!
//! Travels are sums over steps of Δt × speed. All depends on the grains only, never on a clock.

use crate::error::DemError;
use crate::grains::Grains;
use crate::setup::FieldStageSetup;
use crate::state::FieldState;
use amberfield_core::constants::VACUUM_PERMITTIVITY;
use amberfield_core::{CouplingInterval, Domain, FieldSettings, Particles, Vector3};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_laws::{force_limit, time_step_limits};
use serde::{Deserialize, Serialize};

/// Largest travel of any grain between evaluations, over the smallest radius.
const MOST_TRAVEL: f64 = 0.1;

/// What the force limit did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Limited {
    /// Grains limited at the last evaluation.
    pub grains: u64,
    /// Steps in which any grain was limited.
    pub steps: u64,
    /// Steps × grains limited in them.
    pub grain_steps: u64,
    /// Largest electric force before limiting, over the whole run [N].
    pub largest_force_n: f64,
}

/// The field and the forces it holds.
#[derive(Debug)]
pub(crate) struct FieldStage {
    pub(crate) field: ElectricField,
    settings: FieldSettings,
    /// By the set-up's order.
    pub(crate) member: Vec<bool>,
    smallest_radius: f64,
    /// Sorted indices of the members at the last evaluation, their positions and charges.
    index: Vec<u32>,
    position: Vec<Vector3<f64>>,
    charge: Vec<f64>,
    values: FieldValues,
    /// Electric force on each grain [N], sorted order.
    pub(crate) force: Vec<Vector3<f64>>,
    /// Travel of the fastest grain, and RMS travel against each other, since the last evaluation [m].
    travel: f64,
    relative_travel: f64,
    steps_since: u64,
    /// Most steps between evaluations under the plasma limit.
    plasma_steps: u64,
    /// Longest stable step at the present interval [s].
    pub(crate) plasma_limit: f64,
    pub(crate) limited: Limited,
}

impl FieldStage {
    /// Builds the stage; the field chooses its parameters unless the set-up or a state knows them.
    pub(crate) fn new(
        domain: &Domain,
        setup: FieldStageSetup,
        particles: &Particles,
        state: Option<&FieldState>,
    ) -> Result<Self, DemError> {
        let FieldStageSetup { settings, member, choice } = setup;
        let members = || (0..particles.len()).filter(|&i| member[i]);
        let smallest_radius = members().map(|i| particles.radius[i]).fold(f64::INFINITY, f64::min);
        let field = match state.map(|s| &s.choice).or(choice.as_ref()) {
            Some(choice) => ElectricField::with_choice(domain, &settings, choice)?,
            None => {
                let position: Vec<_> = members().map(|i| domain.wrap(particles.position[i])).collect();
                let charge: Vec<_> = members().map(|i| particles.charge[i]).collect();
                ElectricField::new(domain, &settings, &position, &charge)?
            }
        };
        let mut stage = Self {
            field,
            settings,
            member,
            smallest_radius,
            index: Vec::new(),
            position: Vec::new(),
            charge: Vec::new(),
            values: FieldValues::default(),
            force: vec![Vector3::zeros(); particles.len()],
            travel: 0.0,
            relative_travel: 0.0,
            steps_since: 0,
            plasma_steps: 1,
            plasma_limit: f64::INFINITY,
            limited: Limited::default(),
        };
        if let Some(state) = state {
            stage.force.clone_from(&state.force);
            stage.travel = state.travel;
            stage.relative_travel = state.relative_travel;
            stage.steps_since = state.steps_since;
            stage.plasma_steps = state.plasma_steps;
            stage.plasma_limit = state.plasma_limit;
            stage.limited = state.limited;
        }
        Ok(stage)
    }

    pub(crate) fn state(&self) -> FieldState {
        FieldState {
            choice: self.field.choice().clone(),
            force: self.force.clone(),
            travel: self.travel,
            relative_travel: self.relative_travel,
            steps_since: self.steps_since,
            plasma_steps: self.plasma_steps,
            plasma_limit: self.plasma_limit,
            limited: self.limited,
        }
    }

    /// Permittivity of the medium [F/m].
    pub(crate) fn permittivity(&self) -> f64 {
        VACUUM_PERMITTIVITY * self.settings.relative_permittivity
    }

    /// Books a step of length `step` [s] at largest speed `speed` [m/s]; whether E is due.
    pub(crate) fn is_due(&mut self, step: f64, speed: f64, grains: &Grains) -> bool {
        self.steps_since += 1;
        match self.settings.coupling_interval {
            CouplingInterval::Steps(steps) => self.steps_since >= u64::from(steps.max(1)),
            CouplingInterval::Auto => {
                self.travel += step * speed;
                self.relative_travel += step * self.relative_speed(grains);
                self.relative_travel > self.settings.tolerance * self.smallest_radius
                    || self.travel > MOST_TRAVEL * self.smallest_radius
                    || self.steps_since >= self.plasma_steps
            }
        }
    }

    /// RMS speed of the members about their mean velocity [m/s].
    fn relative_speed(&self, grains: &Grains) -> f64 {
        let (mut sum, mut squares, mut count) = (Vector3::zeros(), 0.0, 0.0);
        for (velocity, &original) in grains.velocity.iter().zip(&grains.original) {
            if self.member[original as usize] {
                sum += velocity;
                squares += velocity.norm_squared();
                count += 1.0;
            }
        }
        if count == 0.0 { 0.0 } else { (squares / count - (sum / count).norm_squared()).max(0.0).sqrt() }
    }

    fn collect(&mut self, domain: &Domain, grains: &Grains, particles: &Particles) {
        self.index.clear();
        self.position.clear();
        self.charge.clear();
        for (i, &original) in grains.original.iter().enumerate() {
            if self.member[original as usize] {
                self.index.push(i as u32);
                self.position.push(domain.wrap(grains.position(i)));
                self.charge.push(particles.charge[original as usize]);
            }
        }
    }

    /// Evaluates E and sets the forces that are held until the next evaluation.
    pub(crate) fn evaluate(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
        skin: f64,
        step: f64,
    ) -> Result<(), DemError> {
        self.collect(domain, grains, particles);
        self.field.evaluate(&self.position, &self.charge, Wanted::default(), &mut self.values)?;
        self.force.clear();
        self.force.resize(grains.len(), Vector3::zeros());
        self.limited.grains = 0;
        let factor = self.settings.force_limit.map(|limit| limit.factor);
        for ((&i, e), q) in self.index.iter().zip(&self.values.e).zip(&self.charge) {
            let mut force = e * *q;
            if let Some(factor) = factor {
                self.limited.largest_force_n = self.limited.largest_force_n.max(force.norm());
                let mass = 1.0 / grains.inverse_mass[i as usize];
                let (limited, cut) =
                    force_limit::limited(force, force_limit::largest(factor, mass, skin, step));
                force = limited;
                self.limited.grains += u64::from(cut);
            }
            self.force[i as usize] = force;
        }
        self.watch_plasma(grains, step);
        self.travel = 0.0;
        self.relative_travel = 0.0;
        self.steps_since = 0;
        Ok(())
    }

    /// ω_p of the members in their bounding box.
    fn watch_plasma(&mut self, grains: &Grains, step: f64) {
        let mut min = Vector3::repeat(f64::INFINITY);
        let mut max = Vector3::repeat(f64::NEG_INFINITY);
        let mut sum = 0.0;
        for ((&i, x), q) in self.index.iter().zip(&self.position).zip(&self.charge) {
            let radius = Vector3::repeat(grains.centre[i as usize][3]);
            min = min.inf(&(x - radius));
            max = max.sup(&(x + radius));
            sum += q * q * grains.inverse_mass[i as usize];
        }
        if self.index.is_empty() {
            return;
        }
        let volume = (max - min).product();
        let frequency = time_step_limits::plasma_frequency(sum, volume, self.permittivity());
        let accurate = (time_step_limits::PLASMA_ACCURATE / (frequency * step)).floor();
        self.plasma_steps = (accurate as u64).max(1);
        let interval = match self.settings.coupling_interval {
            CouplingInterval::Steps(steps) => u64::from(steps.max(1)),
            CouplingInterval::Auto => 1,
        };
        self.plasma_limit = time_step_limits::PLASMA_STABLE / (frequency * interval as f64);
    }

    /// Books the limiter's work of one step.
    pub(crate) fn book_step(&mut self) {
        self.limited.steps += u64::from(self.limited.grains > 0);
        self.limited.grain_steps += self.limited.grains;
    }

    /// ½ Σ q (V + V_external) [J] at the present positions. The potential of the field contains the external
    /// field's once, whose energy has no factor ½. Changes nothing that the motion sees.
    pub(crate) fn energy(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
    ) -> Result<f64, DemError> {
        self.collect(domain, grains, particles);
        let wanted = Wanted { potential: true, ..Wanted::default() };
        self.field.evaluate(&self.position, &self.charge, wanted, &mut self.values)?;
        let (external, centre) = (self.settings.external_field_v_m, domain.centre());
        let terms = self.position.iter().zip(&self.charge).zip(&self.values.potential);
        Ok(0.5 * terms.map(|((x, q), v)| q * (v - external.dot(&(x - centre)))).sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{Boundary, Grain, GroupId, MaterialId, Method};

    const RADIUS: f64 = 1e-3;
    const STEP: f64 = 1e-5;

    /// Four slowly oscillating charges (no plasma limit in sight) with the given velocities.
    fn stage(velocities: [[f64; 3]; 4]) -> (FieldStage, Grains) {
        let domain = Domain::new(Vector3::repeat(-1.0), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3])
            .expect("a good scene");
        let particles: Particles = velocities
            .into_iter()
            .enumerate()
            .map(|(k, velocity)| Grain {
                id: k as u64,
                position: Vector3::new(k as f64 * 4.0 * RADIUS, 0.0, 0.0),
                velocity: velocity.into(),
                angular_velocity: Vector3::zeros(),
                radius: RADIUS,
                density: 2500.0,
                charge: 1e-15,
                material: MaterialId(0),
                group: GroupId(0),
            })
            .collect();
        let settings = FieldSettings { method: Method::Direct, tolerance: 1e-2, ..FieldSettings::default() };
        let setup = FieldStageSetup { settings, member: vec![true; 4], choice: None };
        let mut stage = FieldStage::new(&domain, setup, &particles, None).expect("a good scene");
        let grains = Grains::new(&particles, vec![0; 4], false);
        stage.evaluate(&domain, &grains, &particles, 1e-4, STEP).expect("a good scene");
        (stage, grains)
    }

    /// Steps until E is due.
    fn interval(velocities: [[f64; 3]; 4]) -> u64 {
        let (mut stage, grains) = stage(velocities);
        let speed = velocities.iter().map(|v| Vector3::from(*v).norm()).fold(0.0, f64::max);
        (1..).find(|_| stage.is_due(STEP, speed, &grains)).expect("a good scene")
    }

    #[test]
    fn grains_that_approach_are_due_after_the_tolerance_and_side_by_side_after_a_tenth() {
        // ±0.1 m/s along x is an RMS of 0.1 m/s: 1e-2 radii take 10 steps, or 11 by round-off.
        let approaching = interval([[0.1, 0.0, 0.0], [-0.1, 0.0, 0.0], [0.1, 0.0, 0.0], [-0.1, 0.0, 0.0]]);
        assert!((10..=11).contains(&approaching), "{approaching}");
        // Side by side: a tenth of the radius.
        let together = interval([[0.0, 0.0, -0.1]; 4]);
        assert!((100..=101).contains(&together), "{together}");
        // Side by side and approaching: what they share does not count.
        let both = interval([[0.1, 0.0, -0.1], [-0.1, 0.0, -0.1], [0.1, 0.0, -0.1], [-0.1, 0.0, -0.1]]);
        assert!((10..=11).contains(&both), "{both}");
    }

    #[test]
    fn grains_at_rest_are_due_under_the_plasma_limit_only() {
        let (mut stage, grains) = stage([[0.0; 3]; 4]);
        stage.plasma_steps = 1000;
        assert_eq!((1..).find(|_| stage.is_due(STEP, 0.0, &grains)), Some(1000));
    }
}
