//! Parameters that were chosen for a scene, and how good they were found to be.

use crate::methods::p3m_parameters::P3mParameters;
use serde::{Deserialize, Serialize};
use std::fmt;

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

impl fmt::Display for Choice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cutoff { cutoff_m } => write!(f, "cut-off {cutoff_m:.4e} m"),
            Self::Direct => write!(f, "the direct sum"),
            Self::Kolehmainen { cutoff_m } => write!(f, "kolehmainen, cut-off {cutoff_m:.4e} m"),
            Self::AllPairs => write!(f, "every pair"),
            Self::P3m(P3mParameters { cutoff_m, spacing_m, order, .. }) => {
                write!(f, "cut-off {cutoff_m:.4e} m, nodes {spacing_m:.4e} m apart, window of order {order}")
            }
        }
    }
}

/// Error found by comparing with a more exact evaluation on a sample of grains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// RMS error of E over the larger of E_rms and q_rms n^{2/3}/(4πε).
    pub relative_rms: f64,
    /// Grains in the sample.
    pub sample: usize,
}
