//! The far field, solved for in another process.

use super::flow::RemoteFlow;
use super::remote::Remote;
use super::shared::{AskedFar, Pending, Shared, locked, read_vectors, write_vectors};
use crate::CouplingError;
use amberfield_core::Vector3;
use amberfield_field::FieldError;
use amberfield_field::far::{FarField, FarMesh, FarRequest, FarValues};
use amberfield_gas::CellShapes;
use amberfield_wire::payloads::{FarAnswer, FarQuestion};
use amberfield_wire::{Layout, MessageKind, Section, Sections, WireError};
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// The far field of another process.
#[derive(Debug)]
pub struct RemoteSolver {
    mesh: Arc<FarMesh>,
    /// Corners of its faces, where a gas flows.
    shapes: Arc<CellShapes>,
    pub(super) shared: Arc<Mutex<Shared>>,
    /// Cells of the charges that were asked about last, where each is spread over its cell.
    cells: Vec<u64>,
}

impl RemoteSolver {
    /// A process that has sent its mesh.
    pub(super) fn new(mesh: Arc<FarMesh>, shapes: Arc<CellShapes>, remote: Remote) -> Self {
        let shared = Shared { remote, far: Pending::NOTHING, flow: Pending::NOTHING };
        Self { mesh, shapes, shared: Arc::new(Mutex::new(shared)), cells: Vec::new() }
    }

    /// The flow of the same process.
    #[must_use]
    pub fn flow(&self) -> RemoteFlow {
        RemoteFlow::new(Arc::clone(&self.mesh), Arc::clone(&self.shapes), Arc::clone(&self.shared))
    }

    /// Asks for the far field and waits for the answer.
    pub(super) fn ask_for(
        &mut self,
        request: &FarRequest<'_>,
        values: &mut FarValues,
    ) -> Result<(), CouplingError> {
        self.find_cells(request);
        let mut shared = locked(&self.shared);
        shared.send_far(request, &self.cells)?;
        shared.take_far(values)
    }

    /// Finds the cells of charges that are spread over them. No rank could: a charge beside an edge of cells
    /// of several ranks would be in none of them or in two.
    fn find_cells(&mut self, request: &FarRequest<'_>) {
        if !request.question.cloud.is_nearest_cell() {
            self.cells.clear();
            return;
        }
        self.cells.resize(request.positions.len(), u64::MAX);
        for (cell, place) in self.cells.iter_mut().zip(request.positions) {
            *cell = u64::from(self.mesh.locate(place, u32::try_from(*cell).ok()).0);
        }
    }
}

impl Shared {
    /// Asks for the far field without waiting; `cells` are those of charges that are spread over them.
    fn send_far(&mut self, request: &FarRequest<'_>, cells: &[u64]) -> Result<(), CouplingError> {
        self.clear_the_way()?;
        let question = FarQuestion { tolerance: self.remote.settings.far_tolerance, ..request.question };
        let layout = |layout: Layout| {
            let layout = layout
                .with::<FarQuestion>(Section::FarQuestion, 1)
                .with::<[f64; 3]>(Section::Positions, request.positions.len())
                .with::<f64>(Section::Charges, request.charges.len())
                .with::<u64>(Section::Cells, cells.len())
                .with::<[f64; 3]>(Section::ImagePositions, request.image_positions.len())
                .with::<f64>(Section::ImageCharges, request.image_charges.len())
                .with::<f64>(Section::Boundary, request.boundary.len());
            let with_some = |layout: Layout, section, values: &[f64]| match values.len() {
                0 => layout,
                count => layout.with::<f64>(section, count),
            };
            let layout = with_some(layout, Section::SourceDensity, request.density);
            with_some(layout, Section::Guess, request.guess)
        };
        self.remote.ask(MessageKind::Charges, layout, |layout, payload| {
            layout.section_mut::<FarQuestion>(payload, Section::FarQuestion)?.fill(question);
            write_vectors(layout.section_mut(payload, Section::Positions)?, request.positions);
            layout.section_mut::<f64>(payload, Section::Charges)?.copy_from_slice(request.charges);
            layout.section_mut::<u64>(payload, Section::Cells)?.copy_from_slice(cells);
            write_vectors(layout.section_mut(payload, Section::ImagePositions)?, request.image_positions);
            layout.section_mut::<f64>(payload, Section::ImageCharges)?.copy_from_slice(request.image_charges);
            layout.section_mut::<f64>(payload, Section::Boundary)?.copy_from_slice(request.boundary);
            for (section, values) in
                [(Section::SourceDensity, request.density), (Section::Guess, request.guess)]
            {
                if !values.is_empty() {
                    layout.section_mut::<f64>(payload, section)?.copy_from_slice(values);
                }
            }
            Ok(())
        })?;
        self.far.asked = Some(AskedFar { charges: request.positions.len(), wants_e: question.wants_e != 0 });
        Ok(())
    }

