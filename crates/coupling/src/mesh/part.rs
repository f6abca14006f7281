//! A mesh as it travels: one part per rank, put together on the DEM side.

use crate::CouplingError;
use amberfield_core::{Boundary, Domain, Matrix3, Vector3};
use amberfield_field::FieldError;
use amberfield_field::far::{BoundaryFace, CellFace, Condition, FarMesh, FarMeshParts, Neighbour};
use amberfield_wire::payloads::{self, MeshOutline};
use amberfield_wire::{Block64, Header, Layout, MessageKind, Section, Sections, WireError};
use std::mem::MaybeUninit;

/// One rank's part of a mesh, in arrays as the wire has them: see [`Section`].
#[derive(Clone, Copy, Debug)]
pub struct MeshPart<'a> {
    /// Box of all ranks' cells, periodic axes, and where this rank's cells are among all.
    pub outline: MeshOutline,
    /// Cell centres [m].
    pub centres: &'a [[f64; 3]],
    /// Cell volumes [m³].
    pub volumes: &'a [f64],
    /// Place of each cell's first face, and at last the number of faces.
    pub first_face: &'a [u64],
    /// Outward unit normals of the cells' faces.
    pub face_normals: &'a [[f64; 3]],
    /// Scalar products of normals and face centres [m].
    pub face_offsets: &'a [f64],
    /// Neighbours beyond the faces: cell c of all ranks as c, boundary face b of this rank as −1 − b.
    pub face_neighbours: &'a [i64],
    /// Vectors to add to the neighbours' coordinates [m].
    pub face_shifts: &'a [[f64; 3]],
    /// Boundary faces of this rank, with the conditions there.
    pub boundary_faces: &'a [payloads::BoundaryFace],
}

impl MeshPart<'_> {
    pub(crate) fn layout(&self, header: Header) -> Layout {
        Layout::new(header)
            .with::<MeshOutline>(Section::MeshOutline, 1)
            .with::<[f64; 3]>(Section::Centres, self.centres.len())
            .with::<f64>(Section::Volumes, self.volumes.len())
            .with::<u64>(Section::FirstFace, self.first_face.len())
            .with::<[f64; 3]>(Section::FaceNormals, self.face_normals.len())
            .with::<f64>(Section::FaceOffsets, self.face_offsets.len())
            .with::<i64>(Section::FaceNeighbours, self.face_neighbours.len())
            .with::<[f64; 3]>(Section::FaceShifts, self.face_shifts.len())
            .with::<payloads::BoundaryFace>(Section::BoundaryFaces, self.boundary_faces.len())
    }

    pub(crate) fn write(
        &self,
        layout: &Layout,
        payload: &mut [MaybeUninit<Block64>],
    ) -> Result<(), WireError> {
        layout.section_mut::<MeshOutline>(payload, Section::MeshOutline)?.fill(self.outline);
        layout.section_mut::<[f64; 3]>(payload, Section::Centres)?.copy_from_slice(self.centres);
        layout.section_mut::<f64>(payload, Section::Volumes)?.copy_from_slice(self.volumes);
        layout.section_mut::<u64>(payload, Section::FirstFace)?.copy_from_slice(self.first_face);
        layout.section_mut::<[f64; 3]>(payload, Section::FaceNormals)?.copy_from_slice(self.face_normals);
        layout.section_mut::<f64>(payload, Section::FaceOffsets)?.copy_from_slice(self.face_offsets);
        layout.section_mut::<i64>(payload, Section::FaceNeighbours)?.copy_from_slice(self.face_neighbours);
        layout.section_mut::<[f64; 3]>(payload, Section::FaceShifts)?.copy_from_slice(self.face_shifts);
        let faces = layout.section_mut::<payloads::BoundaryFace>(payload, Section::BoundaryFaces)?;
        faces.copy_from_slice(self.boundary_faces);
        Ok(())
    }

    /// Reads a part that arrived, in place.
    ///
    /// # Errors
    /// A section that is missing or does not fit the others.
    pub fn read<'a>(sections: &Sections<'a>) -> Result<MeshPart<'a>, WireError> {
        let centres = sections.get::<[f64; 3]>(Section::Centres)?;
        let face_normals = sections.get::<[f64; 3]>(Section::FaceNormals)?;
        Ok(MeshPart {
            outline: *sections.one(Section::MeshOutline)?,
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
        let announced = part.outline.first_cell;
        if announced != first as u64 {
            return Err(broken(format!("a rank's cells begin at {announced} instead of {first}")));
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
        for face in part.boundary_faces {
            whole.boundary.push(boundary_face(face, first)?);
        }
    }
    let (announced, came) = (parts[0].outline.all_cells, whole.centres.len());
    if announced != came as u64 {
        return Err(broken(format!("{announced} cells were announced, {came} came")));
    }
    Ok(FarMesh::new(whole)?)
}

/// A boundary face as it travels, of a rank whose first cell has the number `first` among all.
fn boundary_face(face: &payloads::BoundaryFace, first: usize) -> Result<BoundaryFace, CouplingError> {
    let payloads::BoundaryFace { spread_xx_m2: xx, spread_xy_m2: xy, spread_xz_m2: xz, .. } = *face;
    let payloads::BoundaryFace { spread_yy_m2: yy, spread_yz_m2: yz, spread_zz_m2: zz, .. } = *face;
    let cell = i64::try_from(face.cell).unwrap_or(i64::MAX);
    Ok(BoundaryFace {
        centre: Vector3::from(face.centre_m),
        normal: Vector3::from(face.normal),
        area: face.area_m2,
        spread: Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz),
        cell: index((first as i64).saturating_add(cell))?,
        condition: match face.is_conductor {
            0 => Condition::Slope(face.prescribed),
            _ => Condition::Potential(face.prescribed),
        },
    })
}

