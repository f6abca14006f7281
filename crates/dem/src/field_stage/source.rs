//! Source of E: the internal grid, a field solver of another process, or the grid in place of a solver that
//! was lost.

use super::WANTED;
use super::members::{Charges, Members};
use super::state::FieldState;
use crate::error::DemError;
use crate::setup::FieldStageSetup;
use amberfield_core::{Domain, FieldSettings, Tuning, Vector3};
use amberfield_field::far::{FarSolver, FarState};
use amberfield_field::{Choice, ElectricField, FieldError, FieldValues};

/// Difference between the fields of a solver and of the grid, over E_rms and the tolerance, above which a run
/// says that they have other boundaries.
const STRANGERS: f64 = 5.0;

/// Evaluations after which the error is measured again, the first time and from then on; each time costs
/// several evaluations.
const RECHECK: [u64; 2] = [200, 1000];

/// A field, and what takes its place.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) field: ElectricField,
    /// The internal grid's parameters, should the solver be lost; `None`: then the run ends.
    fallback: Option<Choice>,
    /// Time of potentials that change [s].
    pub(super) time_s: f64,
}

impl Source {
    /// Builds the field; it chooses its parameters for the members' positions [m] and charges [C], unless the
    /// set-up or a state knows them.
    pub(super) fn new(
        domain: &Domain,
        setup: FieldStageSetup,
        charges: Charges<'_>,
        state: Option<&FieldState>,
    ) -> Result<Self, DemError> {
        let FieldStageSetup { settings, choice, solver, fallback, .. } = setup;
        let Charges { position, charge } = charges;
        let known = state.map(|s| &s.choice).or(choice.as_ref());
        let solver = solver.filter(|_| state.is_none_or(|state| state.has_solver));
        let has_solver = solver.is_some();
        let mut field = match (solver, known) {
            (None, Some(choice)) => ElectricField::with_choice(domain, &settings, choice)?,
            (None, None) => ElectricField::new(domain, &settings, position, charge)?,
            (Some(solver), Some(choice)) => {
                ElectricField::over_mesh_with_choice(solver.connect()?, &settings, choice)?
            }
            (Some(solver), None) => ElectricField::over_mesh(solver.connect()?, &settings, position, charge)?,
        };
        let fallback = match state {
            Some(state) => {
                if let Some(solver) = field.far_solver_mut() {
                    solver.start_from(&state.far)?;
                }
                state.fallback.clone()
            }
            None if fallback && has_solver => Some(provide(domain, &settings, charges, &mut field)?),
            None => None,
        };
        Ok(Self { field, fallback, time_s: 0.0 })
    }

    /// Takes the potentials and the external field of a time [s].
    pub(super) fn set_time(&mut self, time_s: f64) {
        self.time_s = time_s;
        self.field.set_time(time_s);
    }

    /// Takes another field.
    fn replace(&mut self, field: ElectricField) {
        self.field = field;
        self.field.set_time(self.time_s);
    }

    /// Evaluates E; the internal grid does it, from now on, when the solver is lost.
    pub(super) fn evaluate(
        &mut self,
        domain: &Domain,
        settings: &FieldSettings,
        members: &Members,
        values: &mut FieldValues,
    ) -> Result<(), DemError> {
        let Members { position, charge, time_s, .. } = members;
        if position.is_empty() {
            // Nothing has come yet, or all has left.
            values.e.clear();
            values.potential.clear();
            return Ok(());
        }
        let lost = match self.field.evaluate_at(*time_s, position, charge, WANTED, values) {
            Err(error) if error.is_of_solver() => error,
            answer => return Ok(answer?),
        };
        let Some(choice) = self.fallback.take() else { return Err(lost.into()) };
        tracing::warn!("{lost}; from here on the internal grid takes the field solver's place");
        self.replace(ElectricField::with_choice(domain, settings, &choice)?);
        Ok(self.field.evaluate_at(*time_s, position, charge, WANTED, values)?)
    }

    /// Measures the error on a sample of the grains now and then. Where it has left the tolerance, the
    /// internal grid chooses new parameters, by its model rather than by a stopwatch, so that a resumed run
    /// chooses the same. A field solver's parameters stay, with a warning.
    pub(super) fn recheck(
        &mut self,
        domain: &Domain,
        settings: &FieldSettings,
        members: &Members,
        evaluations: u64,
    ) -> Result<(), DemError> {
        let is_time = evaluations == RECHECK[0] || evaluations.is_multiple_of(RECHECK[1]);
        if !is_time || members.index.is_empty() {
            return Ok(());
        }
        let Members { index, position, charge, .. } = members;
        let (position, charge) = (&position[..index.len()], &charge[..index.len()]);
        let Some(measured) = self.field.measure_error(position, charge)? else { return Ok(()) };
        let (error, tolerance) = (measured.relative_rms, settings.tolerance);
        if error <= tolerance {
            tracing::info!("error of the field on a sample: {error:.2e}, tolerance {tolerance:e}");
            return Ok(());
        }
        if self.field.far_solver().is_some() {
            tracing::warn!(
                "error of the field on a sample: {error:.2e}, above the tolerance {tolerance:e}; \
                 a run that starts from here chooses new parameters"
            );
            return Ok(());
        }
        let by_model = FieldSettings { tuning: Tuning::Model, ..settings.clone() };
        match ElectricField::new(domain, &by_model, position, charge) {
            Ok(field) => {
                self.replace(field);
                tracing::warn!(
                    "error of the field on a sample: {error:.2e}, above the tolerance {tolerance:e}; \
                     new parameters: {}",
                    self.field.choice()
                );
            }
            Err(reason) => tracing::warn!(
                "error of the field on a sample: {error:.2e}, above the tolerance {tolerance:e}, \
                 and no better parameters: {reason}"
            ),
        }
        Ok(())
    }

