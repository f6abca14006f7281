//! The electric force on the grains: E is evaluated now and then and extrapolated in between.
//!
//! `coupling_interval = "auto"`: E is evaluated anew
//!
//! * when the interval ends that keeps the error of the extrapolation, measured at every evaluation, at a
//!   share of the tolerance ([`interval`]);
//! * as soon as any grain may have moved by half the smallest member's radius since: what was measured says
//!   little about grains that are elsewhere by now;
//! * as soon as charges, or E by what their changes do to it, have changed by the tolerance in RMS, at
//!   contacts or because grains have left;
//! * as soon as impacts have turned grains so that the extrapolation errs by the tolerance ([`impacts`]);
//! * at the latest after 0.2/ω_p;
//! * twenty times in a period of potentials that change, where their field is not uniform ([`changing`]).
//!
//! A number of steps is kept as it is. All depends on the grains only.

mod answers;
mod changing;
mod conductors;
mod forecast;
mod impacts;
mod interval;
mod members;
mod plasma;
mod source;
mod state;
mod traffic;

pub use interval::Intervals;
pub(crate) use members::{Extras, Moment};
pub(crate) use state::FieldState;
pub(crate) use traffic::Leaver;

use crate::error::DemError;
use crate::motion::chunks::{CHUNK, chunk_count, for_each_chunk, is_parallel};
use crate::motion::grains::Grains;
use crate::setup::FieldStageSetup;
use amberfield_core::{Domain, FieldSettings, ForceLimit, Method, Particles, Vector3};
use amberfield_field::far::FarSolver;
use amberfield_field::{FieldValues, Wanted};
use amberfield_laws::force_limit;
use forecast::{EnergyForecast, FieldEnergy, Forecast, Medium};
use impacts::Impacts;
use interval::IntervalControl;
use members::{Charges, Members};
use serde::{Deserialize, Serialize};
use source::Source;

/// Largest travel of any grain between evaluations, over the smallest radius.
const MOST_TRAVEL: f64 = 0.5;
/// Gain in speed of a grain within a step that is allowed for where it is guessed whether the field will be
/// due.
const FASTER: f64 = 4.0;
/// The potential costs little on top of E, and spares the energy an evaluation of its own.
const WANTED: Wanted = Wanted { potential: true, components: false };

/// Error of potentials, over their size, that near pairs summed in single precision leave.
const SINGLE_PRECISION: f64 = 1e-6;
/// Error of potentials, over their size, that sums in double precision and of Ewald leave.
const DOUBLE_PRECISION: f64 = 1e-9;

/// Account of the force limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Limited {
    /// Grains limited in the last step.
    pub grains: u64,
    /// Steps in which any grain was limited.
    pub steps: u64,
    /// Steps × grains limited in them.
    pub grain_steps: u64,
    /// Largest electric force before limiting, over the whole run [N].
    pub largest_force_n: f64,
}

/// Findings of the force limiter in a chunk.
#[derive(Clone, Copy, Debug, Default)]
struct ChunkLimited {
    /// Grains limited.
    grains: u64,
    /// Largest force before limiting [N].
    largest: f64,
}

/// The field and the forces that it makes.
#[derive(Debug)]
pub(crate) struct FieldStage {
    pub(crate) source: Source,
    /// Iterations of a field solver in its last solve for the motion.
    pub(crate) solver_iterations: u64,
    settings: FieldSettings,
    /// Membership by the set-up's order.
    pub(crate) member: Vec<bool>,
    smallest_radius: f64,
    /// Members at the last evaluation.
    members: Members,
    /// Members at the last look at the energy.
    onlookers: Members,
    values: FieldValues,
    forecast: Forecast,
    energy: EnergyForecast,
    control: IntervalControl,
    impacts: Impacts,
    /// Travel of the fastest grain since the last evaluation [m].
    travel: f64,
    /// Length of a step [s], for what changes with time.
    step_s: f64,
    /// Most steps between evaluations under the plasma limit.
    plasma_steps: u64,
    /// Longest stable step at the present interval [s].
    pub(crate) plasma_limit: f64,
    pub(crate) limited: Limited,
    found: Vec<ChunkLimited>,
}

