//! Plasma limit: the step, and the interval between evaluations, against the charges' own oscillation.

use super::FieldStage;
use super::members::Members;
use crate::motion::grains::Grains;
use amberfield_core::{CouplingInterval, Vector3};
use amberfield_laws::time_step_limits;

impl FieldStage {
    /// ω_p of the members that move, in their bounding box.
    pub(super) fn watch_plasma(&mut self, grains: &Grains, step: f64) {
        let Members { index, position, charge, .. } = &self.members;
        let mut min = Vector3::repeat(f64::INFINITY);
        let mut max = Vector3::repeat(f64::NEG_INFINITY);
        let mut sum = 0.0;
        let members = index.iter().zip(position).zip(charge);
        for ((&i, x), q) in members.filter(|((i, _), _)| !grains.is_fixed(**i as usize)) {
            let radius = Vector3::repeat(grains.centre[i as usize][3]);
            min = min.inf(&(x - radius));
            max = max.sup(&(x + radius));
            sum += q * q * grains.inverse_mass[i as usize];
        }
        if min.x > max.x {
            // None of them moves.
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
}
