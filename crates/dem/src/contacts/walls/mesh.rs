//! Contacts of a sphere with a triangulated surface.
//!
//! Every triangle within reach gives its closest point. Going from the deepest to the shallowest, a point is
//! a contact of its own unless one accepted before covers it: it lies on or behind that contact's tangent
//! plane (the next triangle of a flat surface, a shared edge or vertex), or its direction differs by less
//! than 15° (facets of a curved surface). A concave corner keeps both faces. So a ball that rolls over a
//! triangulated plane feels the plane's force, once, whatever it rolls over.
//!
//! All surfaces of a scene are searched together, so that it does not matter how a surface is cut into files
//! or patches. Where two lie in one place, as the sides of a baffle do, the grain touches the one that turns
//! its front to it.

use amberfield_core::{TriangleMesh, Vector3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;

/// Most contacts of one grain with one mesh; the deepest are kept.
pub(crate) const MOST_CONTACTS: usize = 8;
/// Cosine of the angle below which two directions are one contact (15°).
const SAME_DIRECTION: f64 = 0.965_925_826_289_068_3;
/// Slack of the tangent-plane test over the radius: round-off of coordinates, far below any real step.
const PLANE_SLACK: f64 = 1e-6;
/// Squared lateral distance over r² below which the closest point is taken as the foot on the face.
const FACE_SLACK: f64 = 1e-10;
/// Least cosine of the angle between two directions to one place: round-off.
const SAME_PLACE: f64 = 1.0 - 1e-9;

/// Triangles whose height is below this fraction of their longest edge have no direction beyond round-off.
const SLIVER: f64 = 1e-10;

/// A contact with a wall: direction from the grain to the wall, and overlap [m].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Found {
    pub(crate) normal: Vector3<f64>,
    pub(crate) overlap: f64,
    /// Triangle of a mesh that is touched.
    pub(crate) triangle: u32,
}

/// A closest point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ClosestPoint {
    distance: f64,
    triangle: u32,
    direction: Vector3<f64>,
    /// Whether the triangle turns its front to the grain's centre.
    is_front: bool,
}

/// Triangles with what a contact search needs.
#[derive(Debug)]
pub(crate) struct MeshWall {
    triangles: Vec<Triangle>,
    normals: Vec<Vector3<f64>>,
    tree: Bvh,
    /// First triangle of each surface.
    first: Vec<u32>,
}

fn parry(v: Vector3<f64>) -> ParryVector {
    ParryVector::new(v.x, v.y, v.z)
}

