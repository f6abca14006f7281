//! A mesh as it travels: one part per rank, put together on the DEM side.

use crate::CouplingError;
use amberfield_core::{Boundary, Domain, Matrix3, Vector3};
use amberfield_field::FieldError;
use amberfield_field::far::{BoundaryFace, CellFace, Condition, FarMesh, FarMeshParts, MeshPatch, Neighbour};
use amberfield_gas::CellShapes;
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
    /// Place of each boundary face's first corner, and at last the number of corners.
    pub first_corner: &'a [u64],
    /// Corners of the boundary faces, in order around each, right-handed about its normal [m].
    pub corners: &'a [[f64; 3]],
    /// Patches of the mesh: lines of a name, a blank and a type; the same for all ranks.
    pub patches: &'a [u8],
    /// Patches whose potential changes with time, by their places among all; the same for all ranks.
    pub changing: &'a [u64],
    /// Corners of this rank's faces, each once [m]; empty unless a gas flows between grains, as are the next
    /// two.
    pub points: &'a [[f64; 3]],
    /// Place of each face entry's first corner, and at last the number of corners.
    pub first_face_corner: &'a [u64],
    /// Corners of the faces in order around each, either way, as places among the points.
    pub face_corners: &'a [u32],
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
            .with::<u64>(Section::FirstCorner, self.first_corner.len())
            .with::<[f64; 3]>(Section::Corners, self.corners.len())
            .with::<u8>(Section::Patches, self.patches.len())
            .with::<u64>(Section::ChangingPatches, self.changing.len())
            .with::<[f64; 3]>(Section::Points, self.points.len())
            .with::<u64>(Section::FirstFaceCorner, self.first_face_corner.len())
            .with::<u32>(Section::FaceCorners, self.face_corners.len())
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
        layout.section_mut::<u64>(payload, Section::FirstCorner)?.copy_from_slice(self.first_corner);
        layout.section_mut::<[f64; 3]>(payload, Section::Corners)?.copy_from_slice(self.corners);
        layout.section_mut::<u8>(payload, Section::Patches)?.copy_from_slice(self.patches);
        layout.section_mut::<u64>(payload, Section::ChangingPatches)?.copy_from_slice(self.changing);
        layout.section_mut::<[f64; 3]>(payload, Section::Points)?.copy_from_slice(self.points);
        let first = layout.section_mut::<u64>(payload, Section::FirstFaceCorner)?;
        first.copy_from_slice(self.first_face_corner);
        layout.section_mut::<u32>(payload, Section::FaceCorners)?.copy_from_slice(self.face_corners);
        Ok(())
    }

    /// Reads a part that arrived, in place.
    ///
    /// # Errors
    /// A section that is missing or does not fit the others.
    pub fn read<'a>(sections: &Sections<'a>) -> Result<MeshPart<'a>, WireError> {
        let centres = sections.get::<[f64; 3]>(Section::Centres)?;
        let face_normals = sections.get::<[f64; 3]>(Section::FaceNormals)?;
        let boundary_faces = sections.get::<payloads::BoundaryFace>(Section::BoundaryFaces)?;
        Ok(MeshPart {
            outline: *sections.one(Section::MeshOutline)?,
            centres,
            volumes: sections.exactly(Section::Volumes, centres.len())?,
            first_face: sections.exactly(Section::FirstFace, centres.len() + 1)?,
            face_normals,
            face_offsets: sections.exactly(Section::FaceOffsets, face_normals.len())?,
            face_neighbours: sections.exactly(Section::FaceNeighbours, face_normals.len())?,
            face_shifts: sections.exactly(Section::FaceShifts, face_normals.len())?,
            boundary_faces,
            first_corner: sections.exactly(Section::FirstCorner, boundary_faces.len() + 1)?,
            corners: sections.get(Section::Corners)?,
            patches: sections.get(Section::Patches)?,
            changing: sections.get(Section::ChangingPatches)?,
            points: sections.get(Section::Points)?,
            first_face_corner: sections.get(Section::FirstFaceCorner)?,
            face_corners: sections.get(Section::FaceCorners)?,
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
        first_corner: vec![0],
        corners: Vec::new(),
        patches: patches_of(&parts[0]),
        changing: changing_of(&parts[0])?,
    };
    for part in parts {
        let first = whole.centres.len();
        let (first_face, first_boundary) = (whole.faces.len(), whole.boundary.len() as i64);
        let announced = part.outline.first_cell;
        if announced != first as u64 {
            return Err(broken(format!("a rank's cells begin at {announced} instead of {first}")));
        }
        if part.patches != parts[0].patches || part.changing != parts[0].changing {
            return Err(broken("its ranks have different patches".to_owned()));
        }
        whole.centres.extend(part.centres.iter().map(|&centre| Vector3::from(centre)));
        whole.volumes.extend(part.volumes);
        whole.first_face.extend(ends_from(first_face, part.first_face)?);
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
        whole.first_corner.extend(ends_from(whole.corners.len(), part.first_corner)?);
        whole.corners.extend(part.corners.iter().map(|&corner| Vector3::from(corner)));
    }
    let (announced, came) = (parts[0].outline.all_cells, whole.centres.len());
    if announced != came as u64 {
        return Err(broken(format!("{announced} cells were announced, {came} came")));
    }
    Ok(FarMesh::new(whole)?)
}