impl FieldStage {
    /// Builds the stage; the field chooses its parameters unless the set-up or a state knows them.
    pub(crate) fn new(
        domain: &Domain,
        setup: FieldStageSetup,
        particles: &Particles,
        state: Option<&FieldState>,
    ) -> Result<Self, DemError> {
        let (settings, member) = (setup.settings.clone(), setup.member.clone());
        let members = || (0..particles.len()).filter(|&i| member[i]);
        let smallest_radius = members().map(|i| particles.radius[i]).fold(f64::INFINITY, f64::min);
        let position: Vec<_> = members().map(|i| domain.wrap(particles.position[i])).collect();
        let mut charge: Vec<_> = members().map(|i| particles.charge[i]).collect();
        if charge.iter().all(|charge| *charge == 0.0) {
            source::stand_in(&mut charge);
        }
        let charges = Charges { position: &position, charge: &charge };
        let source = Source::new(domain, setup, charges, state)?;
        let mut stage = Self {
            source,
            solver_iterations: 0,
            settings,
            member,
            smallest_radius,
            members: Members::default(),
            onlookers: Members::default(),
            values: FieldValues::default(),
            forecast: Forecast::default(),
            energy: EnergyForecast::default(),
            control: IntervalControl::new(),
            impacts: Impacts::default(),
            travel: 0.0,
            step_s: 0.0,
            plasma_steps: 1,
            plasma_limit: f64::INFINITY,
            limited: Limited::default(),
            found: Vec::new(),
        };
        if let Some(state) = state {
            stage.forecast.clone_from(&state.forecast);
            stage.energy = state.energy;
            stage.control = state.control;
            stage.impacts = state.impacts;
            stage.travel = state.travel;
            stage.solver_iterations = state.solver_iterations;
            stage.plasma_steps = state.plasma_steps;
            stage.plasma_limit = state.plasma_limit;
            stage.limited = state.limited;
        }
        Ok(stage)
    }

    pub(crate) fn state(&self) -> FieldState {
        FieldState {
            choice: self.source.field.choice().clone(),
            fallback: self.source.fallback(),
            has_solver: self.source.field.far_solver().is_some(),
            solver_iterations: self.solver_iterations,
            far: self.source.far_state(),
            forecast: self.forecast.clone(),
            energy: self.energy,
            control: self.control,
            impacts: self.impacts,
            travel: self.travel,
            plasma_steps: self.plasma_steps,
            plasma_limit: self.plasma_limit,
            limited: self.limited,
        }
    }

    /// Evaluations so far and the error made between them.
    pub(crate) fn intervals(&self) -> Intervals {
        self.control.intervals
    }

