//! Errors of the gas crate.

/// Why there is no flow.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GasError {
    /// What the scene asks for is impossible.
    #[error("{0}")]
    Settings(String),
    /// Whoever computes the flow is lost, or answers what makes no sense.
    #[error("{0}")]
    Solver(String),
}
