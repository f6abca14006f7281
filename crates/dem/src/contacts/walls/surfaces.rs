//! Contacts of a sphere with all walls of a scene: planes, and surfaces of triangles.
//!
//! Every plane and every triangle within reach gives its closest point. Going from the deepest to the
//! shallowest, a point is a contact of its own where it lies before the tangent planes of those accepted
//! before it. The next triangle of a flat surface, an edge and a vertex that they share, and a second wall in
//! the same place add nothing. The sides of a corner or a groove are two contacts, as far as the patches in
//! which the sphere overlaps them are two: with Φ(δ) the energy of a contact of overlap δ,
//!
//! ```text
//! U = Σ Φ(δ) − Σ Φ(m),   m the overlap at which a patch joins one that is deeper,
//! ```
//!
//! which is that of the line in which the two tangent planes meet. U counts the patches at every level of
//! overlap, so that it does not change with the triangles, forces are smooth where a grain rolls over a bend,
//! and no energy is made there. How walls are cut into triangles, patches, files and `[[walls]]` does not
//! matter.
//!
//! Where two surfaces lie in one place, as the sides of a baffle do, the grain touches the one that turns its
//! front to it.

use amberfield_core::{TriangleMesh, Vector3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector as ParryVector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy};
use parry3d_f64::query::PointQuery;
use parry3d_f64::shape::Triangle;

/// Most contacts of one grain with walls; the deepest are kept.
pub(crate) const MOST_CONTACTS: usize = 8;
/// Cosine of the angle below which two directions are one contact (0.1°): the deeper one.
const SAME_DIRECTION: f64 = 0.999_998_476_913_287_7;
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
    /// Overlap δ′ whose force is that of the contact less that of the line where it joins a deeper one,
    /// δ′^{3/2} = δ^{3/2} − m^{3/2} [m].
    pub(crate) overlap: f64,
    /// Overlap m with that line [m]; 0 where there is none.
    pub(crate) joined: f64,
    /// Difference of the directions to the contact and to that line.
    pub(crate) lean: Vector3<f64>,
    /// Triangle or plane that is touched.
    pub(crate) triangle: u32,
}

impl Found {
    /// Overlap δ of the sphere and the wall at the contact [m].
    pub(crate) fn depth(&self) -> f64 {
        let of = |overlap: f64| overlap * overlap.sqrt();
        if self.joined > 0.0 { (of(self.overlap) + of(self.joined)).cbrt().powi(2) } else { self.overlap }
    }
}

/// A closest point.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ClosestPoint {
    pub(super) distance: f64,
    triangle: u32,
    direction: Vector3<f64>,
    /// Place of the point among the triangles [m].
    place: Vector3<f64>,
    /// Whether it is on the face of a triangle, off its edges, or on a plane.
    is_face: bool,
    /// Whether the surface turns its front to the grain's centre.
    is_front: bool,
}

/// Plane that grains are before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plane {
    pub(crate) point: Vector3<f64>,
    /// Unit vector towards the grains.
    pub(crate) normal: Vector3<f64>,
}

/// Triangles and planes with what a contact search needs. Planes are numbered after the triangles.
#[derive(Debug)]
pub(crate) struct Surfaces {
    triangles: Vec<Triangle>,
    normals: Vec<Vector3<f64>>,
    tree: Bvh,
    /// First triangle of each surface.
    first: Vec<u32>,
    planes: Vec<Plane>,
}

/// Corners and front of a triangle.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    /// Corners [m].
    pub(crate) corners: [Vector3<f64>; 3],
    /// Unit vector out of the front.
    pub(crate) normal: Vector3<f64>,
}

fn parry(v: Vector3<f64>) -> ParryVector {
    ParryVector::new(v.x, v.y, v.z)
}

