//! A field solver that may be lost and found again.

use super::announced::Announced;
use super::far::RemoteSolver;
use super::settings::SolverSettings;
use crate::CouplingError;
use amberfield_field::FieldError;
use amberfield_field::far::{FarField, FarMesh, FarRequest, FarValues};

/// Solvers that are started for one solve before it is given up.
const ATTEMPTS: usize = 3;

/// Starts a lost solver again, or waits for somebody to, and asks again from where the lost one was: the
/// answer is the same.
#[derive(Debug)]
pub struct PatientSolver {
    settings: SolverSettings,
    solver: Option<RemoteSolver>,
    mesh: FarMesh,
    /// Potential of the last solve.
    last: Vec<f64>,
    /// Whether the solver that is there has solved nothing yet, but one before has.
    is_new: bool,
}

impl PatientSolver {
    /// Wraps a solver that is there.
    #[must_use]
    pub fn new(settings: SolverSettings, solver: RemoteSolver) -> Self {
        let mesh = solver.mesh().clone();
        Self { settings, solver: Some(solver), mesh, last: Vec::new(), is_new: false }
    }

    /// A new solver of the same mesh.
    fn again(&self) -> Result<RemoteSolver, FieldError> {
        let solver = Announced::new(self.settings.clone()).and_then(Announced::connect)?;
        let (old, new) = (&self.mesh, solver.mesh());
        let same_potentials = old.changing() == new.changing();
        if old.centres() != new.centres() || old.boundary() != new.boundary() || !same_potentials {
            return Err(FieldError::Solver(format!(
                "the field solver came back with another mesh or other conditions ({} cells instead of {}, \
                 {} boundary faces instead of {}); restore the case, then resume",
                new.cell_count(),
                old.cell_count(),
                new.boundary().len(),
                old.boundary().len()
            )));
        }
        Ok(solver)
    }

    /// Asks, and asks a new solver where the one that is there is lost. `ask` gets the solver, the potential
    /// of the last solve, and whether the solver is new.
    fn insist(
        &mut self,
        mut ask: impl FnMut(&mut RemoteSolver, &[f64], bool) -> Result<(), CouplingError>,
    ) -> Result<(), FieldError> {
        let mut attempt = 0;
        loop {
            let error = match &mut self.solver {
                None => None,
                Some(solver) => match ask(solver, &self.last, self.is_new) {
                    Ok(()) => return Ok(()),
                    Err(error @ (CouplingError::Lost { .. } | CouplingError::TimedOut { .. })) => Some(error),
                    Err(error) => return Err(error.into()),
                },
            };
            attempt += 1;
            if let Some(error) = error {
                if attempt > ATTEMPTS {
                    return Err(error.into());
                }
                tracing::warn!("{error}; waiting for a new one");
            }
            // The lost one goes first, with all that it held.
            self.solver = None;
            self.solver = Some(self.again()?);
            self.is_new = true;
        }
    }
}

impl FarField for PatientSolver {
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn solve(&mut self, request: &FarRequest<'_>, values: &mut FarValues) -> Result<(), FieldError> {
        self.insist(|solver, last, is_new| {
            // A new one starts from where the lost one was.
            let guess = if is_new && request.guess.is_empty() { last } else { request.guess };
            solver.ask_for(&FarRequest { guess, ..*request }, values)
        })?;
        self.is_new = false;
        self.last.clone_from(&values.potential);
        Ok(())
    }

    fn potentials(&mut self, times_s: &[f64], values: &mut Vec<f64>) -> Result<(), FieldError> {
        self.insist(|solver, _, _| solver.ask_for_potentials(times_s, values))
    }
}
