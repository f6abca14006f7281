//! The DEM side: owns the run, starts the field process, asks it for fields.

use crate::CouplingError;
use crate::launch::{Process, RUN};
use crate::link::{Link, Message, SideOf};
use crate::mesh_message::{MeshPart, assemble};
use crate::run_root::RunRoot;
use amberfield_core::Vector3;
use amberfield_field::FieldError;
use amberfield_field::far::{FarField, FarMesh, FarRequest, FarSource, FarValues};
use amberfield_wire::{Header, Layout, MessageKind, Section, WireError};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// What a scene says of its field solver.
#[derive(Clone, Debug, PartialEq)]
pub struct SolverSettings {
    /// Folder of the case.
    pub case: PathBuf,
    /// Another program than `electricFieldFoam`, inside which our function object runs.
    pub application: Option<String>,
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

/// The far field of another process.
#[derive(Debug)]
pub struct RemoteSolver {
    settings: SolverSettings,
    mesh: FarMesh,
    /// Cells of each rank.
    cells: Vec<usize>,
    /// Number of the last solve, and its charges.
    solve: u64,
    charges: usize,
    /// Whether the last solve was answered.
    healthy: bool,
    // Dropped in this order: the link says goodbye, the process ends, the run's place goes.
    link: Link,
    process: Option<Process>,
    _root: RunRoot,
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
                None => tracing::info!("waiting for `electricFieldFoam -case {case} -run {run}`"),
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
        let cells = parts.iter().map(|part| part.centres.len()).collect();
        let mesh = assemble(&parts)?;
        Ok(RemoteSolver {
            settings,
            mesh,
            cells,
            solve: 0,
            charges: 0,
            healthy: true,
            link,
            process,
            _root: root,
        })
    }
}

impl RemoteSolver {
    /// Asks for the far field and waits for the answer.
    pub(crate) fn ask_for(
        &mut self,
        request: &FarRequest<'_>,
        values: &mut FarValues,
    ) -> Result<(), CouplingError> {
        let outcome = self.send(request).and_then(|()| self.collect(values));
        self.noted(outcome)
    }

    fn write(&mut self, request: &FarRequest<'_>) -> Result<(), CouplingError> {
        let (radius, shape) = match request.source {
            FarSource::Clouds { radius_m, shape } => (radius_m, shape),
            FarSource::NearestCell => (0.0, 0.0),
        };
        let background = f64::from(u8::from(request.neutralising_background));
        let numbers =
            [request.permittivity, radius, shape, self.settings.far_tolerance, background, request.time_s];
        let header = Header::new(MessageKind::Charges, self.link.run(), self.solve);
        let layout = Layout::new(header)
            .with::<f64>(Section::Request, numbers.len())
            .with::<[f64; 3]>(Section::Positions, request.positions.len())
            .with::<f64>(Section::Charges, request.charges.len())
            .with::<[f64; 3]>(Section::ImagePositions, request.image_positions.len())
            .with::<f64>(Section::ImageCharges, request.image_charges.len())
            .with::<f64>(Section::Boundary, request.boundary.len());
        let layout = match request.guess.len() {
            0 => layout,
            cells => layout.with::<f64>(Section::Guess, cells),
        };
        self.link.send(&layout, self.settings.ranks as usize, |payload| {
            layout.section_mut::<f64>(payload, Section::Request)?.copy_from_slice(&numbers);
            let places = layout.section_mut::<[f64; 3]>(payload, Section::Positions)?;
            write_vectors(places, request.positions);
            layout.section_mut::<f64>(payload, Section::Charges)?.copy_from_slice(request.charges);
            let places = layout.section_mut::<[f64; 3]>(payload, Section::ImagePositions)?;
            write_vectors(places, request.image_positions);
            layout.section_mut::<f64>(payload, Section::ImageCharges)?.copy_from_slice(request.image_charges);
            layout.section_mut::<f64>(payload, Section::Boundary)?.copy_from_slice(request.boundary);
            if !request.guess.is_empty() {
                layout.section_mut::<f64>(payload, Section::Guess)?.copy_from_slice(request.guess);
            }
            Ok(())
        })
    }

