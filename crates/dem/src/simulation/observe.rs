//! Facts that a run tells about itself.

use super::Simulation;
use super::energy::{self, ElectricEnergy, Energies};
use super::guards::Guard;
use super::state::State;
use super::timing::STAGE_NAMES;
use crate::contacts::walls::WallLoad;
use crate::error::DemError;
use crate::field_stage::{FieldStage, Intervals, Limited};
use amberfield_core::{Particles, Placement, Plan, Vector3};
use amberfield_field::{ConductorValues, ElectricField};

impl Simulation {
    /// Exchange of grains with a gas that flows; `None` without one.
    #[must_use]
    pub fn gas_exchange(&self) -> Option<&amberfield_gas::Exchange> {
        self.gas.as_ref()?.flowing().map(crate::gas_stage::FlowingGas::known)
    }

    /// Iterations of a field solver of another process, in its last solve for the motion; 0 without one.
    #[must_use]
    pub fn solver_iterations(&self) -> u64 {
        self.field.as_ref().map_or(0, |field| field.solver_iterations)
    }

    /// Simulated time [s].
    #[must_use]
    pub fn time_s(&self) -> f64 {
        self.progress.time_s()
    }

    /// Time step [s].
    #[must_use]
    pub fn step_s(&self) -> f64 {
        self.progress.step_s
    }

    /// Neighbour-list skin [m].
    #[must_use]
    pub fn skin_m(&self) -> f64 {
        self.progress.skin_m
    }

    /// Steps done.
    #[must_use]
    pub fn step_index(&self) -> u64 {
        self.progress.step_index
    }

    /// Number of grains that are still there.
    #[must_use]
    pub fn len(&self) -> usize {
        self.grains.len()
    }

