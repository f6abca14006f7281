//! A flat wall.

use super::patch::{Patch, half_diagonal};
use super::{FLAT, Mirror};
use crate::levels::far::mesh::{BoundaryFace, FarMesh};
use nalgebra::Vector3;

/// Share of its extent from which on a wall fills it.
const FILLED: f64 = 0.999;

/// A flat piece of the boundary.
#[derive(Debug)]
pub(super) struct FlatWall {
    normal: Vector3<f64>,
    offset: f64,
    /// Corners of its extent [m].
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Faces of the wall, where they do not fill their extent.
    patch: Option<Patch>,
    /// Deepest charge that it mirrors [m].
    depth: f64,
}

impl FlatWall {
    /// A wall of faces, if they are flat.
    pub(super) fn new(mesh: &FarMesh, faces: &[u32], depth: f64) -> Option<Self> {
        let all = mesh.boundary();
        let first = &all[faces[0] as usize];
        let (normal, offset, size) = (first.normal, first.normal.dot(&first.centre), first.area.sqrt());
        let members = || faces.iter().map(|&face| &all[face as usize]);
        let in_plane = |face: &BoundaryFace| {
            (face.normal - normal).norm() < FLAT && (normal.dot(&face.centre) - offset).abs() < FLAT * size
        };
        if !members().all(in_plane) {
            return None;
        }
        let (mut low, mut high) = (first.centre, first.centre);
        for face in members() {
            let reach = Vector3::repeat(half_diagonal(face));
            low = low.inf(&(face.centre - reach));
            high = high.sup(&(face.centre + reach));
        }
        let domain = mesh.domain();
        (low, high) = (low.sup(&domain.min()), high.inf(&domain.max()));
        let extent = high - low;
        let across = normal.iamax();
        let rectangle: f64 = (0..3).filter(|axis| *axis != across).map(|axis| extent[axis]).product();
        let area: f64 = members().map(|face| face.area).sum();
        let filled = (normal[across].abs() - 1.0).abs() < FLAT && area > FILLED * rectangle;
        let along: f64 = (0..3).map(|axis| (normal[axis] * domain.extent()[axis]).abs()).sum();
        // Feet lie on the plane to rounding only.
        let slack = Vector3::repeat(FLAT * size);
        Some(Self {
            normal,
            offset,
            low: low - slack,
            high: high + slack,
            patch: (!filled).then(|| Patch::new(all, faces, 0.0)),
            depth: depth.min(super::OF_GAP * along),
        })
    }

    /// Mirrors a charge at a point.
    pub(super) fn mirror(&self, point: &Vector3<f64>) -> Option<Mirror> {
        let distance = self.offset - self.normal.dot(point);
        if !(0.0..self.depth).contains(&distance) {
            return None;
        }
        let foot = point + self.normal * distance;
        let beside = (0..3).any(|axis| foot[axis] < self.low[axis] || foot[axis] > self.high[axis]);
        if beside || self.patch.as_ref().is_some_and(|patch| !patch.covers(&foot)) {
            return None;
        }
        Some(Mirror { normal: self.normal, offset: self.offset, distance, curvature: 0.0, depth: self.depth })
    }
}