fn plain(v: ParryVector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

impl Surfaces {
    /// Joins surfaces. Triangles without area, and slivers whose plane is round-off, are dropped: their
    /// neighbours' edges cover them.
    pub(crate) fn new<'a>(surfaces: impl IntoIterator<Item = &'a TriangleMesh>, planes: Vec<Plane>) -> Self {
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
        Self { triangles, normals, tree, first, planes }
    }

    /// First of the surfaces of which no triangle is left.
    pub(crate) fn empty_surface(&self) -> Option<usize> {
        let ends = self.first.iter().skip(1).copied().chain([self.triangles.len() as u32]);
        self.first.iter().zip(ends).position(|(first, end)| *first == end)
    }

    /// Number of the surface of triangles, or after them of the plane, that a number belongs to.
    pub(crate) fn surface_of(&self, number: u32) -> usize {
        match self.plane_number(number) {
            Some(plane) => self.first.len() + plane,
            None => self.first.partition_point(|first| *first <= number) - 1,
        }
    }

    /// Number of triangles and planes.
    pub(crate) fn len(&self) -> usize {
        self.triangles.len() + self.planes.len()
    }

    /// Numbers of the triangles, or of the plane, of a surface.
    pub(crate) fn numbers_of(&self, surface: usize) -> std::ops::Range<u32> {
        let count = self.triangles.len() as u32;
        match surface.checked_sub(self.first.len()) {
            Some(plane) => count + plane as u32..count + plane as u32 + 1,
            None => self.first[surface]..self.first.get(surface + 1).copied().unwrap_or(count),
        }
    }

    /// Triangle of a number.
    pub(crate) fn facet(&self, number: u32) -> Facet {
        let Triangle { a, b, c } = self.triangles[number as usize];
        Facet { corners: [a, b, c].map(plain), normal: self.normals[number as usize] }
    }

    /// Puts a triangle elsewhere; who looks for it there must call [`Self::update`] and [`Self::refit`].
    pub(crate) fn set(&mut self, number: u32, facet: &Facet) {
        let [a, b, c] = facet.corners.map(parry);
        self.triangles[number as usize] = Triangle::new(a, b, c);
        self.normals[number as usize] = facet.normal;
    }

    /// Puts a plane elsewhere.
    pub(crate) fn set_plane(&mut self, number: u32, plane: Plane) {
        let place = number as usize - self.triangles.len();
        self.planes[place] = plane;
    }

    /// Tells the search where triangles are.
    pub(crate) fn update(&mut self, numbers: std::ops::Range<u32>) {
        for number in numbers {
            let shape = &self.triangles[number as usize];
            self.tree.insert_or_update_partially(shape.local_aabb(), number, 0.0);
        }
    }

    /// Fits the search to triangles that were moved.
    pub(crate) fn refit(&mut self) {
        self.tree.refit_without_opt();
    }

    /// Place among the planes of a number that is none of a triangle.
    fn plane_number(&self, number: u32) -> Option<usize> {
        (number as usize).checked_sub(self.triangles.len())
    }

    /// Plane of a number, if it is one.
    pub(crate) fn plane(&self, number: u32) -> Option<&Plane> {
        self.plane_number(number).map(|plane| &self.planes[plane])
    }

    /// Adds the number of every plane that is nearer than `reach` [m] to a point, or whose back it is at.
    pub(crate) fn planes_within(&self, centre: Vector3<f64>, reach: f64, found: &mut Vec<u32>) {
        let first = self.triangles.len() as u32;
        let near = (first..).zip(&self.planes);
        found.extend(near.filter(|(_, plane)| plane.height(centre) < reach).map(|(number, _)| number));
    }

    /// Adds the number of every triangle within `reach` [m] of a point, in ascending order.
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

    /// Closest point of a triangle or plane to the centre of a sphere with a radius [m].
    pub(crate) fn closest(&self, triangle: u32, centre: Vector3<f64>, radius: f64) -> ClosestPoint {
        if let Some(plane) = self.plane(triangle) {
            let distance = plane.height(centre);
            let (direction, place) = (-plane.normal, centre - plane.normal * distance);
            return ClosestPoint { distance, triangle, direction, place, is_face: true, is_front: true };
        }
        let (shape, normal) = (&self.triangles[triangle as usize], self.normals[triangle as usize]);
        let height = (centre - plain(shape.a)).dot(&normal);
        let offset = plain(shape.project_local_point(parry(centre), false).point) - centre;
        let square = offset.norm_squared();
        // Both ways: beside a thin triangle, whose normal is inexact, the height may exceed the distance.
        let is_front = height >= 0.0;
        if (square - height * height).abs() <= FACE_SLACK * radius * radius {
            let direction = if is_front { -normal } else { normal };
            let place = centre + offset;
            ClosestPoint { distance: height.abs(), triangle, direction, place, is_face: true, is_front }
        } else {
            let distance = square.sqrt();
            let (direction, place) = (offset / distance, centre + offset);
            ClosestPoint { distance, triangle, direction, place, is_face: false, is_front }
        }
    }

    /// Whether the surface is nowhere nearer around a closest point: a point of an edge is not where one of
    /// the `deeper` triangles has it too.
    fn is_bottom(&self, point: &ClosestPoint, deeper: &[ClosestPoint], radius: f64) -> bool {
        let holds = |other: &ClosestPoint| {
            let off = match self.plane(other.triangle) {
                Some(plane) => plane.height(point.place).abs(),
                None => self.closest(other.triangle, point.place, radius).distance,
            };
            off <= PLANE_SLACK * radius
        };
        point.is_face || !deeper.iter().any(holds)
    }

    /// Contacts of a sphere with the given triangles and planes; returns their number. `scratch` keeps its
    /// capacity. `shifted` moves the centre for triangle k, for periodic images.
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
        let mut accepted = [ClosestPoint::default(); MOST_CONTACTS];
        for (number, candidate) in scratch.iter().enumerate() {
            let joint = most_joined(&accepted[..count], candidate, radius);
            if let Some(covering) = joint.covering {
                if candidate.is_front && !accepted[covering].is_front {
                    let known = &accepted[covering];
                    let is_same = known.direction.dot(&candidate.direction) > SAME_PLACE
                        && candidate.distance - known.distance < PLANE_SLACK * radius;
                    if is_same {
                        found[covering].triangle = candidate.triangle;
                        accepted[covering].is_front = true;
                    }
                }
            } else if count < MOST_CONTACTS && self.is_bottom(candidate, &scratch[..number], radius) {
                let depth = radius - candidate.distance;
                let normal = candidate.direction;
                let rest = depth * depth.sqrt() - joint.overlap * joint.overlap.sqrt();
                found[count] = Found {
                    normal,
                    overlap: if joint.overlap > 0.0 { rest.max(0.0).cbrt().powi(2) } else { depth },
                    joined: joint.overlap,
                    lean: if joint.overlap > 0.0 { normal - joint.direction } else { Vector3::zeros() },
                    triangle: candidate.triangle,
                };
                accepted[count] = *candidate;
                count += 1;
            }
        }
        count
    }
}

