//! Cells of any shape, and what lies beyond each of their faces.

use super::boundary::{MeshPatch, check_boundary};
use super::connected::ConnectedParts;
use super::reentrant::ReentrantEdges;
use super::tree::CellTree;
use crate::error::FieldError;
use crate::levels::walls::{BoundaryFace, Condition, polygon};
use amberfield_core::Domain;
use nalgebra::Vector3;
use std::fmt::Display;

/// Shift of the place of a condition from the foot towards its face's centre, over their distance.
const APART: f64 = 1e-3;

/// Neighbour of a cell beyond one of its faces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Neighbour {
    /// Another cell, seen moved by `shift` [m] where the face is cyclic (else zero).
    Cell {
        /// Index of the cell.
        cell: u32,
        /// Shift that is added to the cell's coordinates [m].
        shift: Vector3<f64>,
    },
    /// The end of the mesh: a boundary face's index.
    Boundary(u32),
}

/// A face as one of its cells sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CellFace {
    /// Unit normal out of the cell.
    pub normal: Vector3<f64>,
    /// Normal times the face's centre [m].
    pub offset: f64,
    /// Neighbour beyond the face.
    pub neighbour: Neighbour,
}

impl CellFace {
    /// Distance of a point beyond the face's plane [m]; negative on the cell's side.
    pub(super) fn beyond(&self, point: &Vector3<f64>) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// The cell behind the face; `None` where the mesh ends or repeats.
    pub(super) fn leads_to(&self) -> Option<u32> {
        match self.neighbour {
            Neighbour::Cell { cell, shift } if shift == Vector3::zeros() => Some(cell),
            _ => None,
        }
    }
}

/// Parts that a mesh is made of.
#[derive(Clone, Debug)]
pub struct FarMeshParts {
    /// Bounding box, periodic along axes that cyclic faces join, open along the others.
    pub domain: Domain,
    /// Cell centres [m].
    pub centres: Vec<Vector3<f64>>,
    /// Cell volumes [m³].
    pub volumes: Vec<f64>,
    /// Begin of each cell's faces in `faces`; one more than there are cells.
    pub first_face: Vec<u32>,
    /// Faces, cell by cell.
    pub faces: Vec<CellFace>,
    /// Faces at the end of the mesh.
    pub boundary: Vec<BoundaryFace>,
    /// Begin of each boundary face's corners in `corners`; one more than there are boundary faces.
    pub first_corner: Vec<u32>,
    /// Corners of the boundary faces, face by face, in order around each: right-handed about its normal [m].
    pub corners: Vec<Vector3<f64>>,
    /// Patches of the boundary; some may have no face.
    pub patches: Vec<MeshPatch>,
    /// Patches whose potential changes with time, by their places: the solver knows it, and the conditions of
    /// their faces say 0 V.
    pub changing: Vec<u32>,
}

/// The cells of a far level.
#[derive(Clone, Debug)]
pub struct FarMesh {
    parts: FarMeshParts,
    /// Cube root of each cell's volume [m].
    pub(super) sizes: Vec<f64>,
    pub(super) reentrant: ReentrantEdges,
    pub(super) tree: CellTree,
    connected: ConnectedParts,
}

impl FarMesh {
    /// Checks that every index is within bounds and every number finite.
    ///
    /// # Errors
    /// The first part that makes no sense.
    pub fn new(parts: FarMeshParts) -> Result<Self, FieldError> {
        check(&parts)?;
        check_boundary(&parts)?;
        let sizes = parts.volumes.iter().map(|volume| volume.cbrt()).collect();
        let reentrant = ReentrantEdges::new(&parts);
        let tree = CellTree::new(&parts, &reentrant);
        let connected = ConnectedParts::new(&parts);
        Ok(Self { parts, sizes, reentrant, tree, connected })
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.parts.centres.len()
    }

    /// Bounding box, periodic along axes that cyclic faces join, open along the others.
    #[must_use]
    pub fn domain(&self) -> &Domain {
        &self.parts.domain
    }

    /// Cell centres [m].
    #[must_use]
    pub fn centres(&self) -> &[Vector3<f64>] {
        &self.parts.centres
    }

    /// Cell volumes [m³].
    #[must_use]
    pub fn volumes(&self) -> &[f64] {
        &self.parts.volumes
    }

