//! A point of a study, as it stands in the CSV.

use serde::{Deserialize, Serialize};

/// One method with its parameters on one problem.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Day of the measurement.
    pub date: String,
    /// Version of the program.
    pub version: String,
    /// Processor.
    pub processor: String,
    /// Threads.
    pub threads: usize,
    /// Problem.
    pub problem: String,
    /// Grains.
    pub grains: usize,
    /// Source of the truth.
    pub truth: String,
    /// Method.
    pub method: String,
    /// Value of the swept key; empty without a sweep.
    pub value: String,
    /// Parameters in force.
    pub parameters: String,
    /// RMS of |ΔE| over the scale; like all numbers below empty where the point failed.
    pub error: Option<f64>,
    /// 99th percentile of |ΔE| over the scale.
    pub p99: Option<f64>,
    /// Largest |ΔE| over the scale.
    pub worst: Option<f64>,
    /// Mean of (E − E_exact)·E_exact over that of E_exact²: what does not average out.
    pub bias: Option<f64>,
    /// Error that the a-priori model expected.
    pub estimated: Option<f64>,
    /// Tolerance that the method promises to keep.
    pub promised: Option<f64>,
    /// Error that the study allows.
    pub allowed: Option<f64>,
    /// Median seconds of an evaluation, over all turns.
    pub seconds: Option<f64>,
    /// Fastest and slowest turn's median [s].
    pub seconds_least: Option<f64>,
    /// Slowest turn's.
    pub seconds_most: Option<f64>,
    /// Seconds per stage, as `near=1.2e-3 grid=3.4e-4`.
    pub stages: String,
    /// Memory held [bytes].
    pub memory_bytes: Option<usize>,
    /// Mean number of partners within the cut-off.
    pub pairs_per_grain: Option<f64>,
    /// Command that repeats the point.
    pub command: String,
    /// Reason why the point failed; empty if it did not.
    pub failure: String,
}

impl Row {
    /// Nanoseconds per grain.
    #[must_use]
    pub fn ns_per_grain(&self) -> Option<f64> {
        Some(1e9 * self.seconds? / self.grains.max(1) as f64)
    }

    /// Error above which the study fails: what is promised or allowed, the smaller of the two.
    #[must_use]
    pub fn bound(&self) -> Option<f64> {
        [self.promised, self.allowed].into_iter().flatten().min_by(f64::total_cmp)
    }

    /// Whether the error is above its bound.
    #[must_use]
    pub fn breaks_its_bound(&self) -> bool {
        matches!((self.error, self.bound()), (Some(error), Some(bound)) if error.is_nan() || error > bound)
    }
}
