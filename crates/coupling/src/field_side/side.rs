//! The field side: opens the run, sends its mesh, waits for a question, answers.

use crate::CouplingError;
use crate::meeting::RunRoot;
use crate::meeting::{Link, Message, SideOf};
use crate::mesh::{MeshPart, mesh_header, own_cells};
use amberfield_core::Vector3;
use amberfield_field::far::{FarMesh, SmoothDensity};
use amberfield_wire::payloads::{FarAnswer, FarQuestion, FlowQuestion, SourceCloud, check_far_question};
use amberfield_wire::{Block64, Header, Layout, MessageKind, Section, Sections, WireError};
use std::mem::MaybeUninit;
use std::ops::Range;
use std::time::{Duration, Instant};

/// How long a field process waits for the run's services, and looks for the DEM process between messages.
const OPENING: Duration = Duration::from_secs(30);

/// Question of the DEM process.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Question {
    /// The far field.
    Far(FarQuestion),
    /// The flow at the end of an interval.
    Flow(FlowQuestion),
    /// The state of the flow, for a checkpoint.
    State,
    /// To take in a state of the flow.
    Restore,
}

impl Question {
    /// Reads the question that a message asks.
    ///
    /// # Errors
    /// A message that asks nothing, numbers that are missing or cannot be used.
    pub fn read(header: &Header, sections: &Sections<'_>) -> Result<Self, WireError> {
        let is = |kind: MessageKind| header.kind == kind as u32;
        if is(MessageKind::Charges) {
            let question = sections.one::<FarQuestion>(Section::FarQuestion)?;
            check_far_question(question)?;
            Ok(Self::Far(*question))
        } else if is(MessageKind::Grains) {
            let question = sections.one::<FlowQuestion>(Section::FlowQuestion)?;
            question.check()?;
            Ok(Self::Flow(*question))
        } else if is(MessageKind::Checkpoint) {
            Ok(Self::State)
        } else if is(MessageKind::Restore) {
            Ok(Self::Restore)
        } else {
            let Header { kind, solve, rank, ranks, .. } = *header;
            Err(WireError::Unexpected { kind, solve, rank, ranks })
        }
    }
}

/// What a rank answers.
#[derive(Clone, Copy, Debug)]
pub struct Reply<'a> {
    /// Potential at the rank's cell centres [V].
    pub potential: &'a [f64],
    /// E there [V/m].
    pub e: &'a [[f64; 3]],
    /// Iterations of the linear solver.
    pub iterations: u64,
    /// Its final residual, relative.
    pub residual: f64,
    /// Time that it took [s].
    pub seconds: f64,
}

/// One rank of the field process.
#[derive(Debug)]
pub struct FieldSide {
    link: Link,
    rank: u32,
    ranks: u32,
    /// The rank's cells, for mapping, once they were sent.
    mesh: Option<FarMesh>,
    first_cell: usize,
    first_boundary: usize,
    density: Option<(SourceCloud, SmoothDensity)>,
    asked: Option<Message>,
    cells: Vec<u64>,
    last_cells: Vec<u32>,
    charge: f64,
    outside: u64,
    positions: Vec<Vector3<f64>>,
    // Dropped after the link.
    root: RunRoot,
}

impl FieldSide {
    /// Opens a run by its name; without one, the run that waits for a solver.
    ///
    /// # Errors
    /// No such run, no shared memory.
    pub fn open(run: &str, rank: u32, ranks: u32) -> Result<Self, CouplingError> {
        let deadline = Instant::now() + OPENING;
        let root = if run.is_empty() { RunRoot::open_waiting(deadline)? } else { RunRoot::open(run)? };
        root.check_version().map_err(of_dem)?;
        let link = Link::new(&root, SideOf::Field { rank }, ranks, deadline)?;
        Ok(Self {
            link,
            rank,
            ranks,
            mesh: None,
            first_cell: 0,
            first_boundary: 0,
            density: None,
            asked: None,
            cells: Vec::new(),
            last_cells: Vec::new(),
            charge: 0.0,
            outside: 0,
            positions: Vec::new(),
            root,
        })
    }

    /// Sends this rank's part of the mesh; `first_boundary` boundary faces belong to lower ranks.
    ///
    /// # Errors
    /// A mesh that makes no sense, a DEM process that is gone.
    pub fn send_mesh(&mut self, part: &MeshPart<'_>, first_boundary: usize) -> Result<(), CouplingError> {
        self.mesh = Some(own_cells(part)?);
        self.first_cell = part.outline.first_cell as usize;
        self.first_boundary = first_boundary;
        let layout = part.layout(mesh_header(self.link.run(), self.rank, self.ranks));
        self.link.send(&layout, 1, |payload| part.write(&layout, payload))
    }