    /// Follows grains that are reordered to `order[new] = old`; grains that are not named are gone.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        self.forecast.reorder(order);
    }

    /// Whether the next step may ask another process for the field, which may be lost.
    pub(crate) fn may_be_lost(&self, step: f64, speed: f64) -> bool {
        let far = self.travel + FASTER * step * speed > MOST_TRAVEL * self.smallest_radius;
        self.source.may_be_lost() && (far || self.control.may_be_due())
    }

    /// Books a step of length `step` [s] at largest speed `speed` [m/s]; whether E is due.
    pub(crate) fn is_due(&mut self, step: f64, speed: f64) -> bool {
        self.travel += step * speed;
        let far = self.is_automatic() && self.travel > MOST_TRAVEL * self.smallest_radius;
        self.control.is_due() || far
    }

    /// Whether charges have changed so much that E is due.
    pub(crate) fn charges_have_changed(&mut self, grains: &Grains) -> bool {
        let coulomb = self.settings.permittivity.coulomb();
        self.is_automatic() && self.forecast.has_jumped_by(self.settings.tolerance, &grains.centre, coulomb)
    }

    /// Books a step whose forces are forecast.
    pub(crate) fn book_forecast(&mut self, grains: &Grains) {
        let jumps = self.forecast.jumps(&grains.centre, self.settings.permittivity.coulomb());
        self.control.forecasts(jumps.e2);
    }

    /// Evaluates E.
    pub(crate) fn evaluate(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
        extras: &Extras,
        moment: Moment,
    ) -> Result<(), DemError> {
        self.members.collect(&self.member, domain, grains, particles, extras);
        self.members.time_s = moment.time_s;
        self.look_ahead(moment.step_s);
        self.source.evaluate(domain, &self.settings, &self.members, &mut self.values)?;
        extras.add_gained(&self.members.index, &mut self.values.e);
        let far = self.source.field.far_solver();
        self.solver_iterations = far.map_or(0, FarSolver::iterations);
        let missed = far.map_or(0.0, FarSolver::missed);
        let age = self.control.age;
        let energy = self.energy_of(&self.members, domain);
        let changing = self.energy_of_changing(&self.members.position, &self.members.charge);
        self.energy.renew(FieldEnergy { energy: energy.energy - changing, ..energy }, age);
        let medium = Medium {
            centre: &grains.centre,
            external: self.source.field.external(),
            least: self.least_scale(domain),
            coulomb: self.settings.permittivity.coulomb(),
        };
        let mut check = self.forecast.renew(&self.members, &self.values.e, age, &medium);
        if let Some(check) = check.as_mut().filter(|_| missed > 0.0) {
            // A solver that works beside the steps has its own forecast.
            check.missed = missed / self.rms().max(medium.least);
        }
        self.watch_plasma(grains, moment.step_s);
        let FieldSettings { coupling_interval, tolerance, .. } = self.settings;
        let most = self.plasma_steps.min(self.most_steps(moment.step_s));
        self.control.evaluated(check, coupling_interval, tolerance, most);
        self.impacts.evaluated(age);
        self.travel = 0.0;
        self.source.recheck(domain, &self.settings, &self.members, self.control.intervals.evaluations)?;
        Ok(())
    }

    /// RMS of E less the external field [V/m].
    fn rms(&self) -> f64 {
        let e = &self.values.e[..self.members.index.len()];
        let external = self.source.field.external();
        (e.iter().map(|e| (e - external).norm_squared()).sum::<f64>() / e.len().max(1) as f64).sqrt()
    }

    /// Scale of E where symmetry makes it vanish [V/m]: q_rms n^{2/3}/(4πε).
    fn least_scale(&self, domain: &Domain) -> f64 {
        let Members { index, charge, .. } = &self.members;
        let count = index.len().max(1) as f64;
        let q2 = charge[..index.len()].iter().map(|q| q * q).sum::<f64>() / count;
        let density = count / domain.volume();
        self.settings.permittivity.coulomb() * q2.sqrt() * density.powf(2.0 / 3.0)
    }

    /// Adds the electric force of this step to `total` [N], for the list's `skin` [m] and the `step` [s].
    pub(crate) fn add_forces(&mut self, grains: &Grains, skin: f64, step: f64, total: &mut [Vector3<f64>]) {
        let count = grains.len();
        self.found.clear();
        self.found.resize(chunk_count(count), ChunkLimited::default());
        let mut found = std::mem::take(&mut self.found);
        let (forecast, age) = (&self.forecast, self.control.age as f64);
        let largest = largest_force(self.settings.force_limit, grains, skin, step);
        for_each_chunk!(is_parallel(count), chunk_count(count), (total / CHUNK, found / 1), |k: usize,
                                                                                             (
            total,
            found,
        ): (
            &mut [Vector3<f64>],
            &mut [ChunkLimited]
        )| {
            let grains = (k * CHUNK..).zip(total);
            match &largest {
                None => grains.for_each(|(i, total)| *total += forecast.force(i, age)),
                Some(largest) => grains.for_each(|(i, total)| {
                    let force = forecast.force(i, age);
                    let limited = force_limit::limited(force, largest(i));
                    found[0].grains += u64::from(limited.shortened);
                    found[0].largest = found[0].largest.max(force.norm());
                    *total += limited.force;
                }),
            }
        });
        self.limited.grains = found.iter().map(|found| found.grains).sum();
        self.limited.largest_force_n =
            found.iter().map(|found| found.largest).fold(self.limited.largest_force_n, f64::max);
        self.found = found;
    }

    /// Electric force on each grain in the last step [N], sorted order.
    pub(crate) fn forces(&self, grains: &Grains, skin: f64, step: f64) -> Vec<Vector3<f64>> {
        let largest = largest_force(self.settings.force_limit, grains, skin, step);
        let force = |i| {
            let force = self.forecast.force(i, self.control.age as f64);
            largest.as_ref().map_or(force, |largest| force_limit::limited(force, largest(i)).force)
        };
        (0..grains.len()).map(force).collect()
    }

    /// Books the limiter's work of one step.
    pub(crate) fn book_step(&mut self) {
        self.limited.steps += u64::from(self.limited.grains > 0);
        self.limited.grain_steps += self.limited.grains;
    }

    /// ½ Σ q (V + V_external) [J] at the present positions, from an evaluation that the motion does not see.
    pub(crate) fn fresh_energy(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
        extras: &Extras,
    ) -> Result<FieldEnergy, DemError> {
        self.onlookers.collect(&self.member, domain, grains, particles, extras);
        // A field solver in step with a gas answers no question beyond the gas's time.
        self.onlookers.time_s = self.members.time_s;
        let looked = self.source.evaluate_aside(domain, &self.settings, &self.onlookers, &mut self.values)?;
        if !looked {
            return Ok(self.forecast_energy_of_onlookers());
        }
        Ok(self.energy_of(&self.onlookers, domain))
    }

    /// ½ Σ q (V + V_external) of the field's last values. The potential of the field contains the external
    /// field's once, whose energy has no factor ½.
    fn energy_of(&self, members: &Members, domain: &Domain) -> FieldEnergy {
        let Members { position, charge, .. } = members;
        let (external, centre) = (self.source.field.external(), domain.centre());
        let (mut energy, mut sizes) = (0.0, 0.0);
        for ((x, q), v) in position.iter().zip(charge).zip(&self.values.potential) {
            let outer = -external.dot(&(x - centre));
            energy += 0.5 * q * (v + outer);
            // The external field is exact.
            sizes += 0.5 * (q * (v - outer)).abs();
        }
        let relative = match self.settings.method {
            Method::P3m => self.settings.tolerance.max(SINGLE_PRECISION),
            Method::Direct => DOUBLE_PRECISION,
            // They state no error, and their forces have no potential.
            _ => 1.0,
        };
        FieldEnergy { energy, error: relative * sizes }
    }
}

