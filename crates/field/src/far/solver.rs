//! Somebody who solves for the far field, what was found last, and where the next solve starts.

use super::{FarField, FarMesh, FarRequest, FarValues};
use crate::FieldError;

/// A far field with its state.
#[derive(Debug)]
pub(crate) struct FarSolver {
    solver: Box<dyn FarField>,
    /// What was found last.
    pub(crate) values: FarValues,
    /// Where the next solve is to start from; empty: where the solver is.
    guess: Vec<f64>,
}

impl FarSolver {
    pub(crate) fn new(solver: Box<dyn FarField>) -> Self {
        Self { solver, values: FarValues::default(), guess: Vec::new() }
    }

    pub(crate) fn mesh(&self) -> &FarMesh {
        self.solver.mesh()
    }

    /// Solves, from where it is to start; the request's own guess does not count.
    pub(crate) fn solve(&mut self, request: &FarRequest<'_>) -> Result<(), FieldError> {
        self.solver.solve(&FarRequest { guess: &self.guess, ..*request }, &mut self.values)?;
        self.guess.clear();
        Ok(())
    }

    /// What the next solve starts from at the cells' centres [V]: the potential of the last one, unless told otherwise.
    pub(crate) fn potential(&self) -> &[f64] {
        if self.guess.is_empty() { &self.values.potential } else { &self.guess }
    }

    /// Starts the next solve from a potential of an earlier run [V].
    pub(crate) fn start_from(&mut self, potential: &[f64]) {
        if potential.len() == self.mesh().cell_count() {
            self.guess = potential.to_vec();
        }
    }
}