    /// Takes one rank's answer.
    fn read(&self, message: &Message, values: &mut FarValues) -> Result<usize, WireError> {
        let ranks = self.settings.ranks;
        check_sender(message.header(), ranks, MessageKind::Fields, self.solve)?;
        let rank = message.header().rank as usize;
        let first: usize = self.cells[..rank].iter().sum();
        let count = self.cells[rank];
        let sections = message.sections();
        let potential = sections.exactly::<f64>(Section::Potential, count)?;
        let field = sections.exactly::<[f64; 3]>(Section::Field, count)?;
        // A solver that was not asked for the density has not looked for the charges' cells.
        let cells = match sections.get::<u64>(Section::Cells)? {
            [] => &[],
            _ => sections.exactly::<u64>(Section::Cells, values.cells.len())?,
        };
        let answer = sections.exactly::<f64>(Section::Answer, 5)?;
        values.potential[first..first + count].copy_from_slice(potential);
        for (e, field) in values.e[first..].iter_mut().zip(field) {
            *e = Vector3::from(*field);
        }
        for (place, (known, &cell)) in values.cells.iter_mut().zip(cells).enumerate() {
            if cell == u64::MAX {
                continue;
            }
            if cell >= count as u64 {
                return Err(WireError::Index { section: Section::Cells, place, value: cell, count });
            }
            *known = first as u32 + cell as u32;
        }
        values.outside += answer[1] as u64;
        values.iterations = values.iterations.max(answer[2] as u64);
        values.residual = values.residual.max(answer[3]);
        values.seconds = values.seconds.max(answer[4]);
        Ok(rank)
    }

    /// Asks without waiting.
    fn send(&mut self, request: &FarRequest<'_>) -> Result<(), CouplingError> {
        self.solve += 1;
        self.charges = request.positions.len();
        self.write(request)
    }

    /// Waits for every rank's answer to what was asked last.
    fn collect(&mut self, values: &mut FarValues) -> Result<(), CouplingError> {
        let count = self.mesh.cell_count();
        values.potential.resize(count, 0.0);
        values.e.resize(count, Vector3::zeros());
        values.cells.clear();
        values.cells.resize(self.charges, u32::MAX);
        (values.outside, values.iterations, values.residual, values.seconds) = (0, 0, 0.0, 0.0);
        let mut missing = self.settings.ranks;
        let mut seen = vec![false; missing as usize];
        while missing > 0 {
            let process = &mut self.process;
            let message = self.link.receive(self.solve, self.settings.timeout, || alive(process))?;
            let rank = self.read(&message, values).map_err(of_solver)?;
            missing -= u32::from(!std::mem::replace(&mut seen[rank], true));
        }
        let sound = |(potential, e): (&f64, &Vector3<f64>)| (potential + e.sum()).is_finite();
        if let Some(cell) = values.potential.iter().zip(&values.e).position(|answer| !sound(answer)) {
            return Err(CouplingError::Mesh(FieldError::Solver(format!(
                "the field solver's answer in cell {cell} is {} V, {:?} V/m; look at its log",
                values.potential[cell],
                values.e[cell].as_slice()
            ))));
        }
        Ok(())
    }

    /// Whether an exchange went well decides how the solver is told goodbye.
    fn noted(&mut self, outcome: Result<(), CouplingError>) -> Result<(), CouplingError> {
        self.healthy = outcome.is_ok();
        outcome
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
        let outcome = self.send(request);
        Ok(self.noted(outcome)?)
    }

    fn take(&mut self, values: &mut FarValues) -> Result<(), FieldError> {
        let outcome = self.collect(values);
        Ok(self.noted(outcome)?)
    }
}

impl Drop for RemoteSolver {
    fn drop(&mut self) {
        let header = Header::new(MessageKind::End, self.link.run(), self.solve);
        let said = self.link.end(header, self.settings.ranks as usize, "the run is over");
        if let Some(process) = &mut self.process {
            process.end(said.is_ok() && self.healthy);
        }
    }
}

fn write_vectors(into: &mut [[f64; 3]], from: &[Vector3<f64>]) {
    for (into, from) in into.iter_mut().zip(from) {
        *into = (*from).into();
    }
}

fn alive(process: &mut Option<Process>) -> Result<(), String> {
    process.as_mut().map_or(Ok(()), Process::check)
}

fn of_solver(error: WireError) -> CouplingError {
    CouplingError::Wire { peer: "field solver", error }
}

/// Refuses a message of another kind, of another solve, or of a rank that there is not.
fn check_sender(header: &Header, ranks: u32, kind: MessageKind, solve: u64) -> Result<(), WireError> {
    let fits = header.kind == kind as u32 && header.solve == solve;
    if !fits || header.rank >= ranks || header.ranks != ranks {
        return Err(WireError::Unexpected {
            kind: header.kind,
            solve: header.solve,
            rank: header.rank,
            ranks: header.ranks,
        });
    }
    Ok(())
}
