//! A flat wall.

use super::boundary::{BoundaryFace, Carrier};
use super::creases::Creases;
use super::mirror::{Ground, Mirror, Side};
use super::patch::Patch;
use super::polygon;
use super::screen::Screen;
use super::smooth::Surface;
use nalgebra::Vector3;

/// Share of a wall's rectangle that its faces fill, if they fill it.
const FILLED: f64 = 0.999;

/// A flat piece of the boundary.
#[derive(Debug)]
pub(super) struct FlatWall {
    normal: Vector3<f64>,
    offset: f64,
    /// Corners of its extent [m].
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Ground below all of it, where that is one and the faces fill the extent.
    even: Option<Ground>,
    patch: Patch,
    /// The faces of the boundary.
    faces: Vec<u32>,
    /// Corners of each face; empty where the ground is even.
    polygons: Vec<Vec<Vector3<f64>>>,
    ground: Vec<Ground>,
    deepest: f64,
    flatness: f64,
    rims: Creases,
}

impl FlatWall {
    /// A wall of faces, if they are flat.
    pub(super) fn new(surface: &Surface<'_>, faces: &[u32]) -> Option<Self> {
        let all = surface.boundary.faces();
        let carrier = surface.boundary.carrier();
        let flatness = carrier.flatness();
        let first = &all[faces[0] as usize];
        let (normal, offset, size) = (first.normal, first.normal.dot(&first.centre), first.area.sqrt());
        let members = || faces.iter().map(|&face| &all[face as usize]);
        let in_plane = |face: &BoundaryFace| {
            (face.normal - normal).norm() < flatness
                && (normal.dot(&face.centre) - offset).abs() < flatness * size
        };
        if !members().all(in_plane) {
            return None;
        }
        let polygon = |&face: &u32| surface.boundary.corners_of(face as usize).to_vec();
        let polygons: Vec<Vec<Vector3<f64>>> = faces.iter().map(polygon).collect();
        let (mut low, mut high) = (first.centre, first.centre);
        for corner in polygons.iter().flatten() {
            (low, high) = (low.inf(corner), high.sup(corner));
        }
        let extent = high - low;
        let across = normal.iamax();
        let rectangle: f64 = (0..3).filter(|axis| *axis != across).map(|axis| extent[axis]).product();
        let area: f64 = members().map(|face| face.area).sum();
        let filled = (normal[across].abs() - 1.0).abs() < flatness && area > FILLED * rectangle;
        let ground: Vec<Ground> = faces.iter().map(|&face| surface.ground(face)).collect();
        let deepest = ground.iter().map(|ground| ground.depth).fold(0.0, f64::max);
        let rims = Creases::rims_of(surface.boundary, surface.edges, faces, surface.reach);
        // Facets are each asked for.
        let is_even = carrier == Carrier::Cells
            && filled
            && rims.is_empty()
            && ground.iter().all(|other| other.is_like(&ground[0]));
        // Feet lie on the plane to rounding only.
        let slack = Vector3::repeat(flatness * size);
        Some(Self {
            normal,
            offset,
            low: low - slack,
            high: high + slack,
            even: is_even.then_some(ground[0]),
            patch: Patch::new(all, faces, 0.0),
            faces: faces.to_vec(),
            flatness,
            polygons: if is_even { Vec::new() } else { polygons },
            ground,
            deepest,
            rims,
        })
    }

    /// Mirrors a charge at a point, with depths scaled.
    pub(super) fn mirror(&self, point: &Vector3<f64>, depth_scale: f64) -> Option<Mirror> {
        let distance = self.offset - self.normal.dot(point);
        if !(0.0..depth_scale * self.deepest).contains(&distance) {
            return None;
        }
        let foot = point + self.normal * distance;
        if (0..3).any(|axis| foot[axis] < self.low[axis] || foot[axis] > self.high[axis]) {
            return None;
        }
        let (ground, face) = match self.even {
            Some(ground) => (ground, None),
            None => {
                let face = self.face_under(&foot)?;
                (self.ground[face], Some(self.faces[face]))
            }
        };
        let ground = ground.deeper(depth_scale);
        if distance >= ground.depth {
            return None;
        }
        let side = Side::of(&ground, &self.rims, &foot, &self.normal, distance)?;
        let plane = || Screen::Plane { normal: self.normal, offset: self.offset };
        Some(Mirror {
            face,
            normal: self.normal,
            offset: self.offset,
            distance,
            curvature: 0.0,
            depth: ground.depth,
            share: side.share(&ground),
            screened: side.screened(&ground, plane),
        })
    }

    /// The face on which a point of the wall's plane lies.
    fn face_under(&self, foot: &Vector3<f64>) -> Option<usize> {
        let slack = self.flatness * (self.high - self.low).max();
        let mut near = self.patch.near(foot);
        near.find(|&face| polygon::holds(&self.polygons[face], &self.normal, foot, slack))
    }
}
