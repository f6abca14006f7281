//! Schedule of the outputs of a run.
//!
//! It depends on step numbers only, so that a continued run writes what an uninterrupted one would have
//! written.

use amberfield_core::TimeSettings;
use amberfield_scene::OutputSettings;
use serde::{Deserialize, Serialize};

/// Number of rows of a history for which the scene gives no interval.
const HISTORY_ROWS: f64 = 1000.0;
/// Rounding error of a time over the step that must not add a step, and that over the number of steps.
const STEP_ROUND_OFF: f64 = 1e-6;
const RELATIVE_ROUND_OFF: f64 = 1e-15;

/// Round-off of a number of steps.
fn rounding(steps: f64) -> f64 {
    STEP_ROUND_OFF.max(RELATIVE_ROUND_OFF * steps)
}

/// First step at or after a time [steps].
fn first_step_at(time: f64) -> f64 {
    (time - rounding(time)).ceil()
}

/// Interval of a recurring event [steps]; in general not a whole number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Every(f64);

impl Every {
    /// Tells whether the event is due at a step: the first one at or after its time, as the end of the run
    /// is. At step 0 it always is.
    pub(crate) fn is_due(self, step: u64) -> bool {
        let period = |step: f64| ((step + rounding(step)) / self.0.max(1.0)).floor();
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
        let total = first_step_at(time.end_s / step_s).max(1.0) as u64;
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
    use amberfield_core::{OnExit, Skin, Step, Vector3};

    /// Schedule of a run with files, rows and checkpoints at one interval [s].
    fn schedule(end_s: f64, every_s: f64, step_s: f64) -> Schedule {
        let time = TimeSettings {
            step: Step::Seconds(step_s),
            end_s,
            gravity_m_s2: Vector3::zeros(),
            skin: Skin::Auto,
            allow_unstable: false,
            on_exit: OnExit::Stop,
            allow_overlap: false,
        };
        let every = Some(every_s);
        let output = OutputSettings {
            every_s: every,
            history_every_s: every,
            checkpoint_every_s: every,
            ..OutputSettings::default()
        };
        Schedule::new(&time, &output, step_s, None)
    }

    #[test]
    fn events_recur_at_the_first_step_at_their_time() {
        let due: Vec<u64> = (0..16).filter(|step| Every(2.5).is_due(*step)).collect();
        assert_eq!(due, [0, 3, 5, 8, 10, 13, 15]);
        assert!((0..9).all(|step| Every(0.3).is_due(step)));
    }

    #[test]
    fn the_last_event_is_the_end_of_a_run_whose_time_is_a_multiple() {
        for periods in [1_u32, 2, 3, 7, 10, 30] {
            for every_s in [0.1, 0.3, 1e-3, 0.7, 1.0 / 3.0] {
                for step_s in [1e-5, 1.234_567e-5, 3e-5, 7.123e-6, every_s / 137.0, every_s / 64.3] {
                    let sums = (0..periods).fold(0.0, |sum, _| sum + every_s);
                    for end_s in [every_s * f64::from(periods), sums] {
                        let schedule = schedule(end_s, every_s, step_s);
                        // No step just before the end is one.
                        let last = (schedule.total.saturating_sub(20)..=schedule.total)
                            .filter(|step| schedule.frame_is_due(*step))
                            .collect::<Vec<_>>();
                        assert_eq!(last, [schedule.total], "{end_s} {every_s} {step_s}");
                        assert!(schedule.checkpoint_is_due(schedule.total));
                        assert!(schedule.history.is_due(schedule.total));
                        let off = schedule.total as f64 * step_s - end_s;
                        assert!(off > -1e-5 * step_s && off < step_s, "{off:e} of {step_s:e}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_later_end_has_the_events_of_an_earlier_one() {
        let (short, long) = (schedule(0.3, 0.1, 1.234_567e-5), schedule(0.9, 0.1, 1.234_567e-5));
        assert!((0..=short.total).all(|step| short.frame_is_due(step) == long.frame_is_due(step)));
    }
}
