//! The field side: opens the run, sends its mesh, waits for a question, answers.

use super::question::Question;
use crate::CouplingError;
use crate::meeting::{Line, Mailbox, Message, Place, RunRoot};
use crate::mesh::{MeshPart, OwnCells, mesh_header};
use amberfield_core::Vector3;
use amberfield_field::far::SmoothDensity;
use amberfield_wire::payloads::{FarAnswer, FarQuestion, SourceCloud};
use amberfield_wire::{Block64, Header, Layout, MessageKind, Section, Sections, WireError};
use std::mem::MaybeUninit;
use std::ops::Range;
use std::time::{Duration, Instant};

/// Time that a field process waits for the run's services.
pub(super) const OPENING: Duration = Duration::from_secs(30);

/// Time for which the last message stays where the DEM process can read it: with its sender it is gone.
const FAREWELL: Duration = Duration::from_millis(500);

/// Answer of a rank to the question for the far field.
#[derive(Clone, Copy, Debug)]
pub struct Reply<'a> {
    /// Potential at the rank's cell centres [V].
    pub potential: &'a [f64],
    /// E at the rank's cell centres [V/m].
    pub e: &'a [[f64; 3]],
    /// Iterations of the linear solver.
    pub iterations: u64,
    /// Final residual of the linear solver, relative.
    pub residual: f64,
    /// Time that the linear solver took [s].
    pub seconds: f64,
}

/// One rank of the field process.
#[derive(Debug)]
pub struct FieldSide {
    pub(super) line: Line,
    rank: u32,
    pub(super) ranks: u32,
    /// The rank's cells, once they were sent.
    pub(super) cells_of_rank: Option<OwnCells>,
    first_cell: usize,
    first_boundary: usize,
    pub(super) density: Option<(SourceCloud, SmoothDensity)>,
    pub(super) asked: Option<Message>,
    pub(super) cells: Vec<u64>,
    pub(super) charge: f64,
    pub(super) outside: u64,
    pub(super) positions: Vec<Vector3<f64>>,
}

impl FieldSide {
    /// Opens a run by its name; without one, the run that waits for a solver.
    ///
    /// # Errors
    /// No such run, no shared memory.
    pub fn open(run: &str, rank: u32, ranks: u32) -> Result<Self, CouplingError> {
        let deadline = Instant::now() + OPENING;
        let root = if run.is_empty() { RunRoot::open_waiting(deadline)? } else { RunRoot::open(run)? };
        let place = Place::open(root, rank, ranks, deadline)?;
        Ok(Self::new(Line::Memory(Box::new(place)), rank, ranks))
    }

    /// A rank on a machine that has not the run's memory: the program carries letters between it and a
    /// [`Proxy`](super::Proxy).
    ///
    /// # Errors
    /// A name that is none of a run.
    pub fn open_distant(run: &str, rank: u32, ranks: u32) -> Result<Self, CouplingError> {
        Ok(Self::new(Line::letters(run)?, rank, ranks))
    }

    fn new(line: Line, rank: u32, ranks: u32) -> Self {
        Self {
            line,
            rank,
            ranks,
            cells_of_rank: None,
            first_cell: 0,
            first_boundary: 0,
            density: None,
            asked: None,
            cells: Vec::new(),
            charge: 0.0,
            outside: 0,
            positions: Vec::new(),
        }
    }

    /// Name of the run; empty for a rank on another machine.
    #[must_use]
    pub fn run(&self) -> &str {
        match &self.line {
            Line::Memory(place) => place.name(),
            Line::Letters(_) => "",
        }
    }

    /// Letters of a rank on another machine; `None` for one that sees the run's memory.
    pub(super) fn mailbox(&mut self) -> Option<&mut Mailbox> {
        match &mut self.line {
            Line::Memory(_) => None,
            Line::Letters(mailbox) => Some(mailbox),
        }
    }

    /// Sends this rank's part of the mesh; `first_boundary` boundary faces belong to lower ranks.
    ///
    /// # Errors
    /// A mesh that makes no sense, a DEM process that is gone.
    pub fn send_mesh(&mut self, part: &MeshPart<'_>, first_boundary: usize) -> Result<(), CouplingError> {
        self.cells_of_rank = Some(OwnCells::new(part)?);
        self.first_cell = part.outline.first_cell as usize;
        self.first_boundary = first_boundary;
        let layout = part.layout(mesh_header(self.line.run(), self.rank, self.ranks));
        self.line.send(&layout, |payload| part.write(&layout, payload))
    }

    /// Waits for the next request; `None` when the run is over.
    ///
    /// # Errors
    /// A DEM process that is gone, a message that makes no sense.
    pub fn wait(&mut self) -> Result<Option<Question>, CouplingError> {
        self.asked = None;
        let message = match self.line.receive() {
            Ok(message) => message,
            Err(CouplingError::Ended { .. }) => return Ok(None),
            Err(error) => return Err(error),
        };
        let question = Question::read(message.header(), &message.sections()).map_err(of_dem)?;
        self.asked = Some(message);
        Ok(Some(question))
    }

    /// Boundary data of this rank's faces: potentials [V] or outward slopes [V/m].
    ///
    /// # Errors
    /// Fewer of them than this rank has faces.
    pub fn boundary(&self, faces: usize) -> Result<&[f64], CouplingError> {
        let all = self.section::<f64>(Section::Boundary)?;
        let last = self.first_boundary + faces;
        all.get(self.first_boundary..last).ok_or_else(|| {
            of_dem(WireError::Count { section: Section::Boundary, theirs: all.len(), ours: last })
        })
    }

