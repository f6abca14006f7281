//! Log: lines go to Python's logger `amberfield`, and those of a run to its `log.jsonl` too.

use amberfield_cli::Log;
use pyo3::prelude::*;
use std::fmt::Write as _;
use std::sync::{Mutex, OnceLock, PoisonError};
use tracing::field::{Field, Visit};
use tracing::{Event, Level, Subscriber};
use tracing_subscriber::layer::{Context, Layer, SubscriberExt as _};

/// Log of the runs of this process.
static LOG: OnceLock<Log> = OnceLock::new();
/// Lines that Python has not heard yet, with their levels as Python counts them.
static LINES: Mutex<Vec<(u8, String)>> = Mutex::new(Vec::new());

/// Levels of Python's logging.
const ERROR: u8 = 40;
const WARNING: u8 = 30;
const INFO: u8 = 20;

/// Log of the runs of this process, started at the first call.
pub(crate) fn log() -> &'static Log {
    LOG.get_or_init(|| {
        let (log, layer) = Log::hosted();
        let subscriber = tracing_subscriber::registry().with(ToPython).with(layer);
        // Another program in this process may have a subscriber of its own, which then hears us.
        let _ = tracing::subscriber::set_global_default(subscriber);
        log
    })
}

/// Gives Python's logger the lines that it has not heard.
pub(crate) fn tell(py: Python<'_>) -> PyResult<()> {
    let lines = std::mem::take(&mut *LINES.lock().unwrap_or_else(PoisonError::into_inner));
    if lines.is_empty() {
        return Ok(());
    }
    let logger = py.import("logging")?.call_method1("getLogger", ("amberfield",))?;
    for (level, line) in lines {
        logger.call_method1("log", (level, "%s", line))?;
    }
    Ok(())
}

/// Layer that keeps lines for Python, which may be told of them only by a thread that holds it.
struct ToPython;

impl<S: Subscriber> Layer<S> for ToPython {
    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        let level = match *event.metadata().level() {
            Level::ERROR => ERROR,
            Level::WARN => WARNING,
            Level::INFO => INFO,
            _ => return,
        };
        let mut line = Line(String::new());
        event.record(&mut line);
        LINES.lock().unwrap_or_else(PoisonError::into_inner).push((level, line.0));
    }
}

/// Text of an event: its message, then its fields.
struct Line(String);

impl Visit for Line {
    fn record_debug(&mut self, field: &Field, value: &dyn std::fmt::Debug) {
        if field.name() == "message" {
            self.0.insert_str(0, &format!("{value:?}"));
        } else {
            let _ = write!(self.0, " {}={value:?}", field.name());
        }
    }
}
