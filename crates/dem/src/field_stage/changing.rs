//! Potentials and an external field that change with time.
//!
//! The part of E that they make and that is the same everywhere, E_u(t), is known at any time: it is added to
//! the forecasts in every step, and what evaluations and forecasts differ by does not see it. Where faces
//! across several axes make a field that differs from place to place, it is forecast like that of charges,
//! and evaluations follow at least twenty times in a period, or along a line of a table.

use super::FieldStage;
use super::forecast::FieldEnergy;
use super::members::Extras;
use crate::error::{DemError, SceneKey};
use crate::motion::grains::Grains;
use amberfield_core::{CouplingInterval, Domain, Particles, Vector3};
use amberfield_field::far::{FarSolver, Look};

/// Longest time between two trades, over that in which what changes goes along a straight line.
const TRADES: f64 = 0.2;
/// Most steps of an interval that are looked at ahead, and that it may thus have.
const MOST_LOOKS: u64 = 4096;

impl FieldStage {
    /// Whether a potential or the external field changes with time.
    pub(crate) fn changes(&self) -> bool {
        self.source.field.changes()
    }

    /// Goes on to a time [s], at the end of a step [s], whose potentials and external field grains feel from
    /// now on.
    pub(crate) fn advance(&mut self, time_s: f64, step_s: f64, grains: &Grains) {
        if !self.changes() {
            return;
        }
        let before = self.changing_uniform();
        self.set_time(time_s, step_s);
        let gained = self.changing_uniform() - before;
        let (forecast, member) = (&mut self.forecast, &self.member);
        forecast.gain(gained, |grain| member[grains.original[grain].index()]);
    }

    /// Takes the potentials and the external field of a time [s], in a run with steps of a length [s].
    pub(crate) fn set_time(&mut self, time_s: f64, step_s: f64) {
        self.step_s = step_s;
        self.source.set_time(time_s);
    }

    /// E_u at present [V/m]; zero where nothing changes.
    fn changing_uniform(&self) -> Vector3<f64> {
        let field = self.source.field.changing_uniform(&Vector3::zeros());
        field.external.e + field.faces.e
    }

    /// E_u a number of steps ago, each of a length [s]; `None` where nothing changes [V/m].
    pub(crate) fn changing_uniform_before(&self, steps: f64) -> Option<Vector3<f64>> {
        let field = &self.source.field;
        let time_s = self.source.time_s - steps * self.step_s;
        field.changes().then(|| field.changing_uniform_at(time_s))
    }

    /// Longest step that shows the potentials and the external field [s].
    pub(crate) fn longest_step_s(&self, domain: &Domain) -> f64 {
        self.settings.longest_step_s(domain.courses())
    }

    /// Has the next evaluation look ahead at potentials that only a field solver knows, in steps of a length
    /// [s].
    pub(super) fn look_ahead(&mut self, step_s: f64) {
        let (before, most) = (self.control.age, self.control.longest_next().min(MOST_LOOKS));
        let automatic = self.is_automatic();
        if let Some(solver) = self.source.field.far_solver_mut().filter(|_| automatic) {
            solver.look_ahead(Look { before, step_s, most });
        }
    }

    /// Most steps of a length [s] between two evaluations that follow the potentials.
    pub(super) fn most_steps(&self, step_s: f64) -> u64 {
        let followed = self.source.field.far_solver().and_then(FarSolver::followed);
        // A cast ends at the largest number.
        let most = (self.source.field.longest_forecast_s(self.source.time_s) / step_s) as u64;
        followed.map_or(most, |followed| followed.min(most))
    }

    /// Most steps between two trades of charge that follow what changes: areas grow in a part of that time,
    /// and the field of its middle stands for theirs.
    pub(crate) fn most_steps_of_trades(&self) -> u64 {
        let longest_s = TRADES * self.source.field.longest_look_s(self.source.time_s);
        let most = (longest_s / self.step_s) as u64;
        if self.source.field.far_solver().is_some_and(FarSolver::changes) {
            // An interval ends where a straight line does.
            return most.min((TRADES * self.control.intervals.steps_now as f64) as u64);
        }
        most
    }

    /// Checks that a step [s], and an interval of steps that the scene fixes, show what changes.
    pub(crate) fn check_step(&self, domain: &Domain, step_s: f64) -> Result<(), DemError> {
        let longest = self.longest_step_s(domain);
        if step_s > longest {
            return Err(SceneKey::of("time", &["step_s"]).refuse(format!(
                "a step of {step_s:e} s is too long for the frequency of a potential or of the external \
                 field, whose period has to have 20 steps at least; make time.step_s at most {longest:e} s"
            )));
        }
        if let CouplingInterval::Steps(steps) = self.settings.coupling_interval
            && self.source.field.longest_forecast_s(0.0).is_finite()
            && f64::from(steps) * step_s > longest
        {
            return Err(SceneKey::of("electric_field", &["coupling_interval"]).refuse(format!(
                "electric_field.coupling_interval = {steps} is too long for the frequency of a potential, \
                 whose period has to have 20 evaluations at least; give at most {} steps, or \"auto\"",
                ((longest / step_s) as u64).max(1)
            )));
        }
        Ok(())
    }

    /// Energy of the members' charges in the field that is the same everywhere and changes, Σ q (½ V of the
    /// faces + V of the external field) [J]; zero where nothing changes.
    pub(super) fn energy_of_changing(&self, position: &[Vector3<f64>], charge: &[f64]) -> f64 {
        if !self.changes() {
            return 0.0;
        }
        let energy = |(x, q): (&Vector3<f64>, &f64)| {
            let field = self.source.field.changing_uniform(x);
            q * (0.5 * field.faces.potential + field.external.potential)
        };
        position.iter().zip(charge).map(energy).sum()
    }

    /// Electric energy extrapolated from the last two evaluations, with what changes and is the same
    /// everywhere as it is at present.
    pub(crate) fn forecast_energy(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
        extras: &Extras,
    ) -> FieldEnergy {
        if self.changes() {
            self.onlookers.collect(&self.member, domain, grains, particles, extras);
        }
        self.forecast_energy_of_onlookers()
    }

    /// Electric energy as [`Self::forecast_energy`] has it, for the members at the last look.
    pub(super) fn forecast_energy_of_onlookers(&self) -> FieldEnergy {
        let forecast = self.energy.at(self.control.age);
        let changing = self.energy_of_changing(&self.onlookers.position, &self.onlookers.charge);
        FieldEnergy { energy: forecast.energy + changing, ..forecast }
    }
}
