//! Parameters that p3m could use for a scene, for people who want to look.

use crate::choosing::choice::{Choice, Measured};

/// Parameters that can be chosen for a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The parameters.
    pub choice: Choice,
    /// Relative error by the a-priori model; `None` for sums that are exact and while no grain is charged.
    pub estimated: Option<f64>,
    /// Relative error found on a sample; `None` likewise.
    pub measured: Option<Measured>,
    /// Shortest of a few evaluations [s].
    pub seconds: f64,
}
