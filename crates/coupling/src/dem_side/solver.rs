//! The DEM side: owns the run, starts the field process, asks it for fields.

use super::flow::RemoteFlow;
use super::launch::{Process, RUN, program_name};
use super::remote::{Remote, alive, check_sender, of_solver};
use crate::CouplingError;
use crate::meeting::RunRoot;
use crate::meeting::{Link, Message, SideOf};
use crate::mesh::{MeshPart, assemble};
use amberfield_core::Vector3;
use amberfield_field::FieldError;
use amberfield_field::far::{FarField, FarMesh, FarRequest, FarSource, FarValues};
use amberfield_gas::FlowValues;
use amberfield_wire::payloads::{FarAnswer, FarQuestion, FlowQuestion, SourceCloud};
use amberfield_wire::{Layout, MessageKind, Section, Sections, WireError};
use std::ops::Range;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// What a scene says of its field solver.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverSettings {
    /// Folder of the case.
    pub case: PathBuf,
    /// Another program than ours, inside which our function object runs.
    pub application: Option<String>,
    /// Whether the flow of a gas is computed too: by `amberPimpleFoam` instead of `electricFieldFoam`.
    pub flow: bool,
    /// Whether this program starts the solver, or somebody else does.
    pub start: bool,
    /// Processes of the solver.
    pub ranks: u32,
    /// How long an answer may take.
    pub timeout: Duration,
    /// Relative tolerance of the linear solver.
    pub far_tolerance: f64,
    /// Where what the solver prints goes; nowhere without.
    pub log: Option<PathBuf>,
}

/// What is being solved while the grains move on.
#[derive(Debug)]
pub(crate) struct Pending<Asked, Answer> {
    /// What must be known of the question that is open.
    pub(crate) asked: Option<Asked>,
    /// Its answer, if somebody else's question came after it.
    pub(crate) answer: Option<Answer>,
}

impl<Asked, Answer> Pending<Asked, Answer> {
    /// Nothing is asked, nothing came.
    pub(crate) const NOTHING: Self = Self { asked: None, answer: None };
}

/// The far field of another process.
#[derive(Debug)]
pub struct RemoteSolver {
    mesh: Arc<FarMesh>,
    shared: Arc<Mutex<Shared>>,
}

/// A process that solves for more than one thing.
#[derive(Debug)]
pub(crate) struct Shared {
    pub(crate) remote: Remote,
    /// Charges that were asked for.
    far: Pending<usize, FarValues>,
    pub(crate) flow: Pending<FlowQuestion, FlowValues>,
}

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

    /// The run's name, which the solver is told.
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
            let message = link.receive(0, left, || alive(&mut process))?;
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
        let remote = Remote::new(settings, &cells, (link, process, root));
        let shared = Arc::new(Mutex::new(Shared { remote, far: Pending::NOTHING, flow: Pending::NOTHING }));
        Ok(RemoteSolver { mesh, shared })
    }
}

impl RemoteSolver {
    /// The flow of the same process.
    #[must_use]
    pub fn flow(&self) -> RemoteFlow {
        RemoteFlow::new(Arc::clone(&self.mesh), Arc::clone(&self.shared))
    }

    /// Asks for the far field and waits for the answer.
    pub(crate) fn ask_for(
        &mut self,
        request: &FarRequest<'_>,
        values: &mut FarValues,
    ) -> Result<(), CouplingError> {
        let mut shared = locked(&self.shared);
        shared.send(request)?;
        shared.take(values)
    }
}

impl Shared {
    /// Asks for the far field without waiting.
    fn send(&mut self, request: &FarRequest<'_>) -> Result<(), CouplingError> {
        self.clear_the_way()?;
        let question = FarQuestion {
            cloud: match request.source {
                FarSource::Clouds { radius_m, shape } => SourceCloud { radius_m, shape },
                FarSource::NearestCell => SourceCloud::nearest_cell(),
            },
            permittivity_f_m: request.permittivity,
            neutralising_background: u64::from(request.neutralising_background),
            time_s: request.time_s,
            tolerance: self.remote.settings.far_tolerance,
        };
        let layout = |layout: Layout| {
            let layout = layout
                .with::<FarQuestion>(Section::FarQuestion, 1)
                .with::<[f64; 3]>(Section::Positions, request.positions.len())
                .with::<f64>(Section::Charges, request.charges.len())
                .with::<[f64; 3]>(Section::ImagePositions, request.image_positions.len())
                .with::<f64>(Section::ImageCharges, request.image_charges.len())
                .with::<f64>(Section::Boundary, request.boundary.len());
            match request.guess.len() {
                0 => layout,
                cells => layout.with::<f64>(Section::Guess, cells),
            }
        };
        self.remote.ask(MessageKind::Charges, layout, |layout, payload| {
            layout.section_mut::<FarQuestion>(payload, Section::FarQuestion)?.fill(question);
            write_vectors(layout.section_mut(payload, Section::Positions)?, request.positions);
            layout.section_mut::<f64>(payload, Section::Charges)?.copy_from_slice(request.charges);
            write_vectors(layout.section_mut(payload, Section::ImagePositions)?, request.image_positions);
            layout.section_mut::<f64>(payload, Section::ImageCharges)?.copy_from_slice(request.image_charges);
            layout.section_mut::<f64>(payload, Section::Boundary)?.copy_from_slice(request.boundary);
            if !request.guess.is_empty() {
                layout.section_mut::<f64>(payload, Section::Guess)?.copy_from_slice(request.guess);
            }
            Ok(())
        })?;
        self.far.asked = Some(request.positions.len());
        Ok(())
    }

