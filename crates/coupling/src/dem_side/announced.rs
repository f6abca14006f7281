//! A run whose field solver has not come yet.

use super::far::RemoteSolver;
use super::launch::{Process, RUN, program_name, solver_program};
use super::remote::{Remote, alive, check_sender, of_solver};
use super::settings::SolverSettings;
use super::surroundings::Surroundings;
use crate::CouplingError;
use crate::meeting::{Link, Message, RunRoot, SideOf};
use crate::mesh::{MeshPart, assemble, shapes_of};
use amberfield_gas::CellShapes;
use amberfield_wire::MessageKind;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Sign that the user asked to stop.
const STOPPED: &str = "stopped";

/// Time between two lines that say what a run waits for.
const LINE: Duration = Duration::from_secs(60);
/// Time for the run's own place in shared memory.
const TO_OPEN: Duration = Duration::from_secs(10);

/// A run whose solver has not come yet.
#[derive(Debug)]
pub struct Announced {
    settings: SolverSettings,
    link: Link,
    root: RunRoot,
}

impl Announced {
    /// Makes the run's place.
    ///
    /// # Errors
    /// No shared memory.
    pub fn new(settings: SolverSettings) -> Result<Self, CouplingError> {
        let root = RunRoot::create()?;
        let link = Link::new(&root, SideOf::Dem, settings.ranks, Instant::now() + TO_OPEN)?;
        Ok(Self { settings, link, root })
    }

    /// Name of the run, which the solver is told.
    #[must_use]
    pub fn run(&self) -> &str {
        self.root.name()
    }

    /// Starts the solver (or waits for somebody to) and takes in its mesh.
    ///
    /// # Errors
    /// No solver, no answer in time, a mesh that makes no sense, a user who stops.
    pub fn connect(self) -> Result<RemoteSolver, CouplingError> {
        let Self { settings, link, root } = self;
        let mut process = match &settings.workplace {
            Some(workplace) => Some(Process::start(&settings, workplace, root.name())?),
            None => {
                root.invite(true);
                tracing::info!("waiting for {}", to_type(&settings, root.name()));
                None
            }
        };
        let most = if process.is_some() { Some(settings.patience(0)) } else { settings.wait };
        let mut messages: Vec<Option<Message>> = (0..settings.ranks).map(|_| None).collect();
        let begun = Instant::now();
        while messages.iter().any(Option::is_none) {
            let left = most.map_or(LINE, |most| most.saturating_sub(begun.elapsed()).min(LINE));
            let received = link.receive(0, left, || {
                if (settings.stop)() { Err(STOPPED.to_owned()) } else { alive(&mut process) }
            });
            let message = match received {
                Ok(message) => message,
                Err(CouplingError::TimedOut { .. }) if most.is_none_or(|most| begun.elapsed() < most) => {
                    let what = match process {
                        Some(_) => "the field solver to read its case".to_owned(),
                        None => to_type(&settings, root.name()),
                    };
                    tracing::info!("still waiting for {what}");
                    continue;
                }
                Err(CouplingError::TimedOut { .. }) if process.is_none() => {
                    let advice = to_type(&settings, root.name());
                    return Err(CouplingError::NobodyCame { waited: begun.elapsed(), advice });
                }
                Err(CouplingError::Lost { how, .. }) if how == STOPPED => {
                    return Err(CouplingError::Stopped("no field solver had come".to_owned()));
                }
                Err(CouplingError::Lost { peer, how, solve }) => {
                    let program = solver_program(settings.flow);
                    let wrong = Surroundings::of(&program).wrong;
                    let how = std::iter::once(how).chain(wrong).collect::<Vec<_>>().join("; ");
                    return Err(CouplingError::Lost { peer, how, solve });
                }
                // Who ends before its mesh is there cannot use the case.
                Err(CouplingError::Ended { reason, .. }) => return Err(CouplingError::Refused(reason)),
                Err(error) => return Err(error),
            };
            check_sender(message.header(), settings.ranks, MessageKind::Mesh, 0).map_err(of_solver)?;
            let rank = message.header().rank as usize;
            messages[rank] = Some(message);
        }
        root.invite(false);
        let parts: Result<Vec<_>, _> =
            messages.iter().flatten().map(|message| MeshPart::read(&message.sections())).collect();
        let parts = parts.map_err(of_solver)?;
        let cells: Vec<usize> = parts.iter().map(|part| part.centres.len()).collect();
        let mesh = Arc::new(assemble(&parts)?);
        let shapes = if settings.flow { shapes_of(&mesh, &parts)? } else { CellShapes::default() };
        let remote = Remote::new(settings, &cells, (link, process, root));
        Ok(RemoteSolver::new(mesh, Arc::new(shapes), remote))
    }
}

/// Command that starts the solver of a run by hand.
fn to_type(settings: &SolverSettings, run: &str) -> String {
    let SolverSettings { case, application, ranks, hosts, flow, .. } = settings;
    let case = std::path::absolute(case).unwrap_or_else(|_| case.clone());
    let case = shell(&case.to_string_lossy());
    let parallel = *ranks > 1;
    let hosts = hosts.as_ref().map_or_else(String::new, |file| {
        let file = std::path::absolute(file).unwrap_or_else(|_| file.clone());
        format!("--hostfile {} ", shell(&file.to_string_lossy()))
    });
    let mpi = if parallel { format!("mpirun -np {ranks} {hosts}") } else { String::new() };
    let flag = if parallel { " -parallel" } else { "" };
    match application {
        None => format!("`{mpi}{}{flag} -case {case} -run {run}`", program_name(*flow)),
        Some(program) => format!("`{RUN}={run} {mpi}{program}{flag} -case {case}`"),
    }
}

/// A path as a shell takes it.
fn shell(path: &str) -> String {
    let is_plain = path.chars().all(|c| c.is_alphanumeric() || "/._-+".contains(c));
    if is_plain { path.to_owned() } else { format!("'{}'", path.replace('\'', "'\\''")) }
}