    /// Waits for the next request; `None` when the run is over.
    ///
    /// # Errors
    /// A DEM process that is gone, a message that makes no sense.
    pub fn wait(&mut self) -> Result<Option<Question>, CouplingError> {
        self.asked = None;
        let message = match self.link.receive(0, Duration::MAX, || self.link.dem_is_alive()) {
            Ok(message) => message,
            Err(CouplingError::Ended { .. }) => return Ok(None),
            Err(error) => {
                if matches!(error, CouplingError::Lost { .. }) {
                    self.root.inherit();
                }
                return Err(error);
            }
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
        let Ok(all) = self.section::<f64>(Section::Guess) else { return Ok(None) };
        let cells = self.own_cells();
        let ours = cells.end;
        let error = || of_dem(WireError::Count { section: Section::Guess, theirs: all.len(), ours });
        all.get(cells).map(Some).ok_or_else(error)
    }

    /// Density [C/m³] at this rank's cell centres of what was asked for; of charges that are spread over their cells, each one's cell.
    ///
    /// # Errors
    /// Charges that are not finite.
    pub fn density(&mut self, density: &mut [f64]) -> Result<(), CouplingError> {
        let cloud = self.sections()?.one::<FarQuestion>(Section::FarQuestion).map_err(of_dem)?.cloud;
        self.check_charges()?;
        if cloud.is_nearest_cell() {
            return self.map(density);
        }
        // Clouds belong to no cell, and the DEM side knows where its grains are.
        self.cells.clear();
        (self.charge, self.outside) = (0.0, 0);
        let mesh = self.mesh.as_ref().ok_or_else(no_mesh)?;
        if self.density.as_ref().is_none_or(|(known, _)| *known != cloud) {
            let centres = mesh.centres();
            let first = centres.first().copied().unwrap_or_default();
            let low = centres.iter().fold(first, |low, centre| low.inf(centre));
            let high = centres.iter().fold(first, |high, centre| high.sup(centre));
            // The box of a rank that has all cells along an axis is the mesh's, whose period counts.
            let reach = Vector3::repeat(0.5 * mesh.largest_cell());
            let whole = mesh.domain();
            let (low, high) = ((low - reach).sup(&whole.min()), (high + reach).inf(&whole.max()));
            self.density = Some((cloud, SmoothDensity::new(whole, low, high, cloud.radius_m, cloud.shape)));
        }
        let message = self.asked.as_ref().ok_or_else(no_request)?;
        let sections = message.sections();
        let (_, smooth) = self.density.as_mut().expect("just made");
        smooth.clear();
        for (places, charges) in
            [(Section::Positions, Section::Charges), (Section::ImagePositions, Section::ImageCharges)]
        {
            let places = sections.get::<[f64; 3]>(places).map_err(of_dem)?;
            let charges = sections.exactly::<f64>(charges, places.len()).map_err(of_dem)?;
            self.positions.clear();
            self.positions.extend(places.iter().map(|&place| Vector3::from(place)));
            smooth.add(&self.positions, charges);
        }
        smooth.at(mesh.centres(), density);
        Ok(())
    }

    /// Refuses charges and places that are no numbers.
    fn check_charges(&self) -> Result<(), CouplingError> {
        for (places, charges) in
            [(Section::Positions, Section::Charges), (Section::ImagePositions, Section::ImageCharges)]
        {
            let places = self.section::<[f64; 3]>(places)?;
            let charges = self.section::<f64>(charges)?;
            let is_number = |(place, charge): (&[f64; 3], &f64)| {
                charge.is_finite() && place.iter().all(|x| x.is_finite())
            };
            if let Some(index) = places.iter().zip(charges).position(|pair| !is_number(pair)) {
                return Err(CouplingError::Mesh(amberfield_field::FieldError::NotFinite { index }));
            }
        }
        Ok(())
    }

    /// Finds each charge's cell and adds up the cells' charge over their volumes.
    fn map(&mut self, density: &mut [f64]) -> Result<(), CouplingError> {
        let message = self.asked.as_ref().ok_or_else(no_request)?;
        let mesh = self.mesh.as_ref().ok_or_else(no_mesh)?;
        let sections = message.sections();
        let places = sections.get::<[f64; 3]>(Section::Positions).map_err(of_dem)?;
        let charges = sections.exactly::<f64>(Section::Charges, places.len()).map_err(of_dem)?;
        self.cells.resize(places.len(), u64::MAX);
        self.last_cells.resize(places.len(), u32::MAX);
        (self.charge, self.outside) = (0.0, 0);
        density.fill(0.0);
        for (index, (place, &charge)) in places.iter().zip(charges).enumerate() {
            let place = Vector3::from(*place);
            let last = (self.last_cells[index] != u32::MAX).then_some(self.last_cells[index]);
            let (cell, inside) = mesh.locate(&place, last);
            self.last_cells[index] = cell;
            // Strays belong to the nearest wall's cell; with several ranks they are the DEM side's to place.
            let mine = inside || self.ranks == 1;
            self.cells[index] = if mine { u64::from(cell) } else { u64::MAX };
            self.outside += u64::from(!inside && self.ranks == 1);
            if mine {
                self.charge += charge;
                density[cell as usize] += charge;
            }
        }
        for (density, volume) in density.iter_mut().zip(mesh.volumes()) {
            *density /= volume;
        }
        Ok(())
    }

    /// Answers what was asked.
    ///
    /// # Errors
    /// A DEM process that is gone.
    pub fn reply(&mut self, reply: &Reply<'_>) -> Result<(), CouplingError> {
        let layout = Layout::new(self.header_of_answer(MessageKind::Fields)?)
            .with::<f64>(Section::Potential, reply.potential.len())
            .with::<[f64; 3]>(Section::Field, reply.e.len())
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
            layout.section_mut::<[f64; 3]>(payload, Section::Field)?.copy_from_slice(reply.e);
            layout.section_mut::<u64>(payload, Section::Cells)?.copy_from_slice(&cells);
            layout.section_mut::<FarAnswer>(payload, Section::FarAnswer)?.fill(answer);
            Ok(())
        });
        self.cells = cells;
        sent
    }

    /// The header of an answer to what was asked.
    pub(crate) fn header_of_answer(&self, kind: MessageKind) -> Result<Header, CouplingError> {
        let solve = self.asked.as_ref().ok_or_else(no_request)?.header().solve;
        let header = Header::new(kind, self.link.run(), solve);
        Ok(Header { rank: self.rank, ranks: self.ranks, ..header })
    }

    /// Sends the answer to what was asked.
    pub(crate) fn answer(
        &mut self,
        layout: &Layout,
        write: impl FnOnce(&mut [MaybeUninit<Block64>]) -> Result<(), WireError>,
    ) -> Result<(), CouplingError> {
        self.link.send(layout, 1, write)?;
        self.asked = None;
        Ok(())
    }

    /// Number of the solve that is asked for; 0 when nothing is.
    #[must_use]
    pub fn solve(&self) -> u64 {
        self.asked.as_ref().map_or(0, |message| message.header().solve)
    }

    /// This rank's number.
    pub(crate) fn rank(&self) -> u32 {
        self.rank
    }

    /// This rank's cells among all.
    pub(crate) fn own_cells(&self) -> Range<usize> {
        self.first_cell..self.first_cell + self.mesh.as_ref().map_or(0, FarMesh::cell_count)
    }

    /// Tells the DEM process why this one ends.
    pub fn fail(&mut self, reason: &str) {
        let header = Header::new(MessageKind::End, self.link.run(), 0);
        let header = Header { rank: self.rank, ranks: self.ranks, ..header };
        // Whoever is not there to hear it needs no reason.
        let _ = self.link.end(header, 1, reason);
    }

    /// A section of what was asked.
    pub(crate) fn section<T: amberfield_wire::Element>(
        &self,
        section: Section,
    ) -> Result<&[T], CouplingError> {
        self.sections()?.get(section).map_err(of_dem)
    }

    /// All sections of what was asked.
    pub(crate) fn sections(&self) -> Result<Sections<'_>, CouplingError> {
        Ok(self.asked.as_ref().ok_or_else(no_request)?.sections())
    }
}

/// What is wrong with a message of the DEM process.
pub(crate) fn of_dem(error: WireError) -> CouplingError {
    CouplingError::Wire { peer: "DEM process", error }
}

fn no_request() -> CouplingError {
    CouplingError::SharedMemory("no request has been received".into())
}

fn no_mesh() -> CouplingError {
    CouplingError::SharedMemory("the mesh has not been sent".into())
}
