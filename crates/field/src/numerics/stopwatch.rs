//! Seconds per stage.

use std::time::Instant;

/// Laps of the last evaluation.
#[derive(Debug, Default)]
pub(crate) struct Stopwatch {
    last: Option<Instant>,
    laps: Vec<(&'static str, f64)>,
}

impl Stopwatch {
    /// Forgets the laps and starts.
    pub(crate) fn restart(&mut self) {
        self.laps.clear();
        self.last = Some(Instant::now());
    }

    /// Ends a stage.
    pub(crate) fn lap(&mut self, stage: &'static str) {
        let now = Instant::now();
        if let Some(last) = self.last.replace(now) {
            self.laps.push((stage, (now - last).as_secs_f64()));
        }
    }

    /// Stages in order, with their seconds.
    pub(crate) fn laps(&self) -> &[(&'static str, f64)] {
        &self.laps
    }
}
