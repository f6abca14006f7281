//! Where E comes from: the internal grid, a field solver of another process, or the grid in place of a solver that was lost.

use super::WANTED;
use super::members::Members;
use crate::error::DemError;
use crate::field_crate::far::{FarSolver, FarState};
use crate::field_crate::{Choice, ElectricField, FieldError, FieldValues};
use crate::setup::FieldStageSetup;
use crate::state::FieldState;
use amberfield_core::{Domain, FieldSettings, Vector3};

/// Difference between the fields of a solver and of the grid, over E_rms and the tolerance, above which a run says that they
/// have other boundaries.
const STRANGERS: f64 = 5.0;

/// A field, and what takes its place.
#[derive(Debug)]
pub(crate) struct Source {
    pub(crate) field: ElectricField,
    /// The internal grid's parameters, should the solver be lost; `None`: then the run ends.
    fallback: Option<Choice>,
}

impl Source {
    /// Builds the field; it chooses its parameters for the members' positions [m] and charges [C], unless the set-up or a
    /// state knows them.
    pub(super) fn new(
        domain: &Domain,
        setup: FieldStageSetup,
        (position, charge): (&[Vector3<f64>], &[f64]),
        state: Option<&FieldState>,
    ) -> Result<Self, DemError> {
        let FieldStageSetup { settings, choice, solver, fallback, .. } = setup;
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
            None if fallback && has_solver => {
                Some(provide(domain, &settings, (position, charge), &mut field)?)
            }
            None => None,
        };
        Ok(Self { field, fallback })
    }

    /// Evaluates E; the internal grid does it, from now on, when the solver is lost.
    pub(super) fn evaluate(
        &mut self,
        domain: &Domain,
        settings: &FieldSettings,
        members: &Members,
        values: &mut FieldValues,
    ) -> Result<(), DemError> {
        let Members { position, charge, .. } = members;
        let lost = match self.field.evaluate(position, charge, WANTED, values) {
            Err(error) if error.is_of_solver() => error,
            answer => return Ok(answer?),
        };
        let Some(choice) = self.fallback.take() else { return Err(lost.into()) };
        tracing::warn!("{lost}; from here on the internal grid takes the field solver's place");
        self.field = ElectricField::with_choice(domain, settings, &choice)?;
        Ok(self.field.evaluate(position, charge, WANTED, values)?)
    }

    /// Evaluates E for onlookers: a field solver goes on from where the motion left it. `false` where it works beside
    /// the steps and would be disturbed.
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

/// Chooses the internal grid's parameters while all is well, and compares its field with the solver's.
#[cfg_attr(
    not(feature = "field"),
    expect(unreachable_code, reason = "a build without fields has none to compare")
)]
fn provide(
    domain: &Domain,
    settings: &FieldSettings,
    (position, charge): (&[Vector3<f64>], &[f64]),
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
            "the internal grid, which takes over when the field solver is lost, differs from it by {difference:.2e}: \
             its boundaries, [domain.boundary], are not those of the case"
        );
    } else {
        tracing::info!(
            "internal grid and field solver differ by {difference:.2e}; the grid takes over when the solver is lost"
        );
    }
    Ok(internal.choice().clone())
}
