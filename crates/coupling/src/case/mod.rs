//! The OpenFOAM case of a run: what its solver gets to see of it, and what is made of it.
//!
//! A user's case is read, never written. The solver works in a folder of the run's own that links to the
//! case; the mesh that a recipe gives, the parts for several ranks, logs, and the times that the solver
//! writes stay there.

mod alias;
mod contents;
mod dictionary;
mod launcher;
mod mesh;
mod parts;
mod start_time;
mod tools;
mod workplace;

pub use contents::CaseContents;
pub use start_time::lacks_field;
pub use tools::{Stop, foam_command};
pub(crate) use tools::{last_words, on_path};
pub use workplace::Workplace;

use crate::CouplingError;
use std::fmt::Display;
use std::path::Path;

/// Failure at a file or folder of a case.
fn unusable(path: &Path, problem: impl Display) -> CouplingError {
    CouplingError::Case(format!("{}: {problem}", path.display()))
}
