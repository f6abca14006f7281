//! Search for a place: its cell, and its tetrahedron there.

use super::block::{Block, EVEN};
use super::{InTetrahedron, Inside, Nodes};
use amberfield_core::Vector3;
use amberfield_field::far::{FarMesh, Neighbour};

/// Least volume of a tetrahedron over its cell's: a flatter one holds no grain.
const FLAT: f64 = 1e-9;
/// Distance beyond a face at which a point is still on it, over the face's distance from the cell's centre;
/// of a parallelepiped and of another cell.
const ON_BLOCK: f64 = EVEN;
const ON_FACE: f64 = 1e-9;
/// Cells of a walk at most.
const LONGEST_WALK: usize = 20;

/// Face ahead of a point as a cell's centre sees it.
#[derive(Clone, Copy)]
struct Ahead {
    /// Distance of the point along the face's normal over that of the face; above 1 the point is beyond it.
    ahead: f64,
    /// Number of the face among the cell's.
    number: usize,
}

impl Ahead {
    /// Face ahead of a place seen from the centre of a parallelepiped [m].
    #[inline(always)]
    fn of_block(block: &Block, from: &Vector3<f64>) -> Self {
        let at = block.coordinates(from);
        let ahead = at.amax();
        Self { ahead, number: if ahead > 1.0 { block.face(&at) } else { 0 } }
    }

    /// Whether the place is beyond the face by more than may be left out.
    fn is_beyond(&self, block: Option<&Block>) -> bool {
        self.ahead > 1.0 + if block.is_some() { ON_BLOCK } else { ON_FACE }
    }
}

impl Nodes {
    /// Cell of a point [m] that is in a cell or near it, and where it is there.
    ///
    /// Beyond a wall it is that of the point on it towards the cell's centre.
    #[inline]
    pub(in super::super) fn at(&self, mesh: &FarMesh, point: &Vector3<f64>, cell: u32) -> (usize, Inside) {
        let (mut cell, mut point) = (cell as usize, *point);
        let mut from = point - self.centres[cell];
        let mut block = self.blocks[cell].as_ref();
        let mut face = self.ahead(cell, &from);
        for _ in 0..LONGEST_WALK {
            if !face.is_beyond(block) {
                break;
            }
            let crossed = &mesh.faces_of(cell)[face.number];
            let Neighbour::Cell { cell: other, shift } = crossed.neighbour else { break };
            (cell, point) = (other as usize, point - shift);
            from = point - self.centres[cell];
            block = self.blocks[cell].as_ref();
            face = self.ahead(cell, &from);
        }
        from /= face.ahead.max(1.0);
        let inside = match block {
            Some(block) => Inside::Block(block.coordinates(&from)),
            None => Inside::Tetrahedron(self.tetrahedron_at(cell, face.number, &from)),
        };
        (cell, inside)
    }

    /// Face through which a ray from the centre of a convex cell to a place seen from there [m] leaves it.
    #[inline(always)]
    fn ahead(&self, cell: usize, from: &Vector3<f64>) -> Ahead {
        if let Some(block) = &self.blocks[cell] {
            return Ahead::of_block(block, from);
        }
        let mut face = Ahead { ahead: f64::NEG_INFINITY, number: 0 };
        for (number, outwards) in self.outwards[self.faces(cell)].iter().enumerate() {
            let ahead = outwards.dot(from);
            face.number = if ahead > face.ahead { number } else { face.number };
            face.ahead = ahead.max(face.ahead);
        }
        face
    }

    /// Tetrahedron of a cell that holds a place seen from its centre [m], with a face ahead of it.
    fn tetrahedron_at(&self, cell: usize, number: usize, from: &Vector3<f64>) -> InTetrahedron {
        let face = self.first_face[cell] as usize + number;
        let inside = self.quick(cell, face, from).or_else(|| self.best(cell, from));
        inside.unwrap_or(InTetrahedron { face, corner: 0, weights: [1.0, 0.0, 0.0, 0.0] })
    }

    /// Tetrahedron of a face that holds a place seen from the cell's centre [m].
    fn quick(&self, cell: usize, face: usize, from: &Vector3<f64>) -> Option<InTetrahedron> {
        // The place is beside the plane of centre, face's centre and corner by as much as this says.
        let across = self.to_face[face].cross(from);
        let (corners, to_corner) = (self.corners(face), &self.to_corner[self.of_cell(cell)]);
        let beside = |&corner: &u16| across.dot(&to_corner[corner as usize]);
        // The place is where one corner is on its one side and the next on its other.
        let last = corners.len() - 1;
        let (mut corner, mut before, mut is_before) = (0, last, beside(&corners[last]) <= 0.0);
        for (number, point) in corners.iter().enumerate() {
            let here = beside(point);
            // A choice without a branch, which nothing could foretell.
            corner = if is_before & (here >= 0.0) { before } else { corner };
            (before, is_before) = (number, here <= 0.0);
        }
        let [a, b, c] = self.tetrahedron(cell, face, corner).edges;
        let normal = b.cross(&c);
        let per_volume = 1.0 / a.dot(&normal);
        let of_face = from.dot(&normal) * per_volume;
        let one = across.dot(&c) * per_volume;
        let two = -across.dot(&b) * per_volume;
        let weights = [1.0 - of_face - one - two, of_face, one, two];
        // Of a flat one these are no numbers, or large ones of either sign.
        weights.iter().all(|&weight| weight >= 0.0).then_some(InTetrahedron { face, corner, weights })
    }

    /// Tetrahedron of a cell that a place is least outside of.
    fn best(&self, cell: usize, from: &Vector3<f64>) -> Option<InTetrahedron> {
        let (mut nearest, mut best) = (f64::NEG_INFINITY, None);
        for face in self.faces(cell) {
            for corner in 0..self.corners(face).len() {
                let tetrahedron = self.tetrahedron(cell, face, corner);
                if tetrahedron.volume() < FLAT * self.volumes[cell] {
                    continue;
                }
                let weights = tetrahedron.coordinates(from);
                let least = weights.iter().copied().fold(f64::INFINITY, f64::min);
                if least > nearest {
                    (nearest, best) = (least, Some(InTetrahedron { face, corner, weights }));
                }
            }
        }
        best.map(|inside| {
            let weights = inside.weights.map(|weight| weight.max(0.0));
            let sum: f64 = weights.iter().sum();
            InTetrahedron { weights: weights.map(|weight| weight / sum), ..inside }
        })
    }
}
