//! Facets: triangles that bound the space of the grains without cells, on both their sides.
//!
//! Which way a triangle's corners turn says nothing. Each of its sides is a face of the boundary, so that
//! closed bodies, cavities and sheets are one thing: smooth walls are joined side by side through the space
//! of the grains, and around the rim of a sheet one side goes on in the other.

use super::boundary::{BoundaryFace, BoundaryFaces, Carrier, Condition};
use super::edges::Corners;
use crate::error::FieldError;
use amberfield_core::{Domain, TriangleMesh};
use nalgebra::{Matrix3, Vector3};
use std::collections::HashMap;

/// Size of a cell over the edge h of an equal-sided triangle of a facet's area: walls mirror charges up to
/// four cells, 2h.
const CELL_OF_EDGE: f64 = 0.5;
/// Distance up to which two faces lie in one plane, over the size of the cell.
const SAME_PLANE: f64 = 2e-3;

/// One side of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::levels) struct FacetSide {
    /// Number of the facet.
    pub(in crate::levels) facet: usize,
    /// Whether it is the side from which the facet's corners turn anticlockwise.
    pub(in crate::levels) is_front: bool,
}

/// Triangles, with a face of the boundary for each side. Faces 2i and 2i + 1 are front and back of facet i.
#[derive(Clone, Debug)]
pub(in crate::levels) struct Facets {
    faces: Vec<BoundaryFace>,
    /// Corners of the faces, three for each [m].
    corners: Vec<Vector3<f64>>,
    /// Size of a cell at each facet, and the largest there and at the facets that share an edge [m].
    cell: Vec<f64>,
    cell_around: Vec<f64>,
    shortest_edge: f64,
    domain: Domain,
}

impl FacetSide {
    /// The side that a face of the boundary stands for.
    pub(super) fn of_face(face: u32) -> Self {
        Self { facet: face as usize / 2, is_front: face.is_multiple_of(2) }
    }
}

impl Facets {
    /// Facets with these corners [m], in any order and turning either way, in a box that may be periodic.
    ///
    /// # Errors
    /// A facet without an area.
    pub(in crate::levels) fn new(
        triangles: &[[Vector3<f64>; 3]],
        domain: Domain,
    ) -> Result<Self, FieldError> {
        let count = triangles.len();
        let (mut faces, mut corners) = (Vec::with_capacity(2 * count), Vec::with_capacity(6 * count));
        for (facet, triangle) in triangles.iter().enumerate() {
            faces.extend(both_sides(facet, triangle)?);
            let [a, b, c] = *triangle;
            // Normals point out of the space of the grains: the front's corners turn the other way.
            corners.extend([a, c, b, a, b, c]);
        }
        let edge = |facet: usize| TriangleMesh::size_of(faces[2 * facet].area);
        let cell: Vec<f64> = (0..count).map(|facet| CELL_OF_EDGE * edge(facet)).collect();
        let sides = triangles.iter().flat_map(|[a, b, c]| [b - a, c - b, a - c]);
        let shortest_edge = sides.map(|side| side.norm()).fold(f64::INFINITY, f64::min);
        let mut facets = Self { faces, corners, cell_around: cell.clone(), cell, shortest_edge, domain };
        facets.look_around(triangles);
        Ok(facets)
    }

    /// Finds the largest cell at each facet and at those that share an edge with it.
    fn look_around(&mut self, triangles: &[[Vector3<f64>; 3]]) {
        let mut corners = Corners::new(&*self);
        let mut at_edges: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        for (facet, triangle) in triangles.iter().enumerate() {
            let [a, b, c] = triangle.map(|corner| corners.number(&corner));
            for [from, to] in [[a, b], [b, c], [c, a]] {
                at_edges.entry([from.min(to), from.max(to)]).or_default().push(facet);
            }
        }
        for facets in at_edges.values() {
            let largest = facets.iter().map(|&facet| self.cell[facet]).fold(0.0, f64::max);
            for &facet in facets {
                self.cell_around[facet] = self.cell_around[facet].max(largest);
            }
        }
    }

    /// Number of facets.
    pub(in crate::levels) fn count(&self) -> usize {
        self.cell.len()
    }
}

/// Front and back of a facet.
fn both_sides(facet: usize, triangle: &[Vector3<f64>; 3]) -> Result<[BoundaryFace; 2], FieldError> {
    let [a, b, c] = triangle;
    let across = (b - a).cross(&(c - a));
    let area = 0.5 * across.norm();
    if !(area > 0.0 && area.is_finite()) {
        return Err(FieldError::Settings(format!(
            "facet {facet} of a wall has an area of {area} m², with its corners at {:?}, {:?} and {:?} m; \
             leave it out",
            a.as_slice(),
            b.as_slice(),
            c.as_slice()
        )));
    }
    let centre = (a + b + c) / 3.0;
    let square = |corner: &Vector3<f64>| (corner - centre) * (corner - centre).transpose();
    let spread = triangle.iter().map(square).sum::<Matrix3<f64>>() / 3.0;
    Ok([-1.0, 1.0].map(|outwards| BoundaryFace {
        centre,
        normal: across * (outwards / (2.0 * area)),
        area,
        spread,
        cell: facet as u32,
        patch: u32::from(outwards > 0.0),
        condition: Condition::Potential(0.0),
    }))
}

impl BoundaryFaces for Facets {
    fn carrier(&self) -> Carrier {
        Carrier::Facets
    }

    fn faces(&self) -> &[BoundaryFace] {
        &self.faces
    }

    fn corners_of(&self, face: usize) -> &[Vector3<f64>] {
        &self.corners[3 * face..3 * face + 3]
    }

    fn domain(&self) -> &Domain {
        &self.domain
    }

    fn cell_around(&self, face: usize) -> f64 {
        self.cell_around[face / 2]
    }

    fn cell_at(&self, face: usize) -> f64 {
        self.cell[face / 2]
    }

    /// Length of the shortest edge [m].
    fn smallest_cell(&self) -> f64 {
        self.shortest_edge
    }

    /// Thickness up to which two facets are one sheet, whose other side bounds no solid [m].
    fn least_solid(&self, face: usize) -> f64 {
        SAME_PLANE * self.cell[face / 2]
    }

    fn least_gap(&self, face: usize) -> f64 {
        SAME_PLANE * self.cell[face / 2]
    }

    /// The face's centre.
    fn place_of_condition(&self, face: usize) -> Vector3<f64> {
        self.faces[face].centre
    }
}
