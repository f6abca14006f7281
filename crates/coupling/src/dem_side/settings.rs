//! Settings of the field solver.

use crate::case::Stop;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Silence that a solver may keep before its first answers, over the usual one: it reads its mesh, and starts
/// from no potential.
const AT_FIRST: u32 = 4;

/// Settings of the field solver in another process.
#[derive(Clone, Debug)]
pub struct SolverSettings {
    /// Folder of the case.
    pub case: PathBuf,
    /// Folder in which the solver works that this program starts; without one somebody else starts it.
    pub workplace: Option<PathBuf>,
    /// Program other than ours, inside which our function object runs.
    pub application: Option<String>,
    /// Whether the flow of a gas is computed too: by `amberPimpleFoam` instead of `electricFieldFoam`.
    pub flow: bool,
    /// Number of processes of the solver.
    pub ranks: u32,
    /// File with their machines, as `mpirun` takes it; `None`: this machine, or those of a job of Slurm's.
    pub hosts: Option<PathBuf>,
    /// Time that a solver which lives may be silent.
    pub timeout: Duration,
    /// Time that a solver which somebody else starts may take to come; `None`: any.
    pub wait: Option<Duration>,
    /// Relative tolerance of the linear solver.
    pub far_tolerance: f64,
    /// Question whether the user asked to stop.
    pub stop: Stop,
}

impl SolverSettings {
    /// Time that a solver may be silent after a question; number 0 is that for its mesh.
    pub(super) fn patience(&self, question: u64) -> Duration {
        if question > 1 { self.timeout } else { self.timeout.saturating_mul(AT_FIRST) }
    }

    /// Settings of a solver of one process that this program starts, and that works in a folder of its own.
    #[must_use]
    pub fn started(case: impl Into<PathBuf>, workplace: impl AsRef<Path>) -> Self {
        let workplace = Some(workplace.as_ref().to_path_buf());
        Self { workplace, ..Self::awaited(case) }
    }

    /// Settings of a solver of one process that somebody else starts.
    #[must_use]
    pub fn awaited(case: impl Into<PathBuf>) -> Self {
        Self {
            case: case.into(),
            workplace: None,
            application: None,
            flow: false,
            ranks: 1,
            hosts: None,
            timeout: Duration::from_secs(30),
            wait: None,
            far_tolerance: 1e-6,
            stop: || false,
        }
    }
}