    /// Waits for the answer to what was asked last.
    pub(super) fn take_far(&mut self, values: &mut FarValues) -> Result<(), CouplingError> {
        if let Some(answer) = self.far.answer.take() {
            *values = answer;
            return Ok(());
        }
        let asked = self.far.asked.take();
        let AskedFar { charges, wants_e } = asked.unwrap_or(AskedFar { charges: 0, wants_e: true });
        let count = self.remote.cell_count();
        values.potential.resize(count, 0.0);
        values.e.resize(if wants_e { count } else { 0 }, Vector3::zeros());
        values.cells.clear();
        values.cells.resize(charges, u32::MAX);
        (values.outside, values.iterations, values.residual, values.seconds) = (0, 0, 0.0, 0.0);
        self.remote.collect(MessageKind::Fields, |cells, _, sections| read(cells, sections, values))?;
        let outcome = sound(values).and_then(|()| converged(values, self.remote.settings.far_tolerance));
        self.remote.noted(outcome)
    }
}

/// Takes one rank's answer.
fn read(of_rank: Range<usize>, sections: &Sections<'_>, values: &mut FarValues) -> Result<(), WireError> {
    let (first, count) = (of_rank.start, of_rank.len());
    let potential = sections.exactly::<f64>(Section::Potential, count)?;
    let e_of_rank = if values.e.is_empty() { 0..0 } else { of_rank.clone() };
    let field = sections.exactly::<[f64; 3]>(Section::Field, e_of_rank.len())?;
    // A solver that was not asked for the density has not looked for the charges' cells.
    let cells = match sections.get::<u64>(Section::Cells)? {
        [] => &[],
        _ => sections.exactly::<u64>(Section::Cells, values.cells.len())?,
    };
    let answer = sections.one::<FarAnswer>(Section::FarAnswer)?;
    values.potential[of_rank].copy_from_slice(potential);
    read_vectors(&mut values.e[e_of_rank], field);
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
    let is_bad = |e: &Vector3<f64>| !e.sum().is_finite();
    let of_potential = values.potential.iter().position(|potential| !potential.is_finite());
    let Some(cell) = of_potential.or_else(|| values.e.iter().position(is_bad)) else { return Ok(()) };
    let e = values.e.get(cell).map_or_else(String::new, |e| format!(", {:?} V/m", e.as_slice()));
    Err(CouplingError::Mesh(FieldError::Solver(format!(
        "the field solver's answer in cell {cell} is {} V{e}; look at its log",
        values.potential[cell]
    ))))
}

/// Refuses an answer whose linear solver gave up.
fn converged(values: &FarValues, tolerance: f64) -> Result<(), CouplingError> {
    let FarValues { iterations, residual, .. } = *values;
    if residual <= tolerance {
        return Ok(());
    }
    Err(CouplingError::NotConverged { iterations, residual, tolerance })
}

impl FarField for RemoteSolver {
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn solve(&mut self, request: &FarRequest<'_>, values: &mut FarValues) -> Result<(), FieldError> {
        Ok(self.ask_for(request, values)?)
    }

    fn potentials(&mut self, times_s: &[f64], values: &mut Vec<f64>) -> Result<(), FieldError> {
        Ok(self.ask_for_potentials(times_s, values)?)
    }

    fn ask(&mut self, request: &FarRequest<'_>) -> Result<(), FieldError> {
        self.find_cells(request);
        Ok(locked(&self.shared).send_far(request, &self.cells)?)
    }

    fn take(&mut self, values: &mut FarValues) -> Result<(), FieldError> {
        Ok(locked(&self.shared).take_far(values)?)
    }
}