    /// Evaluates E for onlookers: a field solver goes on from where the motion left it. `false` where it
    /// works beside the steps and would be disturbed.
    pub(super) fn evaluate_aside(
        &mut self,
        domain: &Domain,
        settings: &FieldSettings,
        members: &Members,
        values: &mut FieldValues,
    ) -> Result<bool, DemError> {
        if self.field.far_solver().is_some_and(FarSolver::overlaps) {
            return Ok(false);
        }
        let before = self.far_state();
        self.evaluate(domain, settings, members, values)?;
        if let Some(solver) = self.field.far_solver_mut() {
            solver.start_from(&before)?;
        }
        Ok(true)
    }

    /// Whether another process may be lost and the run with it.
    pub(super) fn may_be_lost(&self) -> bool {
        self.field.far_solver().is_some() && self.fallback.is_none()
    }

    /// State of a field solver.
    pub(super) fn far_state(&self) -> FarState {
        self.field.far_solver().map_or_else(FarState::default, FarSolver::state)
    }

    /// The internal grid's parameters, for a state.
    pub(super) fn fallback(&self) -> Option<Choice> {
        self.fallback.clone()
    }
}

/// Sets charges for which the field chooses its parameters where there are none yet: of both signs, zero in
/// sum.
pub(super) fn stand_in(charge: &mut [f64]) {
    for pair in charge.chunks_exact_mut(2) {
        pair.copy_from_slice(&[1e-15, -1e-15]);
    }
}

/// Chooses the internal grid's parameters while all is well, and compares its field with the solver's.
fn provide(
    domain: &Domain,
    settings: &FieldSettings,
    Charges { position, charge }: Charges<'_>,
    field: &mut ElectricField,
) -> Result<Choice, FieldError> {
    let mut internal = ElectricField::new(domain, settings, position, charge)?;
    let mut values = [FieldValues::default(), FieldValues::default()];
    field.evaluate(position, charge, WANTED, &mut values[0])?;
    internal.evaluate(position, charge, WANTED, &mut values[1])?;
    let [over_mesh, on_grid] = values;
    let square = |sum: f64, e: &Vector3<f64>| sum + e.norm_squared();
    let all = over_mesh.e.iter().fold(0.0, square);
    let apart = over_mesh.e.iter().zip(&on_grid.e).fold(0.0, |sum, (a, b)| square(sum, &(a - b)));
    let difference = if all > 0.0 { (apart / all).sqrt() } else { 0.0 };
    if difference > STRANGERS * settings.tolerance {
        tracing::warn!(
            "the internal grid, which takes over when the field solver is lost, differs from it by \
             {difference:.2e}: \
             its boundaries, [domain.boundary], are not those of the case"
        );
    } else {
        tracing::info!(
            "internal grid and field solver differ by {difference:.2e}; \
             the grid takes over when the solver is lost"
        );
    }
    Ok(internal.choice().clone())
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;

    #[test]
    fn parameters_that_no_longer_keep_the_tolerance_are_chosen_anew() {
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), [[Boundary::Grounded; 2]; 3])
            .expect("a good scene");
        let at = |i: u32, k: f64| 0.05 + 0.9 * (f64::from(i) * k).fract();
        let members = Members {
            index: (0..300).collect(),
            position: (0..300)
                .map(|i| Vector3::new(at(i, 0.618_034), at(i, 0.414_214), at(i, 0.302_776)))
                .collect(),
            charge: (0..300).map(|i| if i % 2 == 0 { 1e-12 } else { -1e-12 }).collect(),
            count: 300,
            time_s: 0.0,
        };
        let charges = Charges { position: &members.position, charge: &members.charge };
        let of =
            |tolerance: f64| FieldSettings { tolerance, tuning: Tuning::Model, ..FieldSettings::default() };
        let built = |choice: Option<Choice>, tolerance: f64| {
            let setup = FieldStageSetup { choice, ..FieldStageSetup::new(of(tolerance), vec![true; 300]) };
            Source::new(&domain, setup, charges, None).expect("a good scene")
        };
        let coarse = built(None, 0.1).field.choice().clone();
        let mut source = built(Some(coarse.clone()), 1e-3);
        let mut recheck = |evaluations: u64| {
            source.recheck(&domain, &of(1e-3), &members, evaluations).expect("a good scene");
            source.field.choice().clone()
        };
        assert_eq!(recheck(RECHECK[0] - 1), coarse);
        let finer = recheck(RECHECK[0]);
        assert_ne!(finer, coarse);
        assert_eq!(recheck(RECHECK[1]), finer);
    }
}