    /// Whether no grain is left.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.grains.len() == 0
    }

    /// The grains that are still there, in the order of the set-up, positions inside the domain.
    #[must_use]
    pub fn particles(&self) -> Particles {
        let mut sorted: Vec<u32> = (0..self.grains.len() as u32).collect();
        sorted.sort_unstable_by_key(|&i| self.grains.original[i as usize]);
        let grains = sorted
            .into_iter()
            .map(|i| {
                let i = i as usize;
                let mut grain = self.particles.grain(self.grains.original[i].index());
                grain.position = self.domain.wrap(self.grains.position(i));
                grain.velocity = self.grains.velocity[i];
                grain.angular_velocity = self.grains.angular[i];
                grain
            })
            .collect();
        Particles { fixed_groups: self.particles.fixed_groups.clone(), ..grains }
    }

    /// Grains of a state of this run, in the order of the set-up, positions inside the domain.
    ///
    /// # Errors
    /// A state of another run.
    pub fn particles_of(&self, state: &State) -> Result<Particles, DemError> {
        state.particles(&self.particles, &self.domain)
    }

    /// Whether a potential or the external field changes with time: they do work on the grains.
    #[must_use]
    pub fn field_changes(&self) -> bool {
        self.field.as_ref().is_some_and(FieldStage::changes)
    }

    /// Electric force on each grain in the last step [N], in the order of [`Self::particles`]; `None` without
    /// a field.
    #[must_use]
    pub fn electric_forces(&self) -> Option<Vec<Vector3<f64>>> {
        let field = self.field.as_ref()?;
        let mut sorted: Vec<usize> = (0..self.grains.len()).collect();
        sorted.sort_unstable_by_key(|&i| self.grains.original[i]);
        let force = field.forces(&self.grains, self.progress.skin_m, self.progress.step_s);
        Some(sorted.into_iter().map(|i| force[i]).collect())
    }

    /// Potential, charge and image current of each conductor of the field; none without a field. The motion
    /// does not change.
    ///
    /// # Errors
    /// A field that fails.
    pub fn conductors(&mut self) -> Result<Vec<ConductorValues>, DemError> {
        self.collect_extras();
        let Some(field) = &mut self.field else { return Ok(Vec::new()) };
        field.conductors(&self.domain, &self.grains, &self.particles, &self.scratch.extras)
    }

    /// Energies [J]; the motion does not change.
    ///
    /// # Errors
    /// A field that fails.
    pub fn energies(&mut self, electric: ElectricEnergy) -> Result<Energies, DemError> {
        if electric == ElectricEnergy::Evaluated || self.field.as_ref().is_some_and(FieldStage::changes) {
            self.collect_extras();
        }
        let extras = &self.scratch.extras;
        let electric = match (&mut self.field, electric) {
            (None, _) | (_, ElectricEnergy::LeftOut) => None,
            (Some(field), ElectricEnergy::Forecast) => {
                Some(field.forecast_energy(&self.domain, &self.grains, &self.particles, extras))
            }
            (Some(field), ElectricEnergy::Evaluated) => {
                Some(field.fresh_energy(&self.domain, &self.grains, &self.particles, extras)?)
            }
        };
        let contact = energy::contact(&self.grains, &self.contacts);
        let (gravity, sizes) = energy::gravity(&self.grains, self.time.gravity_m_s2);
        let of_field = electric.map_or(0.0, |electric| electric.error);
        Ok(Energies {
            kinetic: energy::kinetic(&self.grains),
            contact,
            gravity,
            electric: electric.map(|electric| electric.energy),
            error: energy::ROUND_OFF * (contact.abs() + sizes) + of_field,
        })
    }

    /// Collects the charges of walls where they are now.
    fn collect_extras(&mut self) {
        self.scratch.extras.clear();
        if let Some(charging) = &self.charging {
            charging.add_spots(&self.domain, &mut self.scratch.extras);
        }
    }

    /// Id and speed [m/s] of the fastest grain.
    #[must_use]
    pub fn fastest(&self) -> Option<(u64, f64)> {
        let speeds = self.grains.velocity.iter().map(|velocity| velocity.norm());
        let (i, speed) = speeds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((self.particles.id[self.grains.original[i].index()], speed))
    }

    /// Id of a grain whose position or velocity is not finite.
    #[must_use]
    pub fn not_finite(&self) -> Option<u64> {
        let not_finite = |i: &usize| {
            let grains = &self.grains;
            !grains.position(*i).iter().chain(grains.velocity[*i].iter()).all(|value| value.is_finite())
        };
        let ids = (0..self.grains.len())
            .filter(not_finite)
            .map(|i| self.particles.id[self.grains.original[i].index()]);
        ids.min()
    }

    /// Number of touching contacts, of grains and with walls, at the last evaluation.
    #[must_use]
    pub fn contacts(&self) -> usize {
        self.contacts.count()
    }

    /// Work of the walls that move on the grains since the start [J]; `None` where all walls are at rest.
    #[must_use]
    pub fn wall_work(&self) -> Option<f64> {
        self.contacts.walls.as_ref()?.work()
    }

    /// Places of the walls that move, by their number in the set-up.
    pub fn wall_placements(&self) -> impl Iterator<Item = (u32, Placement)> {
        self.contacts.walls.iter().flat_map(|walls| walls.placements())
    }

    /// Loads of the grains on each wall, in the order of the set-up, at the last step; `None` without walls,
    /// and before the first step of a run that goes on.
    ///
    /// In a periodic box torques take grains where they are in the box.
    #[must_use]
    pub fn wall_loads(&self) -> Option<Vec<WallLoad>> {
        self.contacts.walls.as_ref()?.loads()
    }

    /// Account of the force limit; `None` without a field.
    #[must_use]
    pub fn limited(&self) -> Option<Limited> {
        self.field.as_ref().map(|field| field.limited)
    }

    /// Evaluations of the field and the error made between them; `None` without a field.
    #[must_use]
    pub fn intervals(&self) -> Option<Intervals> {
        self.field.as_ref().map(FieldStage::intervals)
    }

    /// Stages that run and stages that are left out.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Wall-clock seconds spent in each stage of the plan.
    #[must_use]
    pub fn stage_seconds(&self) -> Vec<(&'static str, f64)> {
        STAGE_NAMES.into_iter().zip(self.watch.seconds).filter(|(name, _)| self.plan.has(name)).collect()
    }

    /// Limits on the time step at the present speeds and of the present pairs.
    #[must_use]
    pub fn guards(&self) -> Vec<Guard> {
        let mut limits = self.limits.clone();
        if let (Some(stiffness), Some(field)) = (self.electric_stiffness(), &self.field) {
            limits.set_electric(stiffness, field.plasma_limit);
        }
        limits.guards(&self.progress).collect()
    }

    /// The field; `None` without a field stage.
    #[must_use]
    pub fn field(&self) -> Option<&ElectricField> {
        self.field.as_ref().map(|stage| &stage.source.field)
    }
}
