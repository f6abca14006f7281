//! A mesh as it travels: one part per rank, put together on the DEM side.

use crate::CouplingError;
use amberfield_core::{Boundary, Domain, Matrix3, Vector3};
use amberfield_field::FieldError;
use amberfield_field::far::{BoundaryFace, CellFace, Condition, FarMesh, FarMeshParts, Neighbour};
use amberfield_wire::{Block64, Header, Layout, MessageKind, Section, Sections, WireError};
use std::mem::MaybeUninit;

/// Numbers of a boundary face, see [`Section::BoundaryFaces`].
pub(crate) const BOUNDARY_NUMBERS: usize = 16;
/// Numbers of a mesh, see [`Section::MeshNumbers`].
const MESH_NUMBERS: usize = 11;

/// One rank's part of a mesh, in arrays as the wire has them: see [`Section`].
#[derive(Clone, Copy, Debug)]
pub struct MeshPart<'a> {
    /// Lower and upper corner of all ranks' cells [m].
    pub corners: [[f64; 3]; 2],
    /// Axes that cyclic faces join.
    pub periodic: [bool; 3],
    /// First cell of this rank among all ranks' cells.
    pub first_cell: u64,
    /// Cells of all ranks.
    pub all_cells: u64,
    /// Cell centres [m].
    pub centres: &'a [[f64; 3]],
    /// Cell volumes [m³].
    pub volumes: &'a [f64],
    /// Where each cell's faces begin; one more than there are cells.
    pub first_face: &'a [u64],
    /// Outward unit normals of the cells' faces.
    pub face_normals: &'a [[f64; 3]],
    /// Normals times face centres [m].
    pub face_offsets: &'a [f64],
    /// Cell c of all ranks beyond a face as c, boundary face b of this rank as −1 − b.
    pub face_neighbours: &'a [i64],
    /// What is added to the neighbours' coordinates [m].
    pub face_shifts: &'a [[f64; 3]],
    /// By boundary face: centre, normal, area, cell of this rank, 1 for a prescribed potential (0: slope), its value.
    pub boundary_faces: &'a [[f64; BOUNDARY_NUMBERS]],
}

impl MeshPart<'_> {
    pub(crate) fn layout(&self, header: Header) -> Layout {
        Layout::new(header)
            .with::<f64>(Section::MeshNumbers, MESH_NUMBERS)
            .with::<[f64; 3]>(Section::Centres, self.centres.len())
            .with::<f64>(Section::Volumes, self.volumes.len())
            .with::<u64>(Section::FirstFace, self.first_face.len())
            .with::<[f64; 3]>(Section::FaceNormals, self.face_normals.len())
            .with::<f64>(Section::FaceOffsets, self.face_offsets.len())
            .with::<i64>(Section::FaceNeighbours, self.face_neighbours.len())
            .with::<[f64; 3]>(Section::FaceShifts, self.face_shifts.len())
            .with::<[f64; BOUNDARY_NUMBERS]>(Section::BoundaryFaces, self.boundary_faces.len())
    }

    pub(crate) fn write(
        &self,
        layout: &Layout,
        payload: &mut [MaybeUninit<Block64>],
    ) -> Result<(), WireError> {
        let [low, high] = self.corners;
        let periodic = self.periodic.map(|periodic| f64::from(u8::from(periodic)));
        let numbers = low.into_iter().chain(high).chain(periodic);
        let numbers: Vec<f64> = numbers.chain([self.first_cell as f64, self.all_cells as f64]).collect();
        layout.section_mut::<f64>(payload, Section::MeshNumbers)?.copy_from_slice(&numbers);
        layout.section_mut::<[f64; 3]>(payload, Section::Centres)?.copy_from_slice(self.centres);
        layout.section_mut::<f64>(payload, Section::Volumes)?.copy_from_slice(self.volumes);
        layout.section_mut::<u64>(payload, Section::FirstFace)?.copy_from_slice(self.first_face);
        layout.section_mut::<[f64; 3]>(payload, Section::FaceNormals)?.copy_from_slice(self.face_normals);
        layout.section_mut::<f64>(payload, Section::FaceOffsets)?.copy_from_slice(self.face_offsets);
        layout.section_mut::<i64>(payload, Section::FaceNeighbours)?.copy_from_slice(self.face_neighbours);
        layout.section_mut::<[f64; 3]>(payload, Section::FaceShifts)?.copy_from_slice(self.face_shifts);
        let faces = layout.section_mut::<[f64; BOUNDARY_NUMBERS]>(payload, Section::BoundaryFaces)?;
        faces.copy_from_slice(self.boundary_faces);
        Ok(())
    }

    /// A part that arrived, in place.
    ///
    /// # Errors
    /// A section that is missing or does not fit the others.
    pub fn read<'a>(sections: &Sections<'a>) -> Result<MeshPart<'a>, WireError> {
        let numbers = sections.exactly::<f64>(Section::MeshNumbers, MESH_NUMBERS)?;
        let corner = |from: usize| [numbers[from], numbers[from + 1], numbers[from + 2]];
        let centres = sections.get::<[f64; 3]>(Section::Centres)?;
        let face_normals = sections.get::<[f64; 3]>(Section::FaceNormals)?;
        Ok(MeshPart {
            corners: [corner(0), corner(3)],
            periodic: corner(6).map(|number| number != 0.0),
            first_cell: numbers[9] as u64,
            all_cells: numbers[10] as u64,
            centres,
            volumes: sections.exactly(Section::Volumes, centres.len())?,
            first_face: sections.exactly(Section::FirstFace, centres.len() + 1)?,
            face_normals,
            face_offsets: sections.exactly(Section::FaceOffsets, face_normals.len())?,
            face_neighbours: sections.exactly(Section::FaceNeighbours, face_normals.len())?,
            face_shifts: sections.exactly(Section::FaceShifts, face_normals.len())?,
            boundary_faces: sections.get(Section::BoundaryFaces)?,
        })
    }
}