/// One rank's own cells and what lies beyond them, for mapping charges: neighbours of other ranks are the
/// mesh's end.
pub(crate) fn own_cells(part: &MeshPart<'_>) -> Result<FarMesh, CouplingError> {
    let first = part.outline.first_cell;
    let own = first..first + part.centres.len() as u64;
    let mut boundary = part.boundary_faces.to_vec();
    let mut neighbours = part.face_neighbours.to_vec();
    for (cell, ends) in part.first_face.windows(2).enumerate() {
        let faces = ends[0] as usize..ends[1] as usize;
        for (neighbour, normal) in neighbours[faces.clone()].iter_mut().zip(&part.face_normals[faces]) {
            if *neighbour < 0 {
                continue;
            }
            if own.contains(&(*neighbour as u64)) {
                *neighbour -= first as i64;
            } else {
                *neighbour = -1 - boundary.len() as i64;
                boundary.push(end_of_part(part.centres[cell], *normal, cell as u64));
            }
        }
    }
    let alone = MeshPart {
        outline: MeshOutline { first_cell: 0, all_cells: part.centres.len() as u64, ..part.outline },
        face_neighbours: &neighbours,
        boundary_faces: &boundary,
        ..*part
    };
    assemble(&[alone])
}

/// A face between a cell of this rank and one of another: only where it is and that it ends the part counts.
fn end_of_part(centre_m: [f64; 3], normal: [f64; 3], cell: u64) -> payloads::BoundaryFace {
    payloads::BoundaryFace {
        centre_m,
        normal,
        area_m2: 1.0,
        cell,
        is_conductor: 0,
        prescribed: 0.0,
        spread_xx_m2: 0.0,
        spread_xy_m2: 0.0,
        spread_xz_m2: 0.0,
        spread_yy_m2: 0.0,
        spread_yz_m2: 0.0,
        spread_zz_m2: 0.0,
    }
}

fn domain_of(part: &MeshPart<'_>) -> Result<Domain, CouplingError> {
    let MeshOutline { low_m, high_m, periodic, .. } = part.outline;
    let faces = periodic.map(|joined| [if joined == 0 { Boundary::Open } else { Boundary::Periodic }; 2]);
    Domain::new(Vector3::from(low_m), Vector3::from(high_m), faces).map_err(|error| broken(error.to_string()))
}

fn index(number: i64) -> Result<u32, CouplingError> {
    u32::try_from(number).map_err(|_| broken(format!("an index of it is {number}")))
}

fn broken(what: String) -> CouplingError {
    CouplingError::Mesh(FieldError::Settings(format!("the field solver's mesh is broken: {what}")))
}
