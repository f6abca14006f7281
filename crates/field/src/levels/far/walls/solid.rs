//! Surroundings of each boundary face: the size of the cells there, and how thick the solid behind it is.

use super::patch::Patch;
use crate::levels::far::mesh::{BoundaryFace, FarMesh, Neighbour};
use crate::levels::far::polygon;
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
    /// Thickness of the solid behind the face, up to the next place of the mesh [m]; infinite where none is
    /// near.
    pub(super) solid: f64,
    /// Distance to the wall in front of the face [m]; infinite where none is near.
    pub(super) gap: f64,
}

/// Surroundings of all boundary faces.
pub(super) fn surroundings(mesh: &FarMesh) -> Vec<Surroundings> {
    let all: Vec<u32> = (0..mesh.boundary().len() as u32).collect();
    let patch = Patch::new(mesh.boundary(), &all, 0.0);
    let of_face = |face: usize| {
        let cell = cell_size(mesh, mesh.boundary()[face].cell as usize);
        let BoundaryFace { normal, centre, cell: inside, .. } = mesh.boundary()[face];
        let look = Look { mesh, patch: &patch, face, farthest: LOOK * cell };
        // The face's own cell is in front of it; the back of a sheet without thickness is not.
        let depth = normal.dot(&(centre - mesh.centres()[inside as usize]));
        Surroundings { cell, solid: look.along(&normal, f64::NEG_INFINITY), gap: look.along(&-normal, depth) }
    };
    (0..mesh.boundary().len()).into_par_iter().map(of_face).collect()
}

/// Largest size of a cell and of those beside it [m].
fn cell_size(mesh: &FarMesh, cell: usize) -> f64 {
    let beside = mesh.faces_of(cell).iter().filter_map(|face| match face.neighbour {
        Neighbour::Cell { cell, .. } => Some(cell as usize),
        Neighbour::Boundary(_) => None,
    });
    beside.chain([cell]).map(|cell| mesh.volumes()[cell].cbrt()).fold(0.0, f64::max)
}

/// Line of sight from the centre of a boundary face.
struct Look<'a> {
    mesh: &'a FarMesh,
    patch: &'a Patch,
    face: usize,
    farthest: f64,
}

impl Look<'_> {
    /// Distance to the first boundary face that is seen from the side on which the line travels, beyond a
    /// least distance [m].
    fn along(&self, direction: &Vector3<f64>, least: f64) -> f64 {
        let from = self.mesh.boundary()[self.face].centre;
        let step = self.patch.reach();
        let mut nearest = f64::INFINITY;
        let mut reached = 0.0;
        // Outwards a line meets faces from behind, inwards from the front: both against their own sense.
        let outwards = direction.dot(&self.mesh.boundary()[self.face].normal);
        while reached < self.farthest && nearest > reached {
            let place = from + direction * reached;
            let wrapped = self.mesh.domain().wrap(place);
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
        let face = &self.mesh.boundary()[other];
        let towards = face.normal.dot(direction);
        let size = face.area.sqrt();
        let distance = face.normal.dot(&(face.centre - from)) / towards;
        if towards * outwards > -SLACK || distance < -SLACK * size {
            return f64::INFINITY;
        }
        let at = from + direction * distance;
        let is_hit = polygon::holds(self.mesh.corners_of(other), &face.normal, &at, SLACK * size);
        if is_hit { distance.max(0.0) } else { f64::INFINITY }
    }
}
