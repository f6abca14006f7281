//! A tree of the cells' boxes: which cells may hold a point, whatever walls stand between them.

use super::mesh::FarMeshParts;
use super::reentrant::ReentrantEdges;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Cells of a leaf at most.
const LEAF: usize = 4;
/// Nodes that wait to be looked at: one of each level of a tree of 2³² cells, and some.
const MOST_WAITING: usize = 64;
/// Distance by which a cell's faces are moved outwards before its corners are sought, over its size: faces
/// whose corners do not lie in one plane have none that fit all planes.
const SLACK: f64 = 0.05;
/// Sine of the angle of two faces, or of a face and an edge, that count as parallel.
const PARALLEL: f64 = 1e-6;
/// Longest edge of a cell whose faces meet in a re-entrant edge, over its size.
const LONGEST_EDGE: f64 = 6.0;

/// Box along the axes.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl Bounds {
    const NOWHERE: Self = Self {
        low: Vector3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
        high: Vector3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
    };

    fn with(&self, point: &Vector3<f64>) -> Self {
        Self { low: self.low.inf(point), high: self.high.sup(point) }
    }

    fn and(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }

    /// Distance of a point outside [m]; 0 inside.
    fn distance(&self, point: &Vector3<f64>) -> f64 {
        (self.low - point).sup(&(point - self.high)).sup(&Vector3::zeros()).norm()
    }
}

/// Node of the tree: a leaf has cells, others have one child that follows and one at `other`.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    first: u32,
    cells: u32,
    other: u32,
}

/// Cell that suits a point best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BestCell {
    pub(super) cell: u32,
    /// Distance of the point beyond the cell's faces [m]; negative inside.
    pub(super) beyond: f64,
}

impl BestCell {
    /// The better one; of two that are as good, that with the smaller number.
    pub(super) fn or(self, other: Self) -> Self {
        let better = other.beyond < self.beyond || other.beyond == self.beyond && other.cell < self.cell;
        if better { other } else { self }
    }
}

/// Tree of the cells' boxes.
#[derive(Clone, Debug)]
pub(super) struct CellTree {
    nodes: Vec<Node>,
    cells: Vec<u32>,
}

impl CellTree {
    /// Makes the tree of a mesh's cells.
    pub(super) fn new(parts: &FarMeshParts, reentrant: &ReentrantEdges) -> Self {
        let cells = (0..parts.centres.len()).into_par_iter();
        let boxes: Vec<Bounds> = cells.map(|cell| bounds_of(parts, reentrant, cell)).collect();
        let mut tree = Self { nodes: Vec::new(), cells: (0..boxes.len() as u32).collect() };
        let mut cells = std::mem::take(&mut tree.cells);
        tree.grow(&boxes, &mut cells, 0);
        tree.cells = cells;
        tree
    }

    /// Adds the nodes of some cells, which stand from `first` on among all, and sorts them.
    fn grow(&mut self, boxes: &[Bounds], cells: &mut [u32], first: usize) {
        let bounds = cells.iter().fold(Bounds::NOWHERE, |bounds, &cell| bounds.and(&boxes[cell as usize]));
        let node = self.nodes.len();
        self.nodes.push(Node { bounds, first: first as u32, cells: cells.len() as u32, other: 0 });
        if cells.len() <= LEAF {
            return;
        }
        let middle =
            |cell: u32, axis: usize| boxes[cell as usize].low[axis] + boxes[cell as usize].high[axis];
        let axis = (bounds.high - bounds.low).imax();
        let half = cells.len() / 2;
        cells.select_nth_unstable_by(half, |a, b| {
            middle(*a, axis).total_cmp(&middle(*b, axis)).then(a.cmp(b))
        });
        let (lower, upper) = cells.split_at_mut(half);
        self.grow(boxes, lower, first);
        let other = self.nodes.len() as u32;
        self.nodes[node] = Node { other, cells: 0, ..self.nodes[node] };
        self.grow(boxes, upper, first + half);
    }

    /// The cell beyond whose faces a point [m] is least, `beyond` being that distance [m].
    pub(super) fn best(&self, point: &Vector3<f64>, beyond: impl Fn(u32) -> f64) -> BestCell {
        let mut best = BestCell { cell: 0, beyond: f64::INFINITY };
        let mut waiting = [0_u32; MOST_WAITING];
        let mut count = 1;
        while count > 0 {
            count -= 1;
            let index = waiting[count] as usize;
            let node = &self.nodes[index];
            // Of a cell that holds the point there may be a better one only around the point.
            if node.bounds.distance(point) > best.beyond.max(0.0) {
                continue;
            }
            if node.cells > 0 {
                let cells = &self.cells[node.first as usize..(node.first + node.cells) as usize];
                for &cell in cells {
                    best = best.or(BestCell { cell, beyond: beyond(cell) });
                }
                continue;
            }
            let children = [index as u32 + 1, node.other];
            let [one, two] = children.map(|child| self.nodes[child as usize].bounds.distance(point));
            let [nearer, farther] = if one <= two { children } else { [node.other, index as u32 + 1] };
            (waiting[count], waiting[count + 1]) = (farther, nearer);
            count += 2;
        }
        best
    }
}

/// Box of a cell: its corners are the ends of the lines in which two of its faces' planes meet, where all
/// other planes let them.
fn bounds_of(parts: &FarMeshParts, reentrant: &ReentrantEdges, cell: usize) -> Bounds {
    let faces = &parts.faces[parts.first_face[cell] as usize..parts.first_face[cell + 1] as usize];
    let centre = &parts.centres[cell];
    let size = parts.volumes[cell].cbrt();
    // A face that bounds the cell only together with another does not cut it off everywhere.
    let alone = |face: &usize| reentrant.of(cell).iter().all(|pair| pair.beside(*face).is_none());
    let planes: Vec<Plane> = (0..faces.len())
        .filter(alone)
        .map(|face| {
            let normal = faces[face].normal;
            Plane { normal, room: faces[face].offset - normal.dot(centre) + SLACK * size }
        })
        .collect();
    let longest = if planes.len() == faces.len() {
        parts.domain.extent().norm().min(f64::MAX)
    } else {
        LONGEST_EDGE * size
    };
    let mut bounds = Bounds::NOWHERE.with(centre);
    for (first, a) in planes.iter().enumerate() {
        for b in &planes[first + 1..] {
            let along = a.normal.cross(&b.normal);
            if along.norm() < PARALLEL {
                continue;
            }
            let start =
                (b.normal.cross(&along) * a.room + along.cross(&a.normal) * b.room) / along.norm_squared();
            let along = along.normalize();
            let (mut from, mut to) = (-longest, longest);
            for plane in &planes {
                let (slope, room) = (plane.normal.dot(&along), plane.room - plane.normal.dot(&start));
                if slope > PARALLEL {
                    to = to.min(room / slope);
                } else if slope < -PARALLEL {
                    from = from.max(room / slope);
                } else if room < -PARALLEL * size {
                    to = f64::NEG_INFINITY;
                }
            }
            if from <= to {
                bounds = bounds.with(&(centre + start + along * from)).with(&(centre + start + along * to));
            }
        }
    }
    bounds
}

/// Plane of a face, moved outwards: points from the cell's centre whose product with the normal is `room`.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: Vector3<f64>,
    room: f64,
}
