//! Boundary faces by their place.

use crate::levels::far::mesh::BoundaryFace;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Distance from a face's centre over half its diagonal up to which a point is on it: faces need not be
/// rectangles.
const ON_FACE: f64 = 1.2;

/// Faces of one wall in buckets.
#[derive(Debug)]
pub(super) struct Patch {
    edge: f64,
    buckets: HashMap<[i64; 3], Vec<u32>>,
    /// Centre and half the diagonal of each face of the patch [m].
    faces: Vec<(Vector3<f64>, f64)>,
}

impl Patch {
    /// Makes a patch of some faces; a search finds those up to `reach` [m] away.
    pub(super) fn new(all: &[BoundaryFace], members: &[u32], reach: f64) -> Self {
        let faces: Vec<_> = members
            .iter()
            .map(|&face| {
                let face = &all[face as usize];
                (face.centre, half_diagonal(face))
            })
            .collect();
        let edge = faces.iter().fold(reach, |edge, (_, half)| edge.max(2.5 * half));
        let mut buckets: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
        for (index, (centre, _)) in faces.iter().enumerate() {
            buckets.entry(bucket(centre, edge)).or_default().push(index as u32);
        }
        Self { edge, buckets, faces }
    }

    /// Faces of the patch, by their number in it, whose centres may be as near to a point as a search
    /// reaches.
    pub(super) fn near(&self, point: &Vector3<f64>) -> impl Iterator<Item = usize> + '_ {
        let [x, y, z] = bucket(point, self.edge);
        let around = (-1..=1)
            .flat_map(move |i| (-1..=1).flat_map(move |j| (-1..=1).map(move |k| [x + i, y + j, z + k])));
        around.filter_map(|place| self.buckets.get(&place)).flatten().map(|&face| face as usize)
    }

    /// The face whose centre is nearest to a point, if any is within reach.
    pub(super) fn nearest(&self, point: &Vector3<f64>) -> Option<usize> {
        let distance = |face: &usize| (self.faces[*face].0 - point).norm_squared();
        self.near(point).min_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)))
    }

    /// Whether a point of the wall's surface lies on one of its faces.
    pub(super) fn covers(&self, foot: &Vector3<f64>) -> bool {
        self.nearest(foot).is_some_and(|face| {
            let (centre, half) = self.faces[face];
            (centre - foot).norm() <= ON_FACE * half
        })
    }
}

/// Half the diagonal of a face that is a rectangle [m].
pub(super) fn half_diagonal(face: &BoundaryFace) -> f64 {
    face.spread.trace().sqrt()
}

fn bucket(point: &Vector3<f64>, edge: f64) -> [i64; 3] {
    #[expect(clippy::cast_possible_truncation, reason = "a mesh has not so many buckets")]
    let index = |x: f64| (x / edge).floor() as i64;
    [index(point.x), index(point.y), index(point.z)]
}
