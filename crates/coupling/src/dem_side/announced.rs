//! A run whose field solver has not come yet.

use super::far::RemoteSolver;
use super::launch::{Process, RUN, program_name};
use super::remote::{Remote, alive, check_sender, of_solver};
use super::settings::SolverSettings;
use crate::CouplingError;
use crate::meeting::{Link, Message, RunRoot, SideOf};
use crate::mesh::{MeshPart, assemble, shapes_of};
use amberfield_gas::CellShapes;
use amberfield_wire::MessageKind;
use std::sync::Arc;
use std::time::Instant;

/// A run whose solver has not come yet.
#[derive(Debug)]
pub struct Announced {
    settings: SolverSettings,
    deadline: Instant,
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
        let deadline = Instant::now() + settings.timeout;
        let link = Link::new(&root, SideOf::Dem, settings.ranks, deadline)?;
        Ok(Self { settings, deadline, link, root })
    }

    /// Name of the run, which the solver is told.
    #[must_use]
    pub fn run(&self) -> &str {
        self.root.name()
    }

    /// Starts the solver (or waits for somebody to) and takes in its mesh.
    ///
    /// # Errors
    /// No solver, no answer in time, a mesh that makes no sense.
    pub fn connect(self) -> Result<RemoteSolver, CouplingError> {
        let Self { settings, deadline, link, root } = self;
        let mut process = if settings.start {
            Some(Process::start(&settings, root.name())?)
        } else {
            let (case, run) = (settings.case.display(), root.name());
            root.invite(true);
            match &settings.application {
                None => {
                    tracing::info!("waiting for `{} -case {case} -run {run}`", program_name(settings.flow))
                }
                Some(program) => tracing::info!("waiting for `{RUN}={run} {program} -case {case}`"),
            }
            None
        };
        let mut messages: Vec<Option<Message>> = (0..settings.ranks).map(|_| None).collect();
        while messages.iter().any(Option::is_none) {
            let left = deadline.saturating_duration_since(Instant::now());
            let received = link.receive(0, left, || alive(&mut process));
            // Who ends before its mesh is there cannot use the case.
            let message = received.map_err(|error| match error {
                CouplingError::Ended { reason, .. } => CouplingError::Refused(reason),
                error => error,
            })?;
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
