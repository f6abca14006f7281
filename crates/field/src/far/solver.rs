//! Somebody who solves for the far field, what was found last, and where the next solve starts.

use super::{FarField, FarMesh, FarRequest, FarValues};
use crate::FieldError;

/// A far field with its state.
#[derive(Debug)]
pub struct FarSolver {
    solver: Box<dyn FarField>,
    /// What was found last.
    pub(crate) values: FarValues,
    /// Where the next solve is to start from; empty: where the solver is.
    guess: Vec<f64>,
    /// Time of the next solve [s].
    time_s: f64,
}

impl FarSolver {
    pub(crate) fn new(solver: Box<dyn FarField>) -> Self {
        Self { solver, values: FarValues::default(), guess: Vec::new(), time_s: 0.0 }
    }

    pub(crate) fn mesh(&self) -> &FarMesh {
        self.solver.mesh()
    }

    /// Solves, from where it is to start; the request's own guess and time do not count.
    pub(crate) fn solve(&mut self, request: &FarRequest<'_>) -> Result<(), FieldError> {
        let request = FarRequest { guess: &self.guess, time_s: self.time_s, ..*request };
        self.solver.solve(&request, &mut self.values)?;
        self.guess.clear();
        Ok(())
    }

    /// What the next solve starts from at the cells' centres [V]: the potential of the last one, unless told otherwise.
    #[must_use]
    pub fn potential(&self) -> &[f64] {
        if self.guess.is_empty() { &self.values.potential } else { &self.guess }
    }

    /// Iterations of the last solve.
    #[must_use]
    pub fn iterations(&self) -> u64 {
        self.values.iterations
    }

    /// Time that the last solve took [s].
    #[must_use]
    pub fn seconds(&self) -> f64 {
        self.values.seconds
    }

    /// Starts the next solve from a potential of an earlier run [V].
    pub fn start_from(&mut self, potential: &[f64]) {
        if potential.len() == self.mesh().cell_count() {
            self.guess = potential.to_vec();
        }
    }

    /// Says at what time the next solve is [s].
    pub fn at_time(&mut self, time_s: f64) {
        self.time_s = time_s;
    }
}
