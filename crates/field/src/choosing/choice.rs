//! Parameters that were chosen for a scene, and how good they were found to be.

use crate::methods::p3m_parameters::P3mParameters;
use serde::{Deserialize, Serialize};

/// Parameters chosen for a scene. They are written to the run folder and reused on resume, so that results
/// never depend on a stopwatch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Choice {
    /// The truncated sum.
    Cutoff {
        /// Cut-off radius r_c [m].
        cutoff_m: f64,
    },
    /// The direct sum.
    Direct,
    /// The published hybrid.
    Kolehmainen {
        /// Cut-off radius r_c [m].
        cutoff_m: f64,
    },
    /// p3m in open space with so few grains that every pair is summed: no grid is built.
    AllPairs,
    /// p3m on the internal grid.
    P3m(P3mParameters),
}

/// Error found by comparing with a more exact evaluation on a sample of grains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// RMS error of E over the larger of E_rms and q_rms n^{2/3}/(4πε).
    pub relative_rms: f64,
    /// Grains in the sample.
    pub sample: usize,
}
