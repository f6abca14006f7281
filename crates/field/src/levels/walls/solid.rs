//! Surroundings of each boundary face: the size of the cells there, and how thick the solid behind it is.

use super::boundary::BoundaryFaces;
use super::patch::Patch;
use super::polygon;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Distance up to which another side is looked for, over the size of the cells.
const LOOK: f64 = 10.0;
/// Part of a face's size by which a line of sight may miss its edge, or begin behind it.
const SLACK: f64 = 1e-3;

/// Surroundings of one boundary face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Surroundings {
    /// Size of the largest cell at the face and beside it, the cube root of the volume [m].
    pub(super) cell: f64,
    /// Thickness of the solid behind the face, up to the next place of grains [m]; infinite where none is
    /// near.
    pub(super) solid: f64,
    /// Distance to the wall in front of the face [m]; infinite where none is near.
    pub(super) gap: f64,
}

/// Surroundings of all boundary faces.
pub(super) fn surroundings(boundary: &dyn BoundaryFaces) -> Vec<Surroundings> {
    let faces = boundary.faces();
    let all: Vec<u32> = (0..faces.len() as u32).collect();
    let patch = Patch::new(faces, &all, 0.0);
    let of_face = |face: usize| {
        let cell = boundary.cell_around(face);
        let normal = faces[face].normal;
        let look = Look { boundary, patch: &patch, face, farthest: LOOK * cell };
        Surroundings {
            cell,
            solid: look.along(&normal, boundary.least_solid(face)),
            gap: look.along(&-normal, boundary.least_gap(face)),
        }
    };
    (0..faces.len()).into_par_iter().map(of_face).collect()
}

/// Line of sight from the centre of a boundary face.
struct Look<'a> {
    boundary: &'a dyn BoundaryFaces,
    patch: &'a Patch,
    face: usize,
    farthest: f64,
}

impl Look<'_> {
    /// Distance to the first boundary face that is seen from the side on which the line travels, beyond a
    /// least distance [m].
    fn along(&self, direction: &Vector3<f64>, least: f64) -> f64 {
        let from = self.boundary.faces()[self.face].centre;
        let step = self.patch.reach();
        let mut nearest = f64::INFINITY;
        let mut reached = 0.0;
        // Outwards a line meets faces from behind, inwards from the front: both against their own sense.
        let outwards = direction.dot(&self.boundary.faces()[self.face].normal);
        while reached < self.farthest && nearest > reached {
            let place = from + direction * reached;
            let wrapped = self.boundary.domain().wrap(place);
            for other in self.patch.near(&wrapped).filter(|other| *other != self.face) {
                let distance = self.distance(other, &(from + wrapped - place), direction, outwards);
                if distance > least {
                    nearest = nearest.min(distance);
                }
            }
            reached += step;
        }
        if nearest <= self.farthest { nearest } else { f64::INFINITY }
    }

    /// Distance to one face along the line; infinite where the line misses it.
    fn distance(&self, other: usize, from: &Vector3<f64>, direction: &Vector3<f64>, outwards: f64) -> f64 {
        let face = &self.boundary.faces()[other];
        let towards = face.normal.dot(direction);
        let size = face.area.sqrt();
        let distance = face.normal.dot(&(face.centre - from)) / towards;
        if towards * outwards > -SLACK || distance < -SLACK * size {
            return f64::INFINITY;
        }
        let at = from + direction * distance;
        let is_hit = polygon::holds(self.boundary.corners_of(other), &face.normal, &at, SLACK * size);
        if is_hit { distance.max(0.0) } else { f64::INFINITY }
    }
}