    /// Waits for the answer to what was asked last.
    fn take(&mut self, values: &mut FarValues) -> Result<(), CouplingError> {
        if let Some(answer) = self.far.answer.take() {
            *values = answer;
            return Ok(());
        }
        let charges = self.far.asked.take().unwrap_or(0);
        let count = self.remote.cell_count();
        values.potential.resize(count, 0.0);
        values.e.resize(count, Vector3::zeros());
        values.cells.clear();
        values.cells.resize(charges, u32::MAX);
        (values.outside, values.iterations, values.residual, values.seconds) = (0, 0, 0.0, 0.0);
        self.remote.collect(MessageKind::Fields, |cells, _, sections| read(cells, sections, values))?;
        let outcome = sound(values);
        self.remote.noted(outcome)
    }

    /// Takes the answer to what is open, before somebody else asks: messages come in the order of their questions.
    pub(crate) fn clear_the_way(&mut self) -> Result<(), CouplingError> {
        if self.far.asked.is_some() {
            let mut values = FarValues::default();
            self.take(&mut values)?;
            self.far.answer = Some(values);
        }
        self.take_flow_early()
    }
}

/// Takes one rank's answer.
fn read(of_rank: Range<usize>, sections: &Sections<'_>, values: &mut FarValues) -> Result<(), WireError> {
    let (first, count) = (of_rank.start, of_rank.len());
    let potential = sections.exactly::<f64>(Section::Potential, count)?;
    let field = sections.exactly::<[f64; 3]>(Section::Field, count)?;
    // A solver that was not asked for the density has not looked for the charges' cells.
    let cells = match sections.get::<u64>(Section::Cells)? {
        [] => &[],
        _ => sections.exactly::<u64>(Section::Cells, values.cells.len())?,
    };
    let answer = sections.one::<FarAnswer>(Section::FarAnswer)?;
    values.potential[of_rank.clone()].copy_from_slice(potential);
    read_vectors(&mut values.e[of_rank], field);
    for (place, (known, &cell)) in values.cells.iter_mut().zip(cells).enumerate() {
        if cell == u64::MAX {
            continue;
        }
        if cell >= count as u64 {
            return Err(WireError::Index { section: Section::Cells, place, value: cell, count });
        }
        *known = first as u32 + cell as u32;
    }
    values.outside = values.outside.saturating_add(answer.outside);
    values.iterations = values.iterations.max(answer.iterations);
    values.residual = values.residual.max(answer.residual);
    values.seconds = values.seconds.max(answer.seconds);
    Ok(())
}

/// Refuses an answer that is no number somewhere.
fn sound(values: &FarValues) -> Result<(), CouplingError> {
    let sound = |(potential, e): (&f64, &Vector3<f64>)| (potential + e.sum()).is_finite();
    match values.potential.iter().zip(&values.e).position(|answer| !sound(answer)) {
        None => Ok(()),
        Some(cell) => Err(CouplingError::Mesh(FieldError::Solver(format!(
            "the field solver's answer in cell {cell} is {} V, {:?} V/m; look at its log",
            values.potential[cell],
            values.e[cell].as_slice()
        )))),
    }
}

impl FarField for RemoteSolver {
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn solve(&mut self, request: &FarRequest<'_>, values: &mut FarValues) -> Result<(), FieldError> {
        Ok(self.ask_for(request, values)?)
    }

    fn ask(&mut self, request: &FarRequest<'_>) -> Result<(), FieldError> {
        Ok(locked(&self.shared).send(request)?)
    }

    fn take(&mut self, values: &mut FarValues) -> Result<(), FieldError> {
        Ok(locked(&self.shared).take(values)?)
    }
}

/// What both handles share; a panic of one leaves nothing half done that the next exchange would not notice.
pub(crate) fn locked(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

pub(crate) fn write_vectors(into: &mut [[f64; 3]], from: &[Vector3<f64>]) {
    for (into, from) in into.iter_mut().zip(from) {
        *into = (*from).into();
    }
}

pub(crate) fn read_vectors(into: &mut [Vector3<f64>], from: &[[f64; 3]]) {
    for (into, from) in into.iter_mut().zip(from) {
        *into = Vector3::from(*from);
    }
}