/// The header of a rank's part.
pub(crate) fn mesh_header(run: u64, rank: u32, ranks: u32) -> Header {
    Header { rank, ranks, ..Header::new(MessageKind::Mesh, run, 0) }
}

/// Puts the parts of all ranks together, in their order.
///
/// # Errors
/// The first part or number that makes no sense.
///
/// # Panics
/// Without any part.
pub fn assemble(parts: &[MeshPart<'_>]) -> Result<FarMesh, CouplingError> {
    let mut whole = FarMeshParts {
        domain: domain_of(&parts[0])?,
        centres: Vec::new(),
        volumes: Vec::new(),
        first_face: vec![0],
        faces: Vec::new(),
        boundary: Vec::new(),
    };
    for part in parts {
        let first = whole.centres.len();
        let (first_face, first_boundary) = (whole.faces.len() as u64, whole.boundary.len() as i64);
        let face_from = |face: &u64| {
            let face = first_face.saturating_add(*face);
            u32::try_from(face).map_err(|_| broken(format!("a face's number is {face}")))
        };
        if part.first_cell != first as u64 {
            return Err(broken(format!("a rank's cells begin at {} instead of {first}", part.first_cell)));
        }
        whole.centres.extend(part.centres.iter().map(|&centre| Vector3::from(centre)));
        whole.volumes.extend(part.volumes);
        let ends: Result<Vec<u32>, _> = part.first_face[1..].iter().map(face_from).collect();
        whole.first_face.extend(ends?);
        for (face, &neighbour) in part.face_neighbours.iter().enumerate() {
            let neighbour = if neighbour >= 0 {
                let shift = Vector3::from(part.face_shifts[face]);
                Neighbour::Cell { cell: index(neighbour)?, shift }
            } else {
                Neighbour::Boundary(index(first_boundary.saturating_add(-1 - neighbour))?)
            };
            let normal = Vector3::from(part.face_normals[face]);
            whole.faces.push(CellFace { normal, offset: part.face_offsets[face], neighbour });
        }
        for &[cx, cy, cz, nx, ny, nz, area, cell, kind, value, xx, xy, xz, yy, yz, zz] in part.boundary_faces
        {
            whole.boundary.push(BoundaryFace {
                centre: Vector3::new(cx, cy, cz),
                normal: Vector3::new(nx, ny, nz),
                area,
                spread: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
                cell: index((first as i64).saturating_add(cell as i64))?,
                condition: if kind == 0.0 { Condition::Slope(value) } else { Condition::Potential(value) },
            });
        }
    }
    if parts[0].all_cells != whole.centres.len() as u64 {
        return Err(broken(format!(
            "{} cells were announced, {} came",
            parts[0].all_cells,
            whole.centres.len()
        )));
    }
    Ok(FarMesh::new(whole)?)
}

/// One rank's own cells and what lies beyond them, for mapping charges: neighbours of other ranks are the mesh's end.
pub(crate) fn own_cells(part: &MeshPart<'_>) -> Result<FarMesh, CouplingError> {
    let own = part.first_cell..part.first_cell + part.centres.len() as u64;
    let mut boundary: Vec<[f64; BOUNDARY_NUMBERS]> = part.boundary_faces.to_vec();
    let mut neighbours = part.face_neighbours.to_vec();
    for (cell, ends) in part.first_face.windows(2).enumerate() {
        let faces = ends[0] as usize..ends[1] as usize;
        for (neighbour, normal) in neighbours[faces.clone()].iter_mut().zip(&part.face_normals[faces]) {
            if *neighbour < 0 {
                continue;
            }
            if own.contains(&(*neighbour as u64)) {
                *neighbour -= part.first_cell as i64;
            } else {
                let ([cx, cy, cz], [nx, ny, nz]) = (part.centres[cell], *normal);
                *neighbour = -1 - boundary.len() as i64;
                let mut face = [0.0; BOUNDARY_NUMBERS];
                face[..8].copy_from_slice(&[cx, cy, cz, nx, ny, nz, 1.0, cell as f64]);
                boundary.push(face);
            }
        }
    }
    let alone = MeshPart {
        first_cell: 0,
        all_cells: part.centres.len() as u64,
        face_neighbours: &neighbours,
        boundary_faces: &boundary,
        ..*part
    };
    assemble(&[alone])
}

fn domain_of(part: &MeshPart<'_>) -> Result<Domain, CouplingError> {
    let [low, high] = part.corners.map(Vector3::from);
    let faces = part.periodic.map(|periodic| [if periodic { Boundary::Periodic } else { Boundary::Open }; 2]);
    Domain::new(low, high, faces).map_err(|error| broken(error.to_string()))
}

fn index(number: i64) -> Result<u32, CouplingError> {
    u32::try_from(number).map_err(|_| broken(format!("an index of it is {number}")))
}

fn broken(what: String) -> CouplingError {
    CouplingError::Mesh(FieldError::Settings(format!("the field solver's mesh is broken: {what}")))
}
