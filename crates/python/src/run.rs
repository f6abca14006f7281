//! Run of a scene.

use crate::{errors, host_log, snapshot, threads};
use amberfield_cli::{Observer, RunRequest, interrupt, simulate};
use amberfield_dem::Simulation;
use amberfield_scene::SceneInput;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// Run of this process; there is one at a time, since it owns the log and the interrupt.
static RUNNING: Mutex<()> = Mutex::new(());

/// Runs a scene. Returns its folder and the lines that the command prints.
///
/// `scene` is a path, or a text where `folder` names the folder of the files in it. `frame` is called with
/// the grains of each output and stops the run by returning False; `progress` with step, last step and time
/// [s].
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "a function of Python, with keywords")]
pub(crate) fn run(
    py: Python<'_>,
    scene: PathBuf,
    text: Option<(String, PathBuf)>,
    out: Option<PathBuf>,
    set: Vec<String>,
    steps: Option<u64>,
    resume: Option<PathBuf>,
    overwrite: bool,
    accept_changed_case: bool,
    thread_count: Option<usize>,
    frame: Option<Py<PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(PathBuf, Vec<String>)> {
    let Ok(_running) = RUNNING.try_lock() else {
        let message = "another run goes on in this process; wait for it, or start processes of their own";
        return Err(errors::bad_input(py, message));
    };
    let scene = match text {
        Some((text, folder)) => SceneInput::Text { text, folder },
        None => SceneInput::File(scene),
    };
    let request = RunRequest { scene, out, steps, resume, accept_changed_case, overwrite, set };
    let pool = threads::pool(py, thread_count)?;
    let log = host_log::log();
    let reached = Reached::default();
    let mut observer = Host { reached: &reached, frame: frame.as_ref(), failure: None };

    log.restart();
    interrupt::forget();
    let done = threads::work(
        py,
        &pool,
        || simulate(&request, &mut observer, log),
        |py, signal| {
            if signal.is_some() {
                interrupt::ask();
            }
            // Of failures here only Ctrl-C ends a run: its results matter more than what is shown.
            let told = host_log::tell(py);
            reached.tell(py, progress.as_ref())?;
            told
        },
    );
    log.close();
    interrupt::forget();
    reached.tell(py, progress.as_ref())?;
    host_log::tell(py)?;
    if let Some(failure) = observer.failure {
        return Err(failure);
    }
    let outcome = done?.map_err(|failure| errors::of_failure(py, &failure))?;
    outcome.verdict.map_err(|failure| errors::of_failure(py, &failure))?;
    Ok((outcome.folder, outcome.lines))
}

/// Step that a run has reached, for the thread that shows it.
#[derive(Debug, Default)]
struct Reached {
    step: AtomicU64,
    until: AtomicU64,
    /// Bits of the time [s].
    time: AtomicU64,
}

impl Reached {
    /// Calls what shows the progress, once a run has begun. Ctrl-C in there is returned, what else fails is
    /// reported.
    fn tell(&self, py: Python<'_>, progress: Option<&Py<PyAny>>) -> PyResult<()> {
        let until = self.until.load(Ordering::Relaxed);
        let Some(progress) = progress.filter(|_| until > 0) else { return Ok(()) };
        let time = f64::from_bits(self.time.load(Ordering::Relaxed));
        match progress.call1(py, (self.step.load(Ordering::Relaxed), until, time)) {
            Err(error) if error.is_instance_of::<PyKeyboardInterrupt>(py) => Err(error),
            Err(error) => {
                error.write_unraisable(py, None);
                Ok(())
            }
            Ok(_) => Ok(()),
        }
    }
}

/// Python as the observer of a run.
struct Host<'a> {
    reached: &'a Reached,
    /// Function that takes the grains of an output.
    frame: Option<&'a Py<PyAny>>,
    /// Exception of that function.
    failure: Option<PyErr>,
}

impl Observer for Host<'_> {
    fn begin(&mut self, from: u64, until: u64) {
        self.reached.step.store(from, Ordering::Relaxed);
        self.reached.until.store(until, Ordering::Relaxed);
    }

    fn step(&mut self, step: u64, time_s: f64) {
        self.reached.step.store(step, Ordering::Relaxed);
        self.reached.time.store(time_s.to_bits(), Ordering::Relaxed);
    }

    fn frame(&mut self, simulation: &Simulation) -> ControlFlow<()> {
        let Some(call) = self.frame.filter(|_| self.failure.is_none()) else {
            return ControlFlow::Continue(());
        };
        let asked = Python::attach(|py| {
            let grains = snapshot::columns(py, simulation.particles())?;
            let answer = call.bind(py).call1((simulation.step_index(), simulation.time_s(), grains))?;
            Ok(if answer.extract::<bool>().is_ok_and(|goes_on| !goes_on) {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            })
        });
        asked.unwrap_or_else(|failure| {
            self.failure = Some(failure);
            ControlFlow::Break(())
        })
    }
}
