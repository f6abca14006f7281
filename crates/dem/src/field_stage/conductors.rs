//! Potentials, charges and image currents of the field's conductors.

use super::FieldStage;
use super::members::{Extras, Members};
use crate::error::DemError;
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Particles, Vector3};
use amberfield_field::ConductorValues;

impl FieldStage {
    /// State of each conductor for the grains where they are, from evaluations that the motion does not see.
    pub(crate) fn conductors(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
        extras: &Extras,
    ) -> Result<Vec<ConductorValues>, DemError> {
        self.onlookers.collect(&self.member, domain, grains, particles, extras);
        let Members { index, position, charge, .. } = &self.onlookers;
        let mut velocity: Vec<_> = index.iter().map(|&i| grains.velocity[i as usize]).collect();
        // Charges of walls stay.
        velocity.resize(position.len(), Vector3::zeros());
        Ok(self.source.field.values_of_conductors(position, charge, &velocity)?)
    }
}
