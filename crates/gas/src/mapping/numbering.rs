//! Numbers of a mesh's nodes: which corners of neighbouring cells are one.

use crate::shapes::CellShapes;
use amberfield_core::Vector3;
use amberfield_field::far::{FarMesh, Neighbour};
use std::ops::Range;

/// Largest distance of a corner from the same one seen from the next cell, over the cell's size.
const SAME: f64 = 1e-3;
/// Number of what has none yet.
const NONE: u32 = u32::MAX;

/// Nodes at corners.
#[derive(Debug)]
pub(super) struct Numbering {
    /// Number of the first face of each cell; one more than there are cells.
    pub(super) first_face: Vec<u32>,
    /// Node of each corner of each face.
    pub(super) of_corner: Vec<u32>,
    /// Number of nodes.
    pub(super) count: u32,
}

/// Face beyond which there is another cell.
struct Passage {
    cell: usize,
    face: usize,
    other: usize,
    /// Shift with which the other cell is seen [m].
    shift: Vector3<f64>,
}

impl Numbering {
    /// Numbers the nodes of a mesh.
    pub(super) fn new(mesh: &FarMesh, shapes: &CellShapes) -> Self {
        let mut first_face = vec![0];
        for cell in 0..mesh.cell_count() {
            first_face.push(first_face[cell] + mesh.faces_of(cell).len() as u32);
        }
        let mut numbers = Self { first_face, of_corner: Vec::new(), count: 0 };
        numbers.number_corners(mesh, shapes);
        numbers
    }

    fn faces(&self, cell: usize) -> Range<usize> {
        self.first_face[cell] as usize..self.first_face[cell + 1] as usize
    }

    fn next(&mut self) -> u32 {
        self.count += 1;
        self.count - 1
    }

    /// Faces of a cell beyond which there are others.
    fn passages(&self, mesh: &FarMesh, cell: usize) -> Vec<Passage> {
        let passage = |(face, entry): (usize, &amberfield_field::far::CellFace)| match entry.neighbour {
            Neighbour::Cell { cell: other, shift } => {
                Some(Passage { cell, face, other: other as usize, shift })
            }
            Neighbour::Boundary(_) => None,
        };
        self.faces(cell).zip(mesh.faces_of(cell)).filter_map(passage).collect()
    }

    /// Joins corners through faces alone: two cells on both sides of a thin wall share none.
    fn number_corners(&mut self, mesh: &FarMesh, shapes: &CellShapes) {
        let own = OwnCorners::new(mesh, shapes, &self.first_face);
        let mut joined = Joined((0..own.points.len() as u32).collect());
        for cell in 0..mesh.cell_count() {
            for passage in self.passages(mesh, cell) {
                for &point in shapes.corners(passage.face) {
                    let here = own.place(cell, point).expect("the cell's own corner");
                    if let Some(there) = own.twin(mesh, shapes, &passage, point) {
                        joined.join(here as u32, there as u32);
                    }
                }
            }
        }
        let mut numbers = vec![NONE; own.points.len()];
        for cell in 0..mesh.cell_count() {
            for face in self.faces(cell) {
                for &point in shapes.corners(face) {
                    let place = own.place(cell, point).expect("the cell's own corner");
                    let root = joined.root(place as u32) as usize;
                    if numbers[root] == NONE {
                        numbers[root] = self.next();
                    }
                    self.of_corner.push(numbers[root]);
                }
            }
        }
    }
}

/// Corners of each cell, each once.
struct OwnCorners {
    /// Number of the first corner of each cell; one more than there are cells.
    first: Vec<usize>,
    /// Points of the corners, ascending in each cell.
    points: Vec<u32>,
}

impl OwnCorners {
    fn new(mesh: &FarMesh, shapes: &CellShapes, first_face: &[u32]) -> Self {
        let (mut first, mut points) = (vec![0], Vec::new());
        for cell in 0..mesh.cell_count() {
            let faces = first_face[cell] as usize..first_face[cell + 1] as usize;
            let mut of_cell: Vec<u32> = faces.flat_map(|face| shapes.corners(face).iter().copied()).collect();
            of_cell.sort_unstable();
            of_cell.dedup();
            points.extend(of_cell);
            first.push(points.len());
        }
        Self { first, points }
    }

    /// Number of a cell's corner.
    fn place(&self, cell: usize, point: u32) -> Option<usize> {
        let corners = &self.points[self.first[cell]..self.first[cell + 1]];
        corners.binary_search(&point).ok().map(|place| self.first[cell] + place)
    }

    /// Number of the corner of the cell beyond a face that is the same as a point of the face.
    fn twin(&self, mesh: &FarMesh, shapes: &CellShapes, passage: &Passage, point: u32) -> Option<usize> {
        let Passage { cell, other, shift, .. } = *passage;
        if shift == Vector3::zeros()
            && let Some(same) = self.place(other, point)
        {
            return Some(same);
        }
        let place = shapes.points()[point as usize] - shift;
        let away = |&corner: &usize| (shapes.points()[self.points[corner] as usize] - place).norm();
        let near = SAME * mesh.volumes()[cell].cbrt();
        (self.first[other]..self.first[other + 1])
            .min_by(|a, b| away(a).total_cmp(&away(b)))
            .filter(|corner| away(corner) < near)
    }
}

/// Sets of things that are one, each known by its smallest number.
struct Joined(Vec<u32>);

impl Joined {
    fn root(&mut self, mut place: u32) -> u32 {
        while self.0[place as usize] != place {
            let above = self.0[self.0[place as usize] as usize];
            self.0[place as usize] = above;
            place = above;
        }
        place
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