fn plain(v: ParryVector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

impl MeshWall {
    /// Joins surfaces. Triangles without area, and slivers whose plane is round-off, are dropped: their
    /// neighbours' edges cover them.
    pub(crate) fn new<'a>(surfaces: impl IntoIterator<Item = &'a TriangleMesh>) -> Self {
        let (mut triangles, mut normals, mut first) = (Vec::new(), Vec::new(), Vec::new());
        for surface in surfaces {
            first.push(triangles.len() as u32);
            for indices in &surface.triangles {
                let [a, b, c] = indices.map(|k| surface.vertices[k as usize]);
                let across = (b - a).cross(&(c - a));
                let normal = across / across.norm();
                let longest2 = [b - a, c - b, a - c].iter().map(Vector3::norm_squared).fold(0.0, f64::max);
                if across.norm() > SLIVER * longest2 && normal.iter().all(|x| x.is_finite()) {
                    triangles.push(Triangle::new(parry(a), parry(b), parry(c)));
                    normals.push(normal);
                }
            }
        }
        let boxes: Vec<Aabb> = triangles.iter().map(Triangle::local_aabb).collect();
        let tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes);
        Self { triangles, normals, tree, first }
    }

    /// First of the surfaces of which no triangle is left.
    pub(crate) fn empty_surface(&self) -> Option<usize> {
        let ends = self.first.iter().skip(1).copied().chain([self.triangles.len() as u32]);
        self.first.iter().zip(ends).position(|(first, end)| *first == end)
    }

    /// Surface that a triangle belongs to.
    pub(crate) fn surface_of(&self, triangle: u32) -> usize {
        self.first.partition_point(|first| *first <= triangle) - 1
    }

    /// Corners of a triangle [m].
    pub(crate) fn corners(&self, triangle: u32) -> [Vector3<f64>; 3] {
        let Triangle { a, b, c } = self.triangles[triangle as usize];
        [a, b, c].map(plain)
    }

    /// Calls `found` with every triangle within `reach` [m] of a point, in ascending order.
    pub(crate) fn within(&self, centre: Vector3<f64>, reach: f64, found: &mut Vec<u32>) {
        let first = found.len();
        let half = Vector3::repeat(reach);
        let region = Aabb::new(parry(centre - half), parry(centre + half));
        for triangle in self.tree.intersect_aabb(&region) {
            if self.closest(triangle, centre, reach).distance <= reach {
                found.push(triangle);
            }
        }
        found[first..].sort_unstable();
    }

    /// Closest point of a triangle to the centre of a sphere with a radius [m].
    fn closest(&self, triangle: u32, centre: Vector3<f64>, radius: f64) -> ClosestPoint {
        let (shape, normal) = (&self.triangles[triangle as usize], self.normals[triangle as usize]);
        let height = (centre - plain(shape.a)).dot(&normal);
        let offset = plain(shape.project_local_point(parry(centre), false).point) - centre;
        let square = offset.norm_squared();
        // Both ways: beside a thin triangle, whose normal is inexact, the height may exceed the distance.
        let is_front = height >= 0.0;
        if (square - height * height).abs() <= FACE_SLACK * radius * radius {
            let direction = if is_front { -normal } else { normal };
            ClosestPoint { distance: height.abs(), triangle, direction, is_front }
        } else {
            let distance = square.sqrt();
            ClosestPoint { distance, triangle, direction: offset / distance, is_front }
        }
    }

    /// Contacts of a sphere with the given triangles; returns their number. `scratch` keeps its capacity.
    /// `shifted` moves the centre for triangle k, for periodic images.
    pub(crate) fn contacts(
        &self,
        radius: f64,
        triangles: impl Iterator<Item = (u32, Vector3<f64>)>,
        scratch: &mut Vec<ClosestPoint>,
        found: &mut [Found; MOST_CONTACTS],
    ) -> usize {
        scratch.clear();
        for (triangle, centre) in triangles {
            let point = self.closest(triangle, centre, radius);
            if point.distance < radius {
                scratch.push(point);
            }
        }
        scratch.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.triangle.cmp(&b.triangle)));
        let mut count = 0;
        let mut is_front = [false; MOST_CONTACTS];
        for candidate in &*scratch {
            let overlap = radius - candidate.distance;
            let covering = found[..count].iter().position(|contact| {
                let cosine = contact.normal.dot(&candidate.direction);
                let beyond = cosine * candidate.distance - (radius - contact.overlap);
                cosine > SAME_DIRECTION || beyond >= -PLANE_SLACK * radius
            });
            match covering {
                None if count < MOST_CONTACTS => {
                    let triangle = candidate.triangle;
                    found[count] = Found { normal: candidate.direction, overlap, triangle };
                    is_front[count] = candidate.is_front;
                    count += 1;
                }
                Some(k) if candidate.is_front && !is_front[k] => {
                    let is_same = found[k].normal.dot(&candidate.direction) > SAME_PLACE
                        && found[k].overlap - overlap < PLANE_SLACK * radius;
                    if is_same {
                        found[k].triangle = candidate.triangle;
                        is_front[k] = true;
                    }
                }
                _ => {}
            }
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contacts(mesh: &TriangleMesh, centre: Vector3<f64>, radius: f64) -> Vec<Found> {
        let wall = MeshWall::new([mesh]);
        let mut near = Vec::new();
        wall.within(centre, radius * 1.1, &mut near);
        let mut found = [Found::default(); MOST_CONTACTS];
        let pairs = near.iter().map(|&t| (t, centre));
        let count = wall.contacts(radius, pairs, &mut Vec::new(), &mut found);
        found[..count].to_vec()
    }

    /// Unit cells of two triangles each in the plane z = 0.
    fn floor(cells: u32) -> TriangleMesh {
        let n = cells + 1;
        let vertices = (0..n * n).map(|k| Vector3::new(f64::from(k % n), f64::from(k / n), 0.0)).collect();
        let triangles = (0..cells * cells)
            .flat_map(|k| {
                let v = k / cells * n + k % cells;
                [[v, v + 1, v + n + 1], [v, v + n + 1, v + n]]
            })
            .collect();
        TriangleMesh { vertices, triangles }
    }

    #[test]
    fn faces_edges_and_vertices_of_a_flat_mesh_are_the_plane() {
        let mesh = floor(4);
        for (x, y) in [(1.3, 1.1), (2.0, 1.5), (1.5, 1.5), (2.0, 2.0), (2.0 + 1e-13, 2.0)] {
            let found = contacts(&mesh, Vector3::new(x, y, 0.9), 1.0);
            assert_eq!(found.len(), 1, "at {x} {y}: {found:?}");
            assert!((found[0].overlap - 0.1).abs() < 1e-15);
            assert_eq!(found[0].normal, -Vector3::z());
        }
    }

    #[test]
    fn concave_corner_has_two_contacts_and_convex_edge_one() {
        let vertices = vec![
            Vector3::zeros(),
            Vector3::new(0.0, 4.0, 0.0),
            Vector3::new(4.0, 4.0, 0.0),
            Vector3::new(4.0, 0.0, 0.0),
            Vector3::new(0.0, 4.0, 4.0),
            Vector3::new(0.0, 0.0, 4.0),
        ];
        let triangles = vec![[0, 2, 1], [0, 3, 2], [0, 1, 4], [0, 4, 5]];
        let mesh = TriangleMesh { vertices, triangles };
        let inside = contacts(&mesh, Vector3::new(0.95, 2.0, 0.9), 1.0);
        assert_eq!(inside.len(), 2, "{inside:?}");
        assert!((inside[0].overlap - 0.1).abs() < 1e-15 && (inside[1].overlap - 0.05).abs() < 1e-15);
        // From outside the same edge is convex: one contact along the diagonal.
        let outside = contacts(&mesh, Vector3::new(-0.6, 2.0, -0.6), 1.0);
        assert_eq!(outside.len(), 1, "{outside:?}");
        assert!((outside[0].overlap - (1.0 - 0.72_f64.sqrt())).abs() < 1e-15);
        assert!((outside[0].normal - Vector3::new(0.5, 0.0, 0.5) * 2.0_f64.sqrt()).norm() < 1e-15);
    }

    #[test]
    fn edge_and_vertex_at_the_rim_of_a_mesh() {
        let mesh = floor(2);
        let edge = contacts(&mesh, Vector3::new(-0.3, 1.0, 0.4), 1.0);
        assert_eq!(edge.len(), 1);
        assert!((edge[0].overlap - 0.5).abs() < 1e-15);
        let vertex = contacts(&mesh, Vector3::new(-0.2, -0.2, 0.1), 1.0);
        assert_eq!(vertex.len(), 1);
        assert!((vertex[0].overlap - 0.7).abs() < 1e-15);
    }
}
