//! Observer of a run.

use amberfield_dem::Simulation;
use std::ops::ControlFlow;

/// Observer of a run: a terminal, or a program that hosts it.
pub trait Observer {
    /// Hears that a run begins at step `from`, and that its last step is `until`.
    fn begin(&mut self, from: u64, until: u64);

    /// Hears of a step that is done, and of its time [s].
    fn step(&mut self, step: u64, time_s: f64);

    /// Hears that the grains were just written; `Break` stops the run with a checkpoint.
    fn frame(&mut self, simulation: &Simulation) -> ControlFlow<()>;
}
