//! Potentials, charges and image currents of the conductors in a field.

use super::ElectricField;
use crate::error::FieldError;
use amberfield_core::ConductorState;
use nalgebra::Vector3;

/// State of a conductor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConductorValues {
    /// Potential [V].
    pub potential_v: f64,
    /// Charge [C], induced by the charges before it and by all potentials; what contacts have left on it is
    /// no part of it.
    pub charge_c: f64,
    /// Image current [A] that flows onto it while charges move and potentials stay; 0 where its charge is
    /// given.
    pub current_a: f64,
}

impl ElectricField {
    /// Potential, charge and image current of each of the settings' conductors, in their order, for charges
    /// [C] at these positions [m] with these velocities [m/s], for which the field was evaluated last: by
    /// Green's reciprocity and the theorem of Shockley and Ramo, I = Σ q v·E_b, with E_b the field of the
    /// conductor at 1 V among others at 0 (Shockley, J. Appl. Phys. 9, 635, 1938; Ramo, Proc. IRE 27, 584,
    /// 1939). Each conductor that has a potential costs an evaluation.
    ///
    /// # Errors
    /// The errors of [`Self::evaluate`].
    pub fn values_of_conductors(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        velocities: &[Vector3<f64>],
    ) -> Result<Vec<ConductorValues>, FieldError> {
        self.give_potentials();
        let potentials = self.method.potentials_of_conductors();
        let mut found = Vec::with_capacity(potentials.len());
        for (number, potential_v) in potentials.into_iter().enumerate() {
            if let ConductorState::Charge(charge_c) = self.settings.conductors[number].state {
                found.push(ConductorValues { potential_v, charge_c, current_a: 0.0 });
                continue;
            }
            let unit = self.method.unit_potential(number, positions)?;
            let (mut charge_c, mut current_a) = (unit.of_given, 0.0);
            for ((at, charge), velocity) in unit.at.iter().zip(charges).zip(velocities) {
                charge_c -= charge * at.potential;
                current_a += charge * velocity.dot(&at.e);
            }
            found.push(ConductorValues { potential_v, charge_c, current_a });
        }
        Ok(found)
    }
}