/// Largest electric force on a grain [N]; `None` without a limit.
fn largest_force(
    limit: Option<ForceLimit>,
    grains: &Grains,
    skin: f64,
    step: f64,
) -> Option<impl Fn(usize) -> f64 + Sync> {
    let factor = limit?.factor;
    // A factor of 0 leaves nothing of the force on a grain that never moves too, where 0 · ∞ is no number.
    Some(move |i: usize| force_limit::largest(factor, 1.0 / grains.inverse_mass[i], skin, step).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{Boundary, Grain, GroupId, MaterialId, Method};

    const RADIUS: f64 = 1e-3;
    const STEP: f64 = 1e-5;
    const MOMENT: Moment = Moment { time_s: 0.0, step_s: STEP };

    /// Four charges at rest.
    fn stage() -> (FieldStage, Grains, Particles, Domain) {
        let domain = Domain::new(Vector3::repeat(-1.0), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3])
            .expect("a good scene");
        let particles: Particles = (0..4)
            .map(|k| Grain {
                id: k,
                position: Vector3::new(k as f64 * 4.0 * RADIUS, 0.0, 0.0),
                velocity: Vector3::zeros(),
                angular_velocity: Vector3::zeros(),
                radius: RADIUS,
                density: 2500.0,
                charge: 1e-12,
                material: MaterialId(0),
                group: GroupId(0),
            })
            .collect();
        let settings = FieldSettings { method: Method::Direct, tolerance: 1e-2, ..FieldSettings::default() };
        let setup = FieldStageSetup::new(settings, vec![true; 4]);
        let mut stage = FieldStage::new(&domain, setup, &particles, None).expect("a good scene");
        let grains = Grains::new(&particles, vec![0; 4], false);
        stage.evaluate(&domain, &grains, &particles, &Extras::default(), MOMENT).expect("a good scene");
        (stage, grains, particles, domain)
    }

    /// Steps until E is due.
    fn interval(stage: &mut FieldStage, speed: f64) -> u64 {
        (1..).find(|_| stage.is_due(STEP, speed)).expect("it is due one day")
    }

    #[test]
    fn grains_that_move_are_due_after_half_a_radius_and_all_under_the_plasma_limit() {
        let (mut stage, grains, particles, domain) = stage();
        let evaluate = |stage: &mut FieldStage| {
            stage.evaluate(&domain, &grains, &particles, &Extras::default(), MOMENT).expect("a good scene");
        };
        // The first interval is one step; grains at rest then double theirs up to the plasma limit.
        assert_eq!(interval(&mut stage, 0.0), 1);
        let mut last = 1;
        for _ in 0..24 {
            evaluate(&mut stage);
            let now = interval(&mut stage, 0.0);
            assert_eq!(now, (2 * last).min(stage.plasma_steps));
            last = now;
        }
        assert!(last == stage.plasma_steps && last > 200, "{last}");
        // 0.1 m/s: half a radius takes 500 steps, or 501 by round-off.
        evaluate(&mut stage);
        let moving = interval(&mut stage, 0.1);
        assert!((500..=501).contains(&moving), "{moving}");
    }
}
