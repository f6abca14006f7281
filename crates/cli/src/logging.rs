//! Log: to stderr at the level that the user chose, and completely to `log.jsonl` once a run has a folder.

use crate::arguments::{Common, LogFormat};
use crate::progress;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use tracing::level_filters::LevelFilter;
use tracing_subscriber::fmt::MakeWriter;
use tracing_subscriber::{Layer as _, layer::SubscriberExt as _};

/// Destination of the log's lines.
#[derive(Debug)]
enum Sink {
    /// Memory, until there is a run folder.
    Waiting(Vec<u8>),
    /// File in the run folder.
    File(File),
    /// Nothing: no run goes on.
    Nowhere,
}

/// Log file, shared with the subscriber.
#[derive(Clone, Debug)]
pub struct Log(Arc<Mutex<Sink>>);

impl Log {
    /// Log of a program that hosts runs, and the layer of its subscriber that writes to it: DEBUG and above.
    /// Between [`Self::restart`] and [`Self::close`] stands a run.
    #[must_use]
    pub fn hosted<S>() -> (Self, impl tracing_subscriber::Layer<S>)
    where
        S: tracing::Subscriber + for<'a> tracing_subscriber::registry::LookupSpan<'a>,
    {
        let log = Self(Arc::new(Mutex::new(Sink::Nowhere)));
        let layer = tracing_subscriber::fmt::layer().json().with_writer(log.clone());
        (log, layer.with_filter(LevelFilter::DEBUG))
    }

    /// Keeps all lines from now on for the file that a run will open.
    pub fn restart(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Sink::Waiting(Vec::new());
    }

    /// Ends the log of a run.
    pub fn close(&self) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Sink::Nowhere;
    }

    /// Sends the log to a file, with all lines that were written so far.
    pub(crate) fn open(&self, path: &Path) -> io::Result<()> {
        let mut file = File::options().create(true).append(true).open(path)?;
        let mut sink = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Sink::Waiting(lines) = &*sink {
            file.write_all(lines)?;
        }
        *sink = Sink::File(file);
        Ok(())
    }
}

impl Write for Log {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut *self.0.lock().unwrap_or_else(PoisonError::into_inner) {
            Sink::Waiting(lines) => lines.write(bytes),
            Sink::File(file) => file.write(bytes),
            Sink::Nowhere => Ok(bytes.len()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl<'a> MakeWriter<'a> for Log {
    type Writer = Self;

    fn make_writer(&'a self) -> Self {
        self.clone()
    }
}

/// Starts logging.
pub(crate) fn start(common: &Common) -> Log {
    let log = Log(Arc::new(Mutex::new(Sink::Waiting(Vec::new()))));
    let level = match (common.quiet, common.verbose) {
        (true, _) => LevelFilter::ERROR,
        (false, 0) => LevelFilter::INFO,
        (false, 1) => LevelFilter::DEBUG,
        (false, _) => LevelFilter::TRACE,
    };
    let stderr = tracing_subscriber::fmt::layer().with_writer(progress::Stderr::default).with_target(false);
    let stderr = match common.log_format {
        LogFormat::Text => stderr.with_ansi(false).without_time().boxed(),
        LogFormat::Json => stderr.json().boxed(),
    };
    let file = tracing_subscriber::fmt::layer().json().with_writer(log.clone());
    let subscriber = tracing_subscriber::registry()
        .with(stderr.with_filter(level))
        .with(file.with_filter(level.max(LevelFilter::DEBUG)));
    tracing::subscriber::set_global_default(subscriber).expect("the subscriber is set once");
    log
}
