//! Progress of a run: a bar on a terminal, plain lines elsewhere.

use crate::arguments::Common;
use crate::print;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal as _, Write};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between plain lines.
const LINE_INTERVAL: Duration = Duration::from_secs(10);
/// Bar that is on the terminal now, so that log lines are written above it.
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

/// Display of the progress of a run.
#[derive(Debug)]
pub(crate) enum Progress {
    /// Bar on a terminal.
    Bar(ProgressBar),
    /// Plain lines: time of the last one, begin of the run, its first and its last step.
    Lines { last: Instant, begun: Instant, from: u64, until: u64 },
    /// No display.
    Silent,
}

impl Progress {
    /// Starts the display at step `from`, for a run to step `until`.
    pub(crate) fn start(common: &Common, from: u64, until: u64) -> Self {
        if common.no_progress || common.quiet {
            return Self::Silent;
        }
        if !io::stderr().is_terminal() {
            let now = Instant::now();
            return Self::Lines { last: now, begun: now, from, until };
        }
        let style = ProgressStyle::with_template("{bar:30} {pos}/{len} steps  {per_sec}  {eta} left  {msg}")
            .expect("the template is fixed");
        let bar = ProgressBar::with_draw_target(Some(until), ProgressDrawTarget::stderr_with_hz(5))
            .with_style(style);
        bar.set_position(from);
        bar.reset_eta();
        *BAR.lock().unwrap_or_else(PoisonError::into_inner) = Some(bar.clone());
        Self::Bar(bar)
    }

    /// Shows the step that is reached and its time [s].
    pub(crate) fn tell(&mut self, step: u64, time_s: f64) {
        match self {
            Self::Bar(bar) => {
                bar.set_position(step);
                // Formatting a message every step would cost more than a step of a small scene.
                if step.is_multiple_of(64) {
                    bar.set_message(format!("t = {time_s:.4e} s"));
                }
            }
            Self::Lines { last, begun, from, until } if last.elapsed() >= LINE_INTERVAL => {
                *last = Instant::now();
                #[expect(clippy::cast_precision_loss, reason = "a rate for the eye")]
                let (done, left) = ((step - *from) as f64, until.saturating_sub(step) as f64);
                let rate = done / begun.elapsed().as_secs_f64();
                print::note(format_args!(
                    "step {step}/{until}, t = {time_s:.4e} s, {rate:.0} steps/s, {:.0} s left",
                    left / rate
                ));
            }
            Self::Lines { .. } | Self::Silent => {}
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Self::Bar(bar) = self {
            bar.finish_and_clear();
            *BAR.lock().unwrap_or_else(PoisonError::into_inner) = None;
        }
    }
}

/// Writer to stderr that hides the bar while it writes.
#[derive(Debug, Default)]
pub(crate) struct Stderr;

impl Write for Stderr {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let bar = BAR.lock().unwrap_or_else(PoisonError::into_inner).clone();
        match bar {
            Some(bar) => bar.suspend(|| io::stderr().write(bytes)),
            None => io::stderr().write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        io::stderr().flush()
    }
}
