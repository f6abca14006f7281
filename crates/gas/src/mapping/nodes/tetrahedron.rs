//! A tetrahedron of a cell's centre and three more places.

use amberfield_core::Vector3;
use nalgebra::Matrix3;

/// A tetrahedron of a cell's centre and three more places.
pub(super) struct Tetrahedron {
    /// Vectors from the centre to the others [m].
    pub(super) edges: [Vector3<f64>; 3],
}

impl Tetrahedron {
    /// Volume [m³], of either sign for either order of the corners.
    pub(super) fn signed(&self) -> f64 {
        self.edges[0].dot(&self.edges[1].cross(&self.edges[2])) / 6.0
    }

    /// Edge of the cell that is its side [m].
    pub(super) fn edge(&self) -> Vector3<f64> {
        self.edges[2] - self.edges[1]
    }

    /// Mean square of the place from the cell's centre [m²].
    pub(super) fn mean_square(&self) -> Matrix3<f64> {
        let sum: Vector3<f64> = self.edges.iter().sum();
        let squares: Matrix3<f64> = self.edges.iter().chain([&sum]).map(|edge| edge * edge.transpose()).sum();
        squares / 20.0
    }

    /// Volume [m³].
    pub(super) fn volume(&self) -> f64 {
        self.signed().abs()
    }

    /// Barycentric coordinates of a place seen from the centre [m].
    pub(super) fn coordinates(&self, place: &Vector3<f64>) -> [f64; 4] {
        let [a, b, c] = &self.edges;
        let per_volume = 1.0 / a.dot(&b.cross(c));
        let first = place.dot(&b.cross(c)) * per_volume;
        let second = place.dot(&c.cross(a)) * per_volume;
        let third = place.dot(&a.cross(b)) * per_volume;
        [1.0 - first - second - third, first, second, third]
    }
}
