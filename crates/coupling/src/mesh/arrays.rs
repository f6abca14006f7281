//! A mesh in the wire's arrays: for field solvers in Rust, of tests and measurements.

use super::part::MeshPart;
use amberfield_core::Axis;
use amberfield_field::far::{BoundaryFace, Condition, FarMesh, Neighbour};
use amberfield_wire::payloads::{self, MeshOutline};

/// A whole mesh in arrays as a solver of one rank sends them.
#[derive(Clone, Debug)]
pub struct MeshArrays {
    centres: Vec<[f64; 3]>,
    first_face: Vec<u64>,
    normals: Vec<[f64; 3]>,
    offsets: Vec<f64>,
    neighbours: Vec<i64>,
    shifts: Vec<[f64; 3]>,
    boundary: Vec<payloads::BoundaryFace>,
    first_corner: Vec<u64>,
    corners: Vec<[f64; 3]>,
    patches: String,
    changing: Vec<u64>,
}

impl MeshArrays {
    /// Takes the arrays from a mesh.
    #[must_use]
    pub fn of(mesh: &FarMesh) -> Self {
        let faces: Vec<_> = (0..mesh.cell_count()).flat_map(|cell| mesh.faces_of(cell)).collect();
        let mut first_face = vec![0];
        for cell in 0..mesh.cell_count() {
            first_face.push(first_face[cell] + mesh.faces_of(cell).len() as u64);
        }
        let mut first_corner = vec![0];
        let mut corners: Vec<[f64; 3]> = Vec::new();
        for face in 0..mesh.boundary().len() {
            corners.extend(mesh.corners_of(face).iter().map(|&corner| <[f64; 3]>::from(corner)));
            first_corner.push(corners.len() as u64);
        }
        let beyond = |neighbour: Neighbour| match neighbour {
            Neighbour::Cell { cell, shift } => (i64::from(cell), shift.into()),
            Neighbour::Boundary(face) => (-1 - i64::from(face), [0.0; 3]),
        };
        Self {
            centres: mesh.centres().iter().map(|&centre| centre.into()).collect(),
            first_face,
            normals: faces.iter().map(|face| face.normal.into()).collect(),
            offsets: faces.iter().map(|face| face.offset).collect(),
            neighbours: faces.iter().map(|face| beyond(face.neighbour).0).collect(),
            shifts: faces.iter().map(|face| beyond(face.neighbour).1).collect(),
            boundary: mesh.boundary().iter().map(boundary_face).collect(),
            first_corner,
            corners,
            patches: mesh.patches().iter().map(|patch| format!("{} {}\n", patch.name, patch.kind)).collect(),
            changing: mesh.changing().iter().map(|&patch| u64::from(patch)).collect(),
        }
    }

    /// Gives the arrays in place, with those that `mesh` has already.
    #[must_use]
    pub fn part<'a>(&'a self, mesh: &'a FarMesh) -> MeshPart<'a> {
        let whole = mesh.domain();
        MeshPart {
            outline: MeshOutline {
                low_m: whole.min().into(),
                high_m: whole.max().into(),
                periodic: Axis::ALL.map(|axis| u64::from(whole.is_periodic(axis))),
                first_cell: 0,
                all_cells: self.centres.len() as u64,
            },
            centres: &self.centres,
            volumes: mesh.volumes(),
            first_face: &self.first_face,
            face_normals: &self.normals,
            face_offsets: &self.offsets,
            face_neighbours: &self.neighbours,
            face_shifts: &self.shifts,
            boundary_faces: &self.boundary,
            first_corner: &self.first_corner,
            corners: &self.corners,
            patches: self.patches.as_bytes(),
            changing: &self.changing,
            points: &[],
            first_face_corner: &[],
            face_corners: &[],
        }
    }
}

/// A boundary face as it travels.
fn boundary_face(face: &BoundaryFace) -> payloads::BoundaryFace {
    let (is_conductor, prescribed) = match face.condition {
        Condition::Potential(volts) => (1, volts),
        Condition::Slope(slope) => (0, slope),
    };
    payloads::BoundaryFace {
        centre_m: face.centre.into(),
        normal: face.normal.into(),
        area_m2: face.area,
        cell: u64::from(face.cell),
        patch: u64::from(face.patch),
        is_conductor,
        prescribed,
        spread_xx_m2: face.spread.m11,
        spread_xy_m2: face.spread.m12,
        spread_xz_m2: face.spread.m13,
        spread_yy_m2: face.spread.m22,
        spread_yz_m2: face.spread.m23,
        spread_zz_m2: face.spread.m33,
    }
}
