//! When a run writes what. Decided by step numbers only, so that a continued run writes what it would have.

use amberfield_core::TimeSettings;
use amberfield_scene::OutputSettings;
use serde::{Deserialize, Serialize};

/// Rows of a history whose interval the scene leaves open.
const HISTORY_ROWS: f64 = 1000.0;
/// Rounding of `end_s/step_s` that does not make another step.
const STEP_ROUND_OFF: f64 = 1e-6;

/// Something that recurs, in steps; not a whole number of them in general.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Every(f64);

impl Every {
    /// Whether it is due at a step; at step 0 always.
    pub(crate) fn is_due(self, step: u64) -> bool {
        let period = |step: f64| ((step + 0.5) / self.0.max(1.0)).floor();
        #[expect(clippy::cast_precision_loss, reason = "steps are below 2^53")]
        let step = step as f64;
        step == 0.0 || period(step) > period(step - 1.0)
    }
}

/// When a run writes what.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Schedule {
    /// Steps of the whole run.
    pub(crate) total: u64,
    /// Rows of the history.
    pub(crate) history: Every,
    /// Particle files; `None`: only at the start and the end.
    pub(crate) frames: Option<Every>,
    /// Checkpoints; `None`: only at the end.
    pub(crate) checkpoints: Option<Every>,
}

impl Schedule {
    /// The schedule of a scene. `history` is what an earlier part of the run used.
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

    /// Whether particle files are due.
    pub(crate) fn frame_is_due(&self, step: u64) -> bool {
        step == 0 || self.frames.is_some_and(|every| every.is_due(step))
    }

    /// Whether a checkpoint is due.
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
