//! Boundary faces by their place.

use super::boundary::BoundaryFace;
use super::buckets::Buckets;
use nalgebra::Vector3;

/// Faces of one wall in buckets.
#[derive(Debug)]
pub(super) struct Patch {
    buckets: Buckets,
    /// Place and size of each face of the patch.
    faces: Vec<Place>,
}

/// Place and size of a face.
#[derive(Clone, Copy, Debug)]
struct Place {
    centre: Vector3<f64>,
    half_diagonal: f64,
}

impl Patch {
    /// Makes a patch of some faces; a search finds those up to `reach` [m] away.
    pub(super) fn new(all: &[BoundaryFace], members: &[u32], reach: f64) -> Self {
        let place = |&face: &u32| {
            let face = &all[face as usize];
            Place { centre: face.centre, half_diagonal: half_diagonal(face) }
        };
        let faces: Vec<_> = members.iter().map(place).collect();
        let edge = faces.iter().fold(reach, |edge, face| edge.max(2.5 * face.half_diagonal));
        Self { buckets: Buckets::new(faces.iter().map(|face| &face.centre), edge), faces }
    }

    /// Distance up to which a search finds every face [m].
    pub(super) fn reach(&self) -> f64 {
        self.buckets.reach()
    }

    /// Faces of the patch, by their number in it, whose centres may be as near to a point as a search
    /// reaches.
    pub(super) fn near(&self, point: &Vector3<f64>) -> impl Iterator<Item = usize> + '_ {
        self.buckets.near(point)
    }

    /// The face whose centre is nearest to a point, if any is within reach.
    pub(super) fn nearest(&self, point: &Vector3<f64>) -> Option<usize> {
        let distance = |face: &usize| (self.faces[*face].centre - point).norm_squared();
        self.near(point).min_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)))
    }
}

/// Half the diagonal of a face that is a rectangle [m].
pub(super) fn half_diagonal(face: &BoundaryFace) -> f64 {
    face.spread.trace().sqrt()
}
