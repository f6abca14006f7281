//! Settings of the field solver.

use std::path::PathBuf;
use std::time::Duration;

/// Settings of the field solver in another process.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverSettings {
    /// Folder of the case.
    pub case: PathBuf,
    /// Program other than ours, inside which our function object runs.
    pub application: Option<String>,
    /// Whether the flow of a gas is computed too: by `amberPimpleFoam` instead of `electricFieldFoam`.
    pub flow: bool,
    /// Whether this program starts the solver, or somebody else does.
    pub start: bool,
    /// Number of processes of the solver.
    pub ranks: u32,
    /// Time that an answer may take.
    pub timeout: Duration,
    /// Relative tolerance of the linear solver.
    pub far_tolerance: f64,
    /// File for what the solver prints; without one it is lost.
    pub log: Option<PathBuf>,
}