    /// Faces of a cell.
    #[must_use]
    pub fn faces_of(&self, cell: usize) -> &[CellFace] {
        &self.parts.faces[self.parts.first_face[cell] as usize..self.parts.first_face[cell + 1] as usize]
    }

    /// Faces at the end of the mesh.
    #[must_use]
    pub fn boundary(&self) -> &[BoundaryFace] {
        &self.parts.boundary
    }

    /// Corners of a boundary face in order around it, right-handed about its normal [m]; at least three.
    #[must_use]
    pub fn corners_of(&self, face: usize) -> &[Vector3<f64>] {
        let first = &self.parts.first_corner;
        &self.parts.corners[first[face] as usize..first[face + 1] as usize]
    }

    /// Patches of the boundary, by the index that its faces have; some may have no face.
    #[must_use]
    pub fn patches(&self) -> &[MeshPatch] {
        &self.parts.patches
    }

    /// Patches whose potential changes with time, by their places; the conditions of their faces say 0 V.
    #[must_use]
    pub fn changing(&self) -> &[u32] {
        &self.parts.changing
    }

    /// Place at which a boundary face's condition counts [m]: a slope at the face's centre; a potential at
    /// the foot of its cell's centre, since finite volumes take the slope along the normal from it. A foot
    /// beside the face would lie in the mesh or in the solid where the wall bends: the face's rim on the way
    /// there counts then (a hair nearer to the centre, so that two faces of a cell in one plane have two
    /// places).
    #[must_use]
    pub fn place_of_condition(&self, face: usize) -> Vector3<f64> {
        let BoundaryFace { centre, normal, cell, condition, .. } = self.boundary()[face];
        match condition {
            Condition::Slope(_) => centre,
            Condition::Potential(_) => {
                let inside = &self.parts.centres[cell as usize];
                let way = inside - centre - normal * normal.dot(&(inside - centre));
                let share = polygon::share_within(self.corners_of(face), &normal, &centre, &way);
                centre + way * (share * (1.0 - APART))
            }
        }
    }

    /// Whether any boundary face prescribes the potential.
    #[must_use]
    pub fn has_conductor(&self) -> bool {
        self.boundary().iter().any(BoundaryFace::gives_potential)
    }

    /// Largest cell size, the cube root of the volume [m].
    #[must_use]
    pub fn largest_cell(&self) -> f64 {
        self.sizes.iter().fold(0.0, |largest: f64, size| largest.max(*size))
    }

    /// Parts that no face joins.
    pub(crate) fn connected(&self) -> &ConnectedParts {
        &self.connected
    }
}

/// Largest difference of a unit vector's length from 1.
const UNIT: f64 = 1e-6;

fn check(parts: &FarMeshParts) -> Result<(), FieldError> {
    let bad = |what: &str, place: usize, value: &dyn Display| {
        Err(FieldError::Settings(format!("the mesh's {what} {place} is {value}; the mesh is broken")))
    };
    let cells = parts.centres.len();
    if cells == 0 || parts.volumes.len() != cells || parts.first_face.len() != cells + 1 {
        return Err(FieldError::Settings(format!(
            "the mesh has {cells} cell centres, {} volumes and {} face counts; the mesh is broken",
            parts.volumes.len(),
            parts.first_face.len().saturating_sub(1)
        )));
    }
    if let Some(cell) = parts.volumes.iter().position(|volume| !(volume.is_finite() && *volume > 0.0)) {
        return bad("volume of cell", cell, &parts.volumes[cell]);
    }
    if let Some(cell) = parts.centres.iter().position(|centre| !centre.iter().all(|x| x.is_finite())) {
        return bad("centre of cell", cell, &parts.centres[cell]);
    }
    let ascending = parts.first_face.windows(2).all(|pair| pair[0] <= pair[1]);
    if parts.first_face[0] != 0 || !ascending || parts.first_face[cells] as usize != parts.faces.len() {
        return bad("count of faces up to cell", cells, &parts.first_face[cells]);
    }
    // `!(a <= b)`: what is not a number is no unit vector either.
    let is_unit = |normal: &Vector3<f64>| (normal.norm() - 1.0).abs() <= UNIT;
    for (place, face) in parts.faces.iter().enumerate() {
        let (index, count, moved) = match face.neighbour {
            Neighbour::Cell { cell, shift } => (cell as usize, cells, shift.norm()),
            Neighbour::Boundary(face) => (face as usize, parts.boundary.len(), 0.0),
        };
        if index >= count || !(face.offset + moved).is_finite() || !is_unit(&face.normal) {
            return bad("face", place, &format!("{face:?}"));
        }
    }
    for (place, face) in parts.boundary.iter().enumerate() {
        let finite = face.condition.value().is_finite()
            && face.area > 0.0
            && (face.area + face.centre.norm() + face.spread.norm()).is_finite();
        if face.cell as usize >= cells || !finite || !is_unit(&face.normal) {
            return bad("boundary face", place, &format!("{face:?}"));
        }
    }
    Ok(())
}