impl Plane {
    /// Distance of a point before the plane [m].
    pub(crate) fn height(&self, place: Vector3<f64>) -> f64 {
        (place - self.point).dot(&self.normal)
    }
}

/// Line where a candidate joins a contact that is deeper.
struct Joint {
    /// Accepted contact that covers the candidate, which is no contact then.
    covering: Option<usize>,
    /// Largest overlap with a line, 0 where none touches [m].
    overlap: f64,
    /// Direction from the sphere's centre to that line.
    direction: Vector3<f64>,
}

/// Finds where a candidate joins the accepted contacts: the line in which the tangent planes of both meet.
fn most_joined(accepted: &[ClosestPoint], candidate: &ClosestPoint, radius: f64) -> Joint {
    let mut joint = Joint { covering: None, overlap: 0.0, direction: Vector3::zeros() };
    for (number, known) in accepted.iter().enumerate() {
        let cosine = known.direction.dot(&candidate.direction);
        let before = known.distance - cosine * candidate.distance;
        if cosine > SAME_DIRECTION || before <= PLANE_SLACK * radius {
            joint.covering = Some(number);
            return joint;
        }
        // Nearest point of the line: on both planes, and in the plane of both directions.
        let sine2 = 1.0 - cosine * cosine;
        let place = known.direction * (before / sine2)
            + candidate.direction * ((candidate.distance - cosine * known.distance) / sine2);
        let overlap = radius - place.norm();
        if overlap > joint.overlap {
            joint.overlap = overlap;
            joint.direction = place.normalize();
        }
    }
    joint
}

#[cfg(test)]
mod tests {
    use super::*;