/// Puts the corners of all faces together, in the order of a mesh's faces by cell.
///
/// # Errors
/// The first number that makes no sense.
pub(crate) fn shapes_of(mesh: &FarMesh, parts: &[MeshPart<'_>]) -> Result<CellShapes, CouplingError> {
    let (mut points, mut first, mut corners) = (Vec::new(), vec![0], Vec::new());
    for part in parts {
        let before = points.len();
        points.extend(part.points.iter().map(|&point| Vector3::from(point)));
        if part.first_face_corner.is_empty() {
            continue;
        }
        first.extend(ends_from(corners.len(), part.first_face_corner)?);
        for &corner in part.face_corners {
            corners.push(index((before as i64).saturating_add(i64::from(corner)))?);
        }
    }
    CellShapes::new(mesh, points, first, corners).map_err(|error| broken(error.to_string()))
}

/// Ends of the lists whose begins a rank gives, where `first` entries of lower ranks come before its own.
fn ends_from(first: usize, begins: &[u64]) -> Result<Vec<u32>, CouplingError> {
    let end_from = |end: &u64| {
        let end = (first as u64).saturating_add(*end);
        u32::try_from(end).map_err(|_| broken(format!("the end of a list in it is {end}")))
    };
    begins[1..].iter().map(end_from).collect()
}

/// Patches that a rank describes.
fn patches_of(part: &MeshPart<'_>) -> Vec<MeshPatch> {
    let patch = |line: &str| {
        let (name, kind) = line.split_once(' ').unwrap_or((line, ""));
        MeshPatch { name: name.to_owned(), kind: kind.to_owned() }
    };
    String::from_utf8_lossy(part.patches).lines().map(patch).collect()
}

/// Patches whose potential changes with time, by their places.
fn changing_of(part: &MeshPart<'_>) -> Result<Vec<u32>, CouplingError> {
    part.changing.iter().map(|&patch| index(i64::try_from(patch).unwrap_or(i64::MAX))).collect()
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
        patch: index(i64::try_from(face.patch).unwrap_or(i64::MAX))?,
        condition: match face.is_conductor {
            0 => Condition::Slope(face.prescribed),
            _ => Condition::Potential(face.prescribed),
        },
    })
}

/// One rank's own cells, as far as the density of charges in them needs them.
#[derive(Debug)]
pub(crate) struct OwnCells {
    /// Box of all ranks' cells.
    pub(crate) whole: Domain,
    /// Cell centres [m].
    pub(crate) centres: Vec<Vector3<f64>>,
    /// Cell volumes [m³].
    pub(crate) volumes: Vec<f64>,
}

impl OwnCells {
    /// Takes them from a rank's part; the DEM side checks it.
    ///
    /// # Errors
    /// A box that is none.
    pub(crate) fn new(part: &MeshPart<'_>) -> Result<Self, CouplingError> {
        Ok(Self {
            whole: domain_of(part)?,
            centres: part.centres.iter().map(|&centre| Vector3::from(centre)).collect(),
            volumes: part.volumes.to_vec(),
        })
    }

    /// Lower and upper corner of a box around the cells [m]. That of a rank which has all cells along an axis
    /// is the mesh's there, whose period counts.
    pub(crate) fn corners(&self) -> [Vector3<f64>; 2] {
        let first = self.centres.first().copied().unwrap_or_default();
        let low = self.centres.iter().fold(first, |low, centre| low.inf(centre));
        let high = self.centres.iter().fold(first, |high, centre| high.sup(centre));
        let half = Vector3::repeat(0.5 * self.largest());
        [(low - half).sup(&self.whole.min()), (high + half).inf(&self.whole.max())]
    }

    /// Largest cell size, the cube root of the volume [m].
    fn largest(&self) -> f64 {
        self.volumes.iter().fold(0.0, |largest: f64, volume| largest.max(volume.cbrt()))
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