#[cfg(test)]
impl FarMeshParts {
    /// Ends the mesh at a face of a cell, by a triangle of some area.
    pub(super) fn end_at(&mut self, cell: usize, number: usize, area: f64, condition: Condition) {
        let face = &mut self.faces[number];
        let inside = &self.centres[cell];
        let centre = inside + face.normal * (face.offset - face.normal.dot(inside));
        self.boundary.push(BoundaryFace {
            centre,
            normal: face.normal,
            area,
            spread: nalgebra::Matrix3::identity(),
            cell: cell as u32,
            patch: 0,
            condition,
        });
        face.neighbour = Neighbour::Boundary(self.boundary.len() as u32 - 1);
        self.corners.extend([centre; 3]);
        self.first_corner.push(self.corners.len() as u32);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;

    fn mesh() -> FarMesh {
        let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Grounded; 2]];
        let domain = Domain::new(Vector3::zeros(), Vector3::new(3.0, 4.0, 5.0), faces).unwrap();
        FarMesh::new(FarMeshParts::of_box(&domain, [3, 4, 5]).unwrap()).unwrap()
    }

    #[test]
    fn boundary_faces_have_their_corners_around_their_normals_and_a_named_patch() {
        let mesh = mesh();
        for (index, face) in mesh.boundary().iter().enumerate() {
            let corners = mesh.corners_of(index);
            let area = (corners[1] - corners[0]).cross(&(corners[2] - corners[1]));
            assert!((area - face.normal * face.area).norm() < 1e-12, "{area} {face:?}");
            assert!((corners.iter().sum::<Vector3<f64>>() / 4.0 - face.centre).norm() < 1e-12);
            let axis = face.normal.iamax();
            let side = if face.normal[axis] < 0.0 { "Min" } else { "Max" };
            let name = format!("{}{side}", ["x", "y", "z"][axis]);
            assert_eq!(mesh.patches()[face.patch as usize].name, name);
        }
    }

    #[test]
    fn broken_meshes_are_refused() {
        let break_it = |harm: &dyn Fn(&mut FarMeshParts)| {
            let mut parts = mesh().parts;
            harm(&mut parts);
            FarMesh::new(parts).unwrap_err().to_string()
        };
        assert!(break_it(&|parts| parts.volumes[3] = f64::NAN).contains("volume of cell 3"));
        assert!(break_it(&|parts| parts.boundary[2].cell = 60).contains("boundary face 2"));
        assert!(break_it(&|parts| parts.first_face[60] = 7).contains("count of faces"));
        assert!(break_it(&|parts| parts.faces[1].neighbour = Neighbour::Boundary(99)).contains("face 1"));
        assert!(break_it(&|parts| parts.centres[7].x = f64::INFINITY).contains("centre of cell 7"));
        assert!(break_it(&|parts| parts.corners[9].z = f64::NAN).contains("corner 9"));
        assert!(break_it(&|parts| parts.first_corner[2] = 6).contains("corners of boundary face 1 is 2"));
        assert!(break_it(&|parts| parts.first_corner[2] = 3).contains("corners of boundary face 1 is -1"));
        assert!(break_it(&|parts| _ = parts.corners.pop()).contains("54 counts of their corners"));
        assert!(
            break_it(&|parts| parts.boundary[3].patch = 6).contains("patch of boundary face 3 is 6 of 6")
        );
    }
}
