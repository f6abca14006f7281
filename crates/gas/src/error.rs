//! Errors of the gas crate.

/// Reason why there is no flow.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GasError {
    /// Settings of the scene that are impossible.
    #[error("{0}")]
    Settings(String),
    /// Case that the solver of the flow does not take.
    #[error("{0}")]
    Refused(String),
    /// Solver of the flow that is lost, or whose answer makes no sense.
    #[error("{0}")]
    Solver(String),
}
