//! Seconds spent per stage.

use std::time::Instant;

/// Stages in the order in which they run in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Stage {
    Integrate,
    Neighbours,
    Contacts,
    Walls,
    Gas,
    Charging,
    Field,
}

/// Names as in `history.csv`'s `wall_s_<stage>`.
pub(crate) const STAGE_NAMES: [&str; 7] =
    ["integrate", "neighbours", "contacts", "walls", "gas", "charging", "field"];

/// A stopwatch that results never depend on.
#[derive(Debug, Default)]
pub(crate) struct StageClock {
    pub(crate) seconds: [f64; 7],
    last: Option<Instant>,
}

impl StageClock {
    /// Starts the clock.
    pub(crate) fn start(&mut self) {
        self.last = Some(Instant::now());
    }

    /// Books the time since the last call for a stage.
    pub(crate) fn lap(&mut self, stage: Stage) {
        let now = Instant::now();
        if let Some(last) = self.last.replace(now) {
            self.seconds[stage as usize] += (now - last).as_secs_f64();
        }
    }
}
