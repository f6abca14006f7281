//! Failures between the two processes.

use amberfield_field::FieldError;
use amberfield_wire::WireError;
use std::time::Duration;

/// Failure between the two processes.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CouplingError {
    /// Shared memory cannot be had.
    #[error("shared memory: {0}")]
    SharedMemory(String),
    /// A message makes no sense.
    #[error("message from the {peer}: {error}")]
    Wire {
        /// Sender of the message.
        peer: &'static str,
        /// Fault of the message.
        error: WireError,
    },
    /// The peer said that it ends.
    #[error("the {peer} ended: {reason}")]
    Ended {
        /// Process that ended.
        peer: &'static str,
        /// Reason that it gave.
        reason: String,
    },
    /// The solver does not take the case.
    #[error("the field solver refuses the case: {0}")]
    Refused(String),
    /// The linear solver gave up before its tolerance.
    #[error(
        "the linear solver for V gave up after {iterations} iterations with a residual of {residual:e}, the \
         tolerance is {tolerance:e}; look at maxIter and the other entries of the solver V in \
         system/fvSolution, or raise electric_field.far_tolerance"
    )]
    NotConverged {
        /// Iterations of the linear solver.
        iterations: u64,
        /// Residual that it reached, relative.
        residual: f64,
        /// Residual that it was asked for.
        tolerance: f64,
    },
    /// The peer is gone without a word.
    #[error("the {peer} is gone at solve {solve} ({how})")]
    Lost {
        /// Process that is gone.
        peer: &'static str,
        /// Sign by which that was seen.
        how: String,
        /// Solve that was waited for.
        solve: u64,
    },
    /// The peer did not answer in time.
    #[error(
        "no answer from the {peer} to solve {solve} within {waited:?}; raise solver.timeout_s if it is \
         only slow"
    )]
    TimedOut {
        /// Process that was waited for.
        peer: &'static str,
        /// Solve that was waited for.
        solve: u64,
        /// Time that was waited.
        waited: Duration,
    },
    /// Nobody started a field process in time.
    #[error("nobody started a field solver within {waited:?}, solver.wait_s; type {advice}")]
    NobodyCame {
        /// Time that was waited.
        waited: Duration,
        /// Command that starts one.
        advice: String,
    },
    /// The program of the field process is not there.
    #[error(
        "there is no program {program}; `cargo xtask openfoam` builds the field solver, and the environment \
         variable AMBERFIELD_SOLVER names it; OpenFOAM's own and mpirun must be on the PATH"
    )]
    NoProgram {
        /// Program.
        program: String,
    },
    /// The field process cannot be started.
    #[error("cannot start the field solver {program}: {why}")]
    Start {
        /// Program.
        program: String,
        /// Reason.
        why: String,
    },
    /// The case is no case of OpenFOAM's, or one of its programs refuses it.
    #[error("{0}")]
    Case(String),
    /// The user asked to stop.
    #[error("stopped: {0}")]
    Stopped(String),
    /// The flow makes no sense.
    #[error("{0}")]
    Flow(String),
    /// The peer's mesh makes no sense.
    #[error(transparent)]
    Mesh(#[from] FieldError),
}

impl From<CouplingError> for FieldError {
    fn from(error: CouplingError) -> Self {
        match error {
            CouplingError::Refused(_) | CouplingError::Case(_) => Self::Refused(error.to_string()),
            CouplingError::NotConverged { .. } => Self::NotConverged(error.to_string()),
            error => Self::Solver(error.to_string()),
        }
    }
}