    /// Potential at this rank's cell centres to start from [V]; `None`: from where the solver is.
    ///
    /// # Errors
    /// Fewer of them than there are cells.
    pub fn guess(&self) -> Result<Option<&[f64]>, CouplingError> {
        self.of_own_cells(Section::Guess)
    }

    /// Numbers by cell that are this rank's; `None` where the message has none.
    pub(super) fn of_own_cells(&self, section: Section) -> Result<Option<&[f64]>, CouplingError> {
        let Ok(all) = self.section::<f64>(section) else { return Ok(None) };
        let cells = self.places_of_cells();
        let ours = cells.end;
        let error = || of_dem(WireError::Count { section, theirs: all.len(), ours });
        all.get(cells).map(Some).ok_or_else(error)
    }

    /// Answers the question for the far field.
    ///
    /// # Errors
    /// A DEM process that is gone.
    pub fn reply(&mut self, reply: &Reply<'_>) -> Result<(), CouplingError> {
        let question = self.sections()?.one::<FarQuestion>(Section::FarQuestion).map_err(of_dem)?;
        let e = if question.wants_e == 0 { &[] } else { reply.e };
        let layout = Layout::new(self.header_of_answer(MessageKind::Fields)?)
            .with::<f64>(Section::Potential, reply.potential.len())
            .with::<[f64; 3]>(Section::Field, e.len())
            .with::<u64>(Section::Cells, self.cells.len())
            .with::<FarAnswer>(Section::FarAnswer, 1);
        let answer = FarAnswer {
            charge_c: self.charge,
            outside: self.outside,
            iterations: reply.iterations,
            residual: reply.residual,
            seconds: reply.seconds,
        };
        let cells = std::mem::take(&mut self.cells);
        let sent = self.answer(&layout, |payload| {
            layout.section_mut::<f64>(payload, Section::Potential)?.copy_from_slice(reply.potential);
            layout.section_mut::<[f64; 3]>(payload, Section::Field)?.copy_from_slice(e);
            layout.section_mut::<u64>(payload, Section::Cells)?.copy_from_slice(&cells);
            layout.section_mut::<FarAnswer>(payload, Section::FarAnswer)?.fill(answer);
            Ok(())
        });
        self.cells = cells;
        sent
    }

    /// The header of an answer to what was asked.
    pub(super) fn header_of_answer(&self, kind: MessageKind) -> Result<Header, CouplingError> {
        let solve = self.asked.as_ref().ok_or_else(no_request)?.header().solve;
        let header = Header::new(kind, self.line.run(), solve);
        Ok(Header { rank: self.rank, ranks: self.ranks, ..header })
    }

    /// Sends the answer to what was asked.
    pub(super) fn answer(
        &mut self,
        layout: &Layout,
        write: impl FnOnce(&mut [MaybeUninit<Block64>]) -> Result<(), WireError>,
    ) -> Result<(), CouplingError> {
        self.line.send(layout, write)?;
        self.asked = None;
        Ok(())
    }

    /// Number of the solve that is asked for; 0 when nothing is.
    #[must_use]
    pub fn solve(&self) -> u64 {
        self.asked.as_ref().map_or(0, |message| message.header().solve)
    }

    /// Number of this rank.
    pub(super) fn rank(&self) -> u32 {
        self.rank
    }

    /// Numbers of this rank's cells among all.
    pub(super) fn own_cells(&self) -> Range<usize> {
        let count = self.cells_of_rank.as_ref().map_or(0, |own| own.centres.len());
        self.first_cell..self.first_cell + count
    }

    /// Places of this rank's cells in arrays by cell: a letter has its own alone.
    pub(super) fn places_of_cells(&self) -> Range<usize> {
        let cells = self.own_cells();
        if self.line.has_all_ranks() { cells } else { 0..cells.len() }
    }

    /// Tells the DEM process why this one ends.
    pub fn fail(&mut self, reason: &str) {
        self.leave(MessageKind::End, reason);
    }

    /// Tells the DEM process what is wrong with the case or the scene, so that this one ends.
    pub fn refuse(&mut self, reason: &str) {
        self.leave(MessageKind::Refusal, reason);
    }

    fn leave(&mut self, kind: MessageKind, reason: &str) {
        let header = Header::new(kind, self.line.run(), 0);
        let header = Header { rank: self.rank, ranks: self.ranks, ..header };
        // Whoever is not there to hear it needs no reason.
        if self.line.end(header, reason) {
            std::thread::sleep(FAREWELL);
        }
    }

    /// A section of what was asked.
    pub(super) fn section<T: amberfield_wire::Element>(
        &self,
        section: Section,
    ) -> Result<&[T], CouplingError> {
        self.sections()?.get(section).map_err(of_dem)
    }

    /// All sections of what was asked.
    pub(super) fn sections(&self) -> Result<Sections<'_>, CouplingError> {
        Ok(self.asked.as_ref().ok_or_else(no_request)?.sections())
    }
}

/// Error about a message of the DEM process.
pub(super) fn of_dem(error: WireError) -> CouplingError {
    CouplingError::Wire { peer: "DEM process", error }
}

pub(super) fn no_request() -> CouplingError {
    CouplingError::SharedMemory("no request has been received".into())
}

pub(super) fn no_mesh() -> CouplingError {
    CouplingError::SharedMemory("the mesh has not been sent".into())
}
