//! Schedule of the outputs of a run.
//!
//! It depends on step numbers only, so that a continued run writes what an uninterrupted one would have
//! written.

use amberfield_core::TimeSettings;
use amberfield_scene::OutputSettings;
use serde::{Deserialize, Serialize};

/// Number of rows of a history for which the scene gives no interval.
const HISTORY_ROWS: f64 = 1000.0;
/// Rounding error of `end_s/step_s` that must not add a step.
const STEP_ROUND_OFF: f64 = 1e-6;

/// Interval of a recurring event [steps]; in general not a whole number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Every(f64);

impl Every {
    /// Tells whether the event is due at a step; at step 0 it always is.
    pub(crate) fn is_due(self, step: u64) -> bool {
        let period = |step: f64| ((step + 0.5) / self.0.max(1.0)).floor();
        #[expect(clippy::cast_precision_loss, reason = "steps are below 2^53")]
        let step = step as f64;
        step == 0.0 || period(step) > period(step - 1.0)
    }
}

/// Schedule of the outputs of a run.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Schedule {
    /// Number of steps of the whole run.
    pub(crate) total: u64,
    /// Interval of the rows of the history.
    pub(crate) history: Every,
    /// Interval of the particle files; `None` for the start and the end only.
    pub(crate) frames: Option<Every>,
    /// Interval of the checkpoints; `None` for the end only.
    pub(crate) checkpoints: Option<Every>,
}

impl Schedule {
    /// Schedule of a scene with a step [s]; `history` is the interval of an earlier part of the run.
    pub(crate) fn new(
        time: &TimeSettings,
        output: &OutputSettings,
        step_s: f64,
        history: Option<Every>,
    ) -> Self {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "the scene bounds the steps"
        )]
        let total = (time.end_s / step_s - STEP_ROUND_OFF).ceil().max(1.0) as u64;
        let every = |seconds: f64| Every(seconds / step_s);
        #[expect(clippy::cast_precision_loss, reason = "steps are below 2^53")]
        let automatic = Every((total as f64 / HISTORY_ROWS).max(1.0));
        Self {
            total,
            history: output.history_every_s.map(every).or(history).unwrap_or(automatic),
            frames: output.every_s.map(every),
            checkpoints: output.checkpoint_every_s.map(every),
        }
    }

    /// Tells whether particle files are due at a step.
    pub(crate) fn frame_is_due(&self, step: u64) -> bool {
        step == 0 || self.frames.is_some_and(|every| every.is_due(step))
    }

    /// Tells whether a checkpoint is due at a step.
    pub(crate) fn checkpoint_is_due(&self, step: u64) -> bool {
        step > 0 && self.checkpoints.is_some_and(|every| every.is_due(step))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn events_recur_at_the_nearest_step() {
        let due: Vec<u64> = (0..16).filter(|step| Every(2.5).is_due(*step)).collect();
        assert_eq!(due, [0, 2, 5, 7, 10, 12, 15]);
        assert!((0..9).all(|step| Every(0.3).is_due(step)));
    }
}
