//! Terminal as the observer of a run.

use crate::arguments::Common;
use crate::progress::Progress;
use crate::run::Observer;
use amberfield_dem::Simulation;
use std::ops::ControlFlow;

/// Terminal that shows the progress of a run.
#[derive(Debug)]
pub(crate) struct Terminal<'a> {
    common: &'a Common,
    progress: Progress,
}

impl<'a> Terminal<'a> {
    /// Makes a terminal that shows nothing before the run begins.
    pub(crate) fn new(common: &'a Common) -> Self {
        Self { common, progress: Progress::Silent }
    }
}

impl Observer for Terminal<'_> {
    fn begin(&mut self, from: u64, until: u64) {
        self.progress = Progress::start(self.common, from, until);
    }

    fn step(&mut self, step: u64, time_s: f64) {
        self.progress.tell(step, time_s);
    }

    fn frame(&mut self, _: &Simulation) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}
