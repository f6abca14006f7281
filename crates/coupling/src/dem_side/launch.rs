//! Starting the field process, watching it, ending it.

use super::settings::SolverSettings;
use super::surroundings::existing;
use crate::CouplingError;
use crate::case::{Workplace, foam_command, last_words};
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::File;
use std::os::unix::process::CommandExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Names of the field solver, and of the one that computes the flow of a gas too.
const PROGRAMS: [&str; 2] = ["electricFieldFoam", "amberPimpleFoam"];
/// Program that starts several processes.
const MPI: &str = "mpirun";
/// Variable with the path of one of the two programs.
const VARIABLE: &str = "AMBERFIELD_SOLVER";
/// Variable in which a function object inside another solver finds the run's name.
pub(super) const RUN: &str = "AMBERFIELD_RUN";
/// Variable with the folders of libraries, and the library with our function object.
const LIBRARIES: (&str, &str) = ("LD_LIBRARY_PATH", "libelectricField.so");

/// Beginnings of the variables that OpenFOAM's programs read.
const OF_OPENFOAM: [&str; 4] = ["FOAM_", "LD_LIBRARY_PATH", "MPI_BUFFER_SIZE", "WM_"];

/// Field process that this program has started.
#[derive(Debug)]
pub(super) struct Process {
    child: Child,
    ended: Option<ExitStatus>,
    log: PathBuf,
    /// Time that it may take to end once it was told to.
    farewell: Duration,
    _place: Workplace,
}

impl Process {
    /// Starts the solver of a case for a run, in a folder of the run's own.
    pub(super) fn start(
        settings: &SolverSettings,
        workplace: &Path,
        run: &str,
    ) -> Result<Self, CouplingError> {
        let program =
            settings.application.as_ref().map_or_else(|| solver_program(settings.flow), PathBuf::from);
        let missing = |name: &Path| CouplingError::NoProgram { program: name.display().to_string() };
        let program = existing(&program).ok_or_else(|| missing(&program))?;
        let place = Workplace::open(&settings.case, workplace)?;
        place.provide_mesh(settings.stop)?;
        let mut command = foam_command(&program);
        if settings.ranks > 1 {
            let dictionary = place.provide_parts(settings.ranks, settings.stop)?;
            command = mpi_command(settings).ok_or_else(|| missing(Path::new(MPI)))?;
            command.arg(&program).arg("-parallel");
            if let Some(dictionary) = dictionary {
                command.arg("-decomposeParDict").arg(dictionary);
            }
        }
        let folder = place.folder_to_run_in();
        command.arg("-case").arg(place.path()).current_dir(folder).env("PWD", folder);
        match settings.application {
            None => command.args(["-start", place.start_time(), "-run", run]),
            // Its function object reads the run's name, and is found, in the environment.
            Some(_) => command.env(RUN, run).env(LIBRARIES.0, library_path()),
        };
        let name = program.file_name().unwrap_or(program.as_os_str()).to_string_lossy();
        let log = place.log(&name);
        let file = File::create(&log).and_then(|file| Ok([file.try_clone()?, file]));
        let failed = |why: String| CouplingError::Start { program: program.display().to_string(), why };
        let [out, err] =
            file.map_err(|error| failed(format!("{} cannot be written: {error}", log.display())))?;
        // A group of its own: an interrupt at the terminal is the DEM process's to handle.
        command.process_group(0).stdin(Stdio::null()).stdout(out).stderr(err);
        tracing::info!("starting {name} from time {}; its log is {}", place.start_time(), log.display());
        let child = command.spawn().map_err(|error| failed(error.to_string()))?;
        Ok(Self { child, ended: None, log, farewell: settings.timeout, _place: place })
    }

    /// Whether it still runs; else how it ended.
    pub(super) fn check(&mut self) -> Result<(), String> {
        if self.ended.is_none() {
            self.ended = self.child.try_wait().ok().flatten();
        }
        let Some(status) = self.ended else { return Ok(()) };
        let log = std::fs::read(&self.log).unwrap_or_default();
        let words = last_words(&String::from_utf8_lossy(&log));
        let words = if words.is_empty() { String::new() } else { format!(": {words}") };
        Err(format!("{status}{words}; its log is {}", self.log.display()))
    }

    /// Waits until it has ended, for a while if it was told to, then kills it.
    pub(super) fn end(&mut self, told: bool) {
        let start = Instant::now();
        while told && self.check().is_ok() && start.elapsed() < self.farewell {
            std::thread::sleep(Duration::from_millis(2));
        }
        if self.check().is_ok() {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.end(false);
    }
}

/// The command that starts the ranks of a solver, up to the program; `None` where there is none.
fn mpi_command(settings: &SolverSettings) -> Option<Command> {
    let mut command = foam_command(existing(Path::new(MPI))?);
    command.args(["--oversubscribe", "--allow-run-as-root", "-np"]).arg(settings.ranks.to_string());
    if let Some(hosts) = &settings.hosts {
        command.arg("--hostfile").arg(std::path::absolute(hosts).unwrap_or_else(|_| hosts.clone()));
        for name in needed_elsewhere(&command, settings) {
            command.args(["-x", &name]);
        }
    }
    Some(command)
}

/// Variables that a solver's ranks need on machines where no login shell has set them.
fn needed_elsewhere(command: &Command, settings: &SolverSettings) -> BTreeSet<String> {
    let inherited = std::env::vars_os().map(|(name, _)| name);
    let set = command.get_envs().filter(|(_, value)| value.is_some()).map(|(name, _)| name.to_owned());
    let named = inherited.chain(set).filter_map(|name| name.into_string().ok());
    let is_needed = |name: &String| OF_OPENFOAM.iter().any(|beginning| name.starts_with(beginning));
    let by_name = settings.application.is_some().then_some([RUN, LIBRARIES.0].map(str::to_owned));
    named.filter(is_needed).chain(by_name.into_iter().flatten()).collect()
}

/// Name of the solver's program, with or without the flow of a gas.
#[must_use]
pub fn program_name(flow: bool) -> &'static str {
    PROGRAMS[usize::from(flow)]
}

/// The solver's program: the one that the environment names (or beside it, for the flow of a gas), one beside
/// this program, one that the project has built above it, or one on the path.
#[must_use]
pub fn solver_program(flow: bool) -> PathBuf {
    let name = program_name(flow);
    match std::env::var_os(VARIABLE).map(PathBuf::from) {
        Some(named) if flow => named.with_file_name(name),
        Some(named) => named,
        None => near_this_program(name).unwrap_or_else(|| name.into()),
    }
}

/// A file beside this program, or that the project has built above it.
fn near_this_program(name: &str) -> Option<PathBuf> {
    let own = std::env::current_exe().unwrap_or_default();
    let beside = own.with_file_name(name);
    let built = own.ancestors().map(|folder| folder.join("openfoam-solver/build").join(name));
    std::iter::once(beside).chain(built).find(|path| path.is_file())
}

/// The folders in which the system looks for libraries, with that of the function object: beside the program
/// that the environment names, or where [`near_this_program`] finds it.
fn library_path() -> OsString {
    let known = std::env::var_os(LIBRARIES.0).unwrap_or_default();
    let beside_named = std::env::var_os(VARIABLE)
        .map(|named| PathBuf::from(named).with_file_name(LIBRARIES.1))
        .filter(|library| library.is_file());
    let library = beside_named.or_else(|| near_this_program(LIBRARIES.1));
    let own = library.and_then(|path| path.parent().map(PathBuf::from));
    std::env::join_paths(own.into_iter().chain(std::env::split_paths(&known))).unwrap_or(known)
}