    fn contacts(mesh: &TriangleMesh, centre: Vector3<f64>, radius: f64) -> Vec<Found> {
        let wall = Surfaces::new([mesh], Vec::new());
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

    /// Groove along y whose sides rise by `slope` = tan of an angle to either side of x = 0.
    fn groove(slope: f64) -> TriangleMesh {
        let at = |x: f64, y: f64| Vector3::new(x, y, slope * x.abs());
        let vertices =
            vec![at(0.0, -4.0), at(0.0, 4.0), at(4.0, -4.0), at(4.0, 4.0), at(-4.0, -4.0), at(-4.0, 4.0)];
        TriangleMesh { vertices, triangles: vec![[0, 2, 3], [0, 3, 1], [0, 1, 5], [0, 5, 4]] }
    }

    /// Force of Hertz contacts of unit stiffness on a sphere of unit radius, and their energy.
    fn push(found: &[Found]) -> (Vector3<f64>, f64) {
        let (mut force, mut energy) = (Vector3::zeros(), 0.0);
        for &Found { normal, overlap, joined, lean, .. } in found {
            force -= normal * overlap.powf(1.5) + lean * joined.powf(1.5);
            let depth = (overlap.powf(1.5) + joined.powf(1.5)).powf(2.0 / 3.0);
            energy += 0.4 * (depth.powf(2.5) - joined.powf(2.5));
        }
        (force, energy)
    }

    #[test]
    fn sides_of_any_groove_are_two_contacts() {
        for degrees in [60.0_f64, 45.0, 20.0, 7.0, 3.0] {
            let (sine, cosine) = degrees.to_radians().sin_cos();
            // Both sides are nearer than the line between them, which does not touch.
            let depth = 0.5 * (1.0 - cosine);
            let found = contacts(&groove(sine / cosine), Vector3::new(0.0, 0.1, (1.0 - depth) / cosine), 1.0);
            assert_eq!(found.len(), 2, "{degrees}°: {found:?}");
            let up = push(&found).0 / (2.0 * cosine * depth.powf(1.5));
            assert!((up - Vector3::z()).norm() < 1e-6, "{degrees}°: {up:?}");
        }
    }

    #[test]
    fn bend_of_round_off_is_no_groove() {
        for slope in [1e-12, 1e-9, 1e-7, 1e-5, 8e-4] {
            let found = contacts(&groove(slope), Vector3::new(0.0, 0.1, 0.99), 1.0);
            assert_eq!(found.len(), 1, "{slope:e}: {found:?}");
            assert!((found[0].overlap - 0.01).abs() < 1e-15 + slope * slope, "{slope:e}: {found:?}");
        }
        // A little more, and the second contact is there, with next to no force.
        let up = push(&contacts(&groove(1e-3), Vector3::new(0.0, 0.1, 0.99), 1.0)).0.z;
        assert!((up / 0.001 - 1.0).abs() < 1e-3, "{up:e}");
    }

    #[test]
    fn force_in_a_groove_is_the_derivative_of_the_energy() {
        for degrees in [0.5_f64, 2.0, 5.0, 30.0] {
            let mesh = groove(degrees.to_radians().tan());
            let at = |x: f64, z: f64| push(&contacts(&mesh, Vector3::new(x, 0.1, z), 1.0));
            let h = 1e-6;
            for step in -100..=100 {
                // Over the zone in which both sides are touched, off its ends.
                let x = 1.37e-2 * f64::from(step) * degrees.to_radians().sin() + 1e-7;
                let z = 0.99 / degrees.to_radians().cos() + degrees.to_radians().tan() * x.abs();
                let force = at(x, z).0;
                let slope_x = (at(x - h, z).1 - at(x + h, z).1) / (2.0 * h);
                let slope_z = (at(x, z - h).1 - at(x, z + h).1) / (2.0 * h);
                let error = (force.x - slope_x).hypot(force.z - slope_z);
                assert!(error < 1e-4, "{degrees}° at {x:e}: {force:?} for {slope_x:e} {slope_z:e}");
            }
        }
    }

    #[test]
    fn plane_in_the_place_of_triangles_adds_nothing() {
        let plane = Plane { point: Vector3::zeros(), normal: Vector3::z() };
        let walls = Surfaces::new([&floor(2)], vec![plane, plane]);
        let (mut near, centre) = (Vec::new(), Vector3::new(1.2, 0.9, 0.9));
        walls.within(centre, 1.0, &mut near);
        walls.planes_within(centre, 1.0, &mut near);
        let mut found = [Found::default(); MOST_CONTACTS];
        let pairs = near.iter().map(|&number| (number, centre));
        assert_eq!(walls.contacts(1.0, pairs, &mut Vec::new(), &mut found), 1);
        assert!((found[0].overlap - 0.1).abs() < 1e-15);
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
