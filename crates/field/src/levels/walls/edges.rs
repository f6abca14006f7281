//! Edges of the boundary's faces: which two faces meet there, and the angle of the mesh between them.
//!
//! The angle is π where a wall goes on, less in a corner that holds grains, more at the edge of a body, and
//! 2π at the rim of a sheet without thickness. It is found by turning around the edge from one face through
//! the mesh to the next, so that both sides of a sheet, whose faces have the same edges, stay apart.

use super::boundary::BoundaryFaces;
use amberfield_core::{Axis, Domain};
use nalgebra::Vector3;
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// Distance up to which two corners are one, over the smallest cell.
const SAME_CORNER: f64 = 1e-4;
/// Angle below which two faces lie on each other, back to back [rad].
const BACK_TO_BACK: f64 = 0.02;

/// Edge at which two boundary faces meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    /// Ends [m].
    pub(super) ends: [Vector3<f64>; 2],
    /// The two faces.
    pub(super) faces: [u32; 2],
    /// Directions from the edge into the two faces, in their planes.
    pub(super) into: [Vector3<f64>; 2],
    /// Angle of the mesh between the faces [rad].
    pub(super) angle: f64,
}

/// One face at an edge.
struct Leaf {
    face: u32,
    ends: [Vector3<f64>; 2],
    /// Direction from the lower to the higher numbered corner.
    along: Vector3<f64>,
    /// Direction into the face.
    into: Vector3<f64>,
    /// +1 where turning about `along` from the face leads into the mesh.
    turn: f64,
}

impl Leaf {
    /// Angle from this face through the mesh to another [rad]; `None` where the other is not met from its
    /// own inside.
    fn angle_to(&self, other: &Self) -> Option<f64> {
        if self.turn == other.turn {
            return None;
        }
        let across = self.into.cross(&other.into).dot(&self.along) * self.turn;
        let angle = across.atan2(self.into.dot(&other.into));
        Some(if angle < BACK_TO_BACK { angle + TAU } else { angle })
    }
}

/// All edges at which two faces of a boundary meet.
pub(super) fn edges(boundary: &dyn BoundaryFaces) -> Vec<Edge> {
    let mut corners = Corners::new(boundary);
    let mut leaves: HashMap<[u32; 2], Vec<Leaf>> = HashMap::new();
    let mut order = Vec::new();
    for (number, face) in boundary.faces().iter().enumerate() {
        let around = boundary.corners_of(number);
        let numbers: Vec<u32> = around.iter().map(|corner| corners.number(corner)).collect();
        for from in 0..around.len() {
            let to = (from + 1) % around.len();
            let (low, high) = if numbers[from] < numbers[to] { (from, to) } else { (to, from) };
            let ends = [around[low], around[high]];
            let Some(along) = (ends[1] - ends[0]).try_normalize(0.0) else { continue };
            let inwards = face.centre - ends[0];
            let Some(into) = (inwards - along * along.dot(&inwards)).try_normalize(0.0) else { continue };
            let turn = -into.cross(&face.normal).dot(&along).signum();
            let key = [numbers[low], numbers[high]];
            let leaf = Leaf { face: number as u32, ends, along, into, turn };
            leaves.entry(key).or_insert_with(|| {
                order.push(key);
                Vec::new()
            });
            leaves.get_mut(&key).expect("just made").push(leaf);
        }
    }
    order.iter().flat_map(|key| pairs(&leaves[key])).collect()
}

/// Pairs of faces that the mesh lies between.
fn pairs(leaves: &[Leaf]) -> Vec<Edge> {
    let first = leaves.iter().filter(|leaf| leaf.turn > 0.0);
    let next = |leaf: &Leaf| {
        let angles = leaves.iter().filter_map(|other| Some((leaf.angle_to(other)?, other)));
        let (angle, other) = angles.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let (faces, into) = ([leaf.face, other.face], [leaf.into, other.into]);
        Some(Edge { ends: leaf.ends, faces, into, angle })
    };
    first.filter_map(next).collect()
}

impl Edge {
    /// Angle by which the edge differs from a wall that goes on [rad]; positive around a body.
    pub(super) fn bend(&self) -> f64 {
        self.angle - PI
    }
}

/// Numbers of the boundary's corners; corners at one place, or one period apart, have one number.
pub(super) struct Corners<'a> {
    domain: &'a Domain,
    tolerance: f64,
    numbers: HashMap<[i64; 3], Vec<u32>>,
    places: Vec<Vector3<f64>>,
}

impl<'a> Corners<'a> {
    pub(super) fn new(boundary: &'a dyn BoundaryFaces) -> Self {
        let (domain, tolerance) = (boundary.domain(), SAME_CORNER * boundary.smallest_cell());
        Self { domain, tolerance, numbers: HashMap::new(), places: Vec::new() }
    }

    /// Number of a corner [m].
    pub(super) fn number(&mut self, corner: &Vector3<f64>) -> u32 {
        let domain = self.domain;
        let mut place = domain.wrap(*corner);
        for axis in Axis::ALL.into_iter().filter(|axis| domain.is_periodic(*axis)).map(Axis::index) {
            // A corner on the upper face of a period is one on the lower.
            if domain.max()[axis] - place[axis] < self.tolerance {
                place[axis] -= domain.extent()[axis];
            }
        }
        let bin = place.map(|x| {
            #[expect(clippy::cast_possible_truncation, reason = "a mesh has not so many corners")]
            let bin = (x / (4.0 * self.tolerance)).floor() as i64;
            bin
        });
        for offset in 0..27 {
            let near = [offset % 3, offset / 3 % 3, offset / 9].map(|step: i64| step - 1);
            let key = [bin.x + near[0], bin.y + near[1], bin.z + near[2]];
            let known = self.numbers.get(&key).into_iter().flatten();
            let same = |number: &&u32| (self.places[**number as usize] - place).norm() < self.tolerance;
            if let Some(number) = known.copied().collect::<Vec<_>>().iter().find(same) {
                return *number;
            }
        }
        let number = self.places.len() as u32;
        self.places.push(place);
        self.numbers.entry([bin.x, bin.y, bin.z]).or_default().push(number);
        number
    }
}
