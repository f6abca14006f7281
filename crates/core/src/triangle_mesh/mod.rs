//! Surfaces of triangles, and finer ones with the same shape.

mod smooth;
mod split;

pub use smooth::{SMOOTH_ANGLE, SmoothPatch};

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// A surface of triangles.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TriangleMesh {
    /// Distinct vertices [m].
    pub vertices: Vec<Vector3<f64>>,
    /// Vertex indices of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriangleMesh {
    /// Lower and upper corner of the box around the vertices [m]; `None` without vertices.
    #[must_use]
    pub fn bounds(&self) -> Option<[Vector3<f64>; 2]> {
        let first = *self.vertices.first()?;
        let around = |[low, high]: [Vector3<f64>; 2], x: &Vector3<f64>| [low.inf(x), high.sup(x)];
        Some(self.vertices.iter().fold([first; 2], around))
    }

    /// Size of a triangle of this area [m²]: the edge of the equilateral one [m].
    #[must_use]
    pub fn size_of(area: f64) -> f64 {
        (4.0 / 3.0_f64.sqrt() * area).sqrt()
    }

    /// Size of each triangle [m], see [`Self::size_of`].
    pub fn sizes(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        self.triangles.iter().map(|triangle| {
            let [a, b, c] = triangle.map(|vertex| self.vertices[vertex as usize]);
            Self::size_of(0.5 * (b - a).cross(&(c - a)).norm())
        })
    }

    /// Edges of one triangle alone, at which the surface ends [m].
    #[must_use]
    pub fn rim(&self) -> Vec<[Vector3<f64>; 2]> {
        let edges = || {
            let of = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]].map(|[p, q]| [p.min(q), p.max(q)]);
            self.triangles.iter().flat_map(of)
        };
        let mut count: HashMap<[u32; 2], u32> = HashMap::new();
        edges().for_each(|edge| *count.entry(edge).or_default() += 1);
        let alone = edges().filter(|edge| count[edge] == 1);
        alone.map(|edge| edge.map(|vertex| self.vertices[vertex as usize])).collect()
    }
}
