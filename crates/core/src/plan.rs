//! Stages that will run and stages that are left out, with the reasons.

use serde::{Deserialize, Serialize};

/// A stage and the reason for which it is there, or not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlanEntry {
    /// Name of the stage, as in `history.csv`'s `wall_s_<stage>`.
    pub stage: String,
    /// Reason for which the stage is there, or left out.
    pub reason: String,
}

/// A scene compiled into stages: only these are built, allocate memory and cost time.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Plan {
    stages: Vec<PlanEntry>,
    left_out: Vec<PlanEntry>,
}

impl Plan {
    /// A plan without stages.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a stage that will be built.
    pub fn build(&mut self, stage: impl Into<String>, reason: impl Into<String>) {
        self.stages.push(PlanEntry { stage: stage.into(), reason: reason.into() });
    }

    /// Adds a stage that is left out.
    pub fn leave_out(&mut self, stage: impl Into<String>, reason: impl Into<String>) {
        self.left_out.push(PlanEntry { stage: stage.into(), reason: reason.into() });
    }

    /// Adds a stage that is built for one reason or left out for another.
    pub fn decide(&mut self, is_built: bool, stage: &str, built_for: impl Into<String>, left_out_for: &str) {
        if is_built { self.build(stage, built_for) } else { self.leave_out(stage, left_out_for) }
    }

    /// The stages that run, in order.
    #[must_use]
    pub fn stages(&self) -> &[PlanEntry] {
        &self.stages
    }

    /// Stages that are left out.
    #[must_use]
    pub fn left_out(&self) -> &[PlanEntry] {
        &self.left_out
    }

    /// Whether a stage is built.
    #[must_use]
    pub fn has(&self, stage: &str) -> bool {
        self.stages.iter().any(|entry| entry.stage == stage)
    }

    /// Appends another plan's entries.
    pub fn extend(&mut self, other: Self) {
        self.stages.extend(other.stages);
        self.left_out.extend(other.left_out);
    }
}
