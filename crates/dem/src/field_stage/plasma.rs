//! Plasma limit: the step, and the interval between evaluations, against the charges' own oscillation.

use super::FieldStage;
use super::members::Members;
use crate::motion::grains::Grains;
use amberfield_core::{CouplingInterval, Particles, Vector3};
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
        self.plasma_limit = self.longest_step_at(frequency);
    }

    /// Longest stable step [s] at a plasma frequency [rad/s]; at the shortest interval where that is
    /// automatic.
    fn longest_step_at(&self, frequency: f64) -> f64 {
        let interval = match self.settings.coupling_interval {
            CouplingInterval::Steps(steps) => f64::from(steps.max(1)),
            CouplingInterval::Auto => 1.0,
        };
        time_step_limits::PLASMA_STABLE / (frequency * interval)
    }

    /// Plasma limit that members can never go below with the charges of the set-up, those that have yet to
    /// come among them [s]: their box holds their volumes, hence Σ q²/m over it is at most the largest
    /// q²/m over the volume of a grain.
    pub(crate) fn least_plasma_limit(&self, particles: &Particles) -> f64 {
        let members = particles.moving().filter(|grain| self.member[*grain]);
        let densest = members.map(|grain| {
            let volume = particles.mass(grain) / particles.density[grain];
            particles.charge[grain].powi(2) / (particles.mass(grain) * volume)
        });
        let densest = densest.fold(0.0, f64::max);
        self.longest_step_at(time_step_limits::plasma_frequency(densest, 1.0, self.permittivity()))
    }
}
