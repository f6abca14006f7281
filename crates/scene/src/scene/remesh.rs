//! Meshes for the field, of even triangles that fit grains, over surfaces as CAD programs write them.

use amberfield_core::{SmoothPatch, TriangleMesh, Vector3};
use spade::{
    AngleLimit, ConstrainedDelaunayTriangulation, HasPosition, Point2, RefinementParameters, Triangulation,
};
use std::collections::{HashMap, HashSet};

/// Angle between triangles of one plane [rad].
const FLAT: f64 = 1e-3;
/// Longest edge that stays whole, over the largest size of triangles.
const WHOLE: f64 = 1.35;
/// Pieces of longer edges over that size, at most.
const PIECE: f64 = 0.75;
/// Smallest angle that new triangles shall have [degrees].
const LEAST_ANGLE: f64 = 20.0;
/// Area over that of the equilateral triangle of the largest size, above which a new triangle is divided
/// where edges allow it: beside them some stay that are larger.
const FILLED: f64 = 0.5;
/// Relative error of the area of a plane part, above which its triangles are no division of it.
const SAME_AREA: f64 = 1e-6;
/// Most new corners within a plane part, over the number that its area asks for.
const ROOM: f64 = 20.0;

/// Mesh of triangles of about this size [m] at most over a mesh. Plane parts whose triangles have it are
/// kept; others are divided anew, with their edges cut evenly, so that parts still share them. New corners
/// lie on the smooth surface where it bulges by `bulge` [m] at most beyond the triangles, and on these
/// elsewhere.
/// `None` where it takes more than `most` triangles.
pub(super) fn remeshed(mesh: &TriangleMesh, size: f64, bulge: f64, most: usize) -> Option<TriangleMesh> {
    let mut finer = Remesh::new(mesh, size, bulge);
    for part in finer.parts() {
        if !finer.divide(&part) {
            let corners = part.iter().map(|&number| finer.patches[number].corners);
            finer.triangles.extend(corners);
        }
        if finer.triangles.len() > most {
            return None;
        }
    }
    Some(TriangleMesh { vertices: finer.vertices, triangles: finer.triangles })
}

/// A mesh that is divided part by part.
struct Remesh<'a> {
    mesh: &'a TriangleMesh,
    size: f64,
    patches: Vec<SmoothPatch>,
    normals: Vec<Vector3<f64>>,
    at_edge: HashMap<[u32; 2], Vec<usize>>,
    /// New vertices on cut edges, from the edge's lower end to its higher one.
    on_edge: HashMap<[u32; 2], Vec<u32>>,
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
}

/// A corner of a part in its plane; [`Corner::NEW`] is the number of one that the division has made.
#[derive(Clone, Copy)]
struct Corner {
    place: Point2<f64>,
    vertex: u32,
}

impl Corner {
    const NEW: u32 = u32::MAX;
}

impl HasPosition for Corner {
    type Scalar = f64;

    fn position(&self) -> Point2<f64> {
        self.place
    }
}

impl From<Point2<f64>> for Corner {
    fn from(place: Point2<f64>) -> Self {
        Self { place, vertex: Self::NEW }
    }
}

impl<'a> Remesh<'a> {
    fn new(mesh: &'a TriangleMesh, size: f64, bulge: f64) -> Self {
        let patches = mesh.smooth_patches(bulge);
        let normal = |patch: &SmoothPatch| {
            let [a, b, c] = patch.corners.map(|vertex| mesh.vertices[vertex as usize]);
            (b - a).cross(&(c - a)).normalize()
        };
        let normals = patches.iter().map(normal).collect();
        let mut at_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        for (number, patch) in patches.iter().enumerate() {
            for k in 0..3 {
                at_edge.entry(patch.edge(k)).or_default().push(number);
            }
        }
        let mut remesh = Self {
            mesh,
            size,
            normals,
            at_edge,
            on_edge: HashMap::new(),
            vertices: mesh.vertices.clone(),
            triangles: Vec::new(),
            patches,
        };
        remesh.cut_edges();
        remesh
    }

    /// Puts new vertices on edges that are too long, in the order of the triangles.
    fn cut_edges(&mut self) {
        for number in 0..self.patches.len() {
            for k in 0..3 {
                let patch = &self.patches[number];
                let ends = patch.edge(k);
                let [p, q] = ends.map(|vertex| self.mesh.vertices[vertex as usize]);
                let length = (q - p).norm();
                if length <= WHOLE * self.size || self.on_edge.contains_key(&ends) {
                    continue;
                }
                let pieces = (length / (PIECE * self.size)).ceil();
                let first = self.vertices.len() as u32;
                for piece in 1..pieces as u32 {
                    let along = f64::from(piece) / pieces;
                    self.vertices.push(patch.on_edge(self.mesh, k, along));
                }
                self.on_edge.insert(ends, (first..self.vertices.len() as u32).collect());
            }
        }
    }

    /// Triangles by plane parts, each of triangles that share edges.
    fn parts(&self) -> Vec<Vec<usize>> {
        let mut is_taken = vec![false; self.patches.len()];
        let mut parts = Vec::new();
        for seed in 0..self.patches.len() {
            if std::mem::replace(&mut is_taken[seed], true) {
                continue;
            }
            let mut part = vec![seed];
            let mut next = 0;
            while let Some(&at) = part.get(next) {
                next += 1;
                for k in 0..3 {
                    let [a, b] = *self.at_edge[&self.patches[at].edge(k)].as_slice() else { continue };
                    let other = if a == at { b } else { a };
                    let is_flat = self.normals[other].dot(&self.normals[seed]).abs() > FLAT.cos();
                    if is_flat && !std::mem::replace(&mut is_taken[other], true) {
                        part.push(other);
                    }
                }
            }
            parts.push(part);
        }
        parts
    }

    /// Whether a part's triangles have the size already.
    fn fits(&self, part: &[usize]) -> bool {
        part.iter().all(|&number| {
            let patch = &self.patches[number];
            let [a, b, c] = patch.corners.map(|vertex| self.mesh.vertices[vertex as usize]);
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            let is_whole = (0..3).all(|k| !self.on_edge.contains_key(&patch.edge(k)));
            is_whole && TriangleMesh::size_of(area) <= self.size
        })
    }

    /// Divides a part anew; `false` where it is to stay as it is.
    fn divide(&mut self, part: &[usize]) -> bool {
        if self.fits(part) {
            return false;
        }
        let plane = Plane::new(&self.normals[part[0]]);
        let flat = |vertex: u32| plane.place(&self.mesh.vertices[vertex as usize]);
        let area: f64 = part.iter().map(|&number| area(self.patches[number].corners.map(flat)).abs()).sum();
        let Some((corners, faces)) = self.triangulate(part, &plane, area) else { return false };
        let divided: f64 = faces.iter().map(|face| area_of(face, &corners)).sum();
        if (divided / area - 1.0).abs() > SAME_AREA {
            return false;
        }
        let vertex = |corner: &Corner| match corner.vertex {
            Corner::NEW => {
                self.vertices.push(place_in(part, &self.patches, self.mesh, &plane, corner.place));
                self.vertices.len() as u32 - 1
            }
            vertex => vertex,
        };
        let numbers: Vec<u32> = corners.iter().map(vertex).collect();
        self.triangles.extend(faces.iter().map(|face| face.map(|corner| numbers[corner])));
        true
    }

    /// Corners and triangles of a part in its plane, of an area [m²]; `None` where its edges cross.
    fn triangulate(
        &self,
        part: &[usize],
        plane: &Plane,
        area: f64,
    ) -> Option<(Vec<Corner>, Vec<[usize; 3]>)> {
        let chains = self.outline(part, plane);
        let mut all: Vec<Corner> = chains.iter().flatten().copied().collect();
        // The same division whatever the order of the triangles.
        all.sort_by(|a, b| a.place.x.total_cmp(&b.place.x).then(a.place.y.total_cmp(&b.place.y)));
        let mut division = ConstrainedDelaunayTriangulation::<Corner>::new();
        let mut handles = HashMap::new();
        for corner in all {
            if let std::collections::hash_map::Entry::Vacant(entry) = handles.entry(corner.vertex) {
                entry.insert(division.insert(corner).ok()?);
            }
        }
        for pair in chains.iter().flat_map(|chain| chain.windows(2)) {
            let [from, to] = [handles[&pair[0].vertex], handles[&pair[1].vertex]];
            if from == to || !division.can_add_constraint(from, to) {
                return None;
            }
            division.add_constraint(from, to);
        }
        let largest = FILLED * 3.0_f64.sqrt() / 4.0 * self.size * self.size;
        let room = ROOM * (area / largest + division.num_vertices() as f64);
        let parameters = RefinementParameters::<f64>::new()
            .keep_constraint_edges()
            .exclude_outer_faces(true)
            .with_angle_limit(AngleLimit::from_deg(LEAST_ANGLE))
            .with_max_allowed_area(largest)
            .with_max_additional_vertices(room as usize);
        let outcome = division.refine(parameters);
        let outer: HashSet<_> = outcome.excluded_faces.into_iter().collect();
        let corners: Vec<Corner> = division.vertices().map(|vertex| *vertex.data()).collect();
        let inner = division.inner_faces().filter(|face| !outer.contains(&face.fix()));
        let faces = inner.map(|face| face.vertices().map(|vertex| vertex.fix().index())).collect();
        outcome.refinement_complete.then_some((corners, faces))
    }

    /// Edges around a part, each with the new vertices on it, in its plane.
    fn outline(&self, part: &[usize], plane: &Plane) -> Vec<Vec<Corner>> {
        let mut count: HashMap<[u32; 2], u32> = HashMap::new();
        let edges = || part.iter().flat_map(|&number| (0..3).map(move |k| (number, k)));
        for (number, k) in edges() {
            *count.entry(self.patches[number].edge(k)).or_default() += 1;
        }
        let chain = |(number, k): (usize, usize)| {
            let ends = self.patches[number].edge(k);
            let is_outline = count[&ends] == 1 || self.at_edge[&ends].len() != 2;
            let [p, q] = ends.map(|vertex| plane.place(&self.mesh.vertices[vertex as usize]));
            let new: &[u32] = self.on_edge.get(&ends).map_or(&[], Vec::as_slice);
            let pieces = new.len() as f64 + 1.0;
            let between = new.iter().zip(1_u32..).map(|(&vertex, piece)| {
                let along = f64::from(piece) / pieces;
                let place = Point2::new(p.x + along * (q.x - p.x), p.y + along * (q.y - p.y));
                Corner { place, vertex }
            });
            let first = Corner { place: p, vertex: ends[0] };
            let last = Corner { place: q, vertex: ends[1] };
            is_outline.then(|| std::iter::once(first).chain(between).chain([last]).collect())
        };
        edges().filter_map(chain).collect()
    }
}

/// Place on the smooth surface over a place in a part's plane [m].
fn place_in(
    part: &[usize],
    patches: &[SmoothPatch],
    mesh: &TriangleMesh,
    plane: &Plane,
    place: Point2<f64>,
) -> Vector3<f64> {
    let within = |&number: &usize| {
        let [a, b, c] = patches[number].corners.map(|vertex| plane.place(&mesh.vertices[vertex as usize]));
        let shares =
            [[place, b, c], [a, place, c], [a, b, place]].map(|corners| area(corners) / area([a, b, c]));
        (number, shares)
    };
    let inside = |shares: &[f64; 3]| shares.iter().copied().fold(f64::INFINITY, f64::min);
    let found = part.iter().map(within).max_by(|a, b| inside(&a.1).total_cmp(&inside(&b.1)));
    found.map_or_else(Vector3::zeros, |(number, shares)| patches[number].at(mesh, shares))
}

/// Area of a triangle, with a sign.
fn area([a, b, c]: [Point2<f64>; 3]) -> f64 {
    0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x))
}

fn area_of(face: &[usize; 3], corners: &[Corner]) -> f64 {
    area(face.map(|corner| corners[corner].place)).abs()
}

/// Axes in a plane.
struct Plane([Vector3<f64>; 2]);

impl Plane {
    /// Plane of a unit normal; its sense does not matter.
    fn new(normal: &Vector3<f64>) -> Self {
        let normal = normal * normal[normal.iamax()].signum();
        let mut axis = Vector3::zeros();
        axis[normal.iamin()] = 1.0;
        let first = (axis - normal * normal.dot(&axis)).normalize();
        Self([first, normal.cross(&first)])
    }

    fn place(&self, x: &Vector3<f64>) -> Point2<f64> {
        Point2::new(self.0[0].dot(x), self.0[1].dot(x))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    /// Wall of a cylinder of radius 1 with so many sides.
    fn cylinder(sides: u32, height: f64) -> TriangleMesh {
        let mut mesh = TriangleMesh::default();
        for k in 0..sides {
            let angle = TAU * f64::from(k) / f64::from(sides);
            mesh.vertices.extend([0.0, height].map(|z| Vector3::new(angle.cos(), angle.sin(), z)));
        }
        for k in 0..sides {
            let [a, b] = [2 * k, (2 * k + 2) % (2 * sides)];
            mesh.triangles.extend([[a, b, a + 1], [b, b + 1, a + 1]]);
        }
        mesh
    }

    /// Unit cube of two triangles a face.
    fn cube() -> TriangleMesh {
        let vertices =
            (0..8_u32).map(|k| Vector3::new(f64::from(k & 1), f64::from((k >> 1) & 1), f64::from(k >> 2)));
        let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriangleMesh { vertices: vertices.collect(), triangles }
    }

    fn edges(mesh: &TriangleMesh) -> HashMap<[u32; 2], usize> {
        let mut count = HashMap::new();
        for &[a, b, c] in &mesh.triangles {
            for [p, q] in [[a, b], [b, c], [c, a]] {
                *count.entry([p.min(q), p.max(q)]).or_insert(0) += 1;
            }
        }
        count
    }

    fn area(mesh: &TriangleMesh) -> f64 {
        mesh.sizes().map(|size| 3.0_f64.sqrt() / 4.0 * size * size).sum()
    }

    /// Checks that triangles are at most of a size, and not many more than it takes.
    fn check_sizes(mesh: &TriangleMesh, size: f64) {
        let largest = mesh.sizes().fold(0.0, f64::max);
        assert!(largest <= size, "{largest} {size}");
        let needed = area(mesh) / (3.0_f64.sqrt() / 4.0 * size * size);
        assert!((mesh.triangles.len() as f64) < 6.0 * needed, "{} for {needed}", mesh.triangles.len());
    }

    #[test]
    fn a_cube_stays_a_closed_cube() {
        let cube = cube();
        for size in [0.9, 0.3, 0.1] {
            let finer = remeshed(&cube, size, 1.0, 100_000).unwrap();
            check_sizes(&finer, size);
            assert!(edges(&finer).values().all(|&count| count == 2), "closed, with no T-joint");
            assert!((area(&finer) - 6.0).abs() < 1e-12);
            let in_faces = |x: &Vector3<f64>| x.iter().any(|x| x.abs() < 1e-12 || (x - 1.0).abs() < 1e-12);
            assert!(finer.vertices.iter().all(in_faces));
        }
        assert_eq!(remeshed(&cube, 1.6, 1.0, 12).unwrap(), cube, "nothing to do");
        assert!(remeshed(&cube, 0.1, 1.0, 500).is_none());
    }

    #[test]
    fn long_sides_of_a_cylinder_become_even_triangles_on_it_where_it_bulges_little() {
        let sides = 24;
        let cylinder = cylinder(sides, 8.0);
        let sagitta = 1.0 - (PI / f64::from(sides)).cos();
        let off = |mesh: &TriangleMesh| {
            mesh.vertices.iter().map(|x| (x.x.hypot(x.y) - 1.0).abs()).fold(0.0, f64::max)
        };
        for size in [0.25, 0.1] {
            let round = remeshed(&cylinder, size, 2.0 * sagitta, 100_000).unwrap();
            check_sizes(&round, size);
            assert!(off(&round) < 0.1 * sagitta, "{}", off(&round));
            let flat = remeshed(&cylinder, size, 0.5 * sagitta, 100_000).unwrap();
            assert!((area(&flat) / area(&cylinder) - 1.0).abs() < 1e-12);
            let alone = edges(&flat).values().filter(|&&count| count == 1).count();
            assert_eq!(alone, 2 * sides as usize * (if size > 0.2 { 1 } else { 4 }), "a rim at either end");
        }
    }

    #[test]
    fn holes_stay_holes_and_the_order_of_triangles_does_not_matter() {
        // A square of 4 × 4 with a square hole of 2 × 2, as a fan of trapezoids.
        let ring = |half: f64| [[-half, -half], [half, -half], [half, half], [-half, half]];
        let places = ring(2.0).into_iter().chain(ring(1.0));
        let vertices = places.map(|[x, y]| Vector3::new(x, y, 0.3 * x)).collect();
        let triangles = (0..4).flat_map(|k| {
            let [a, b] = [k, (k + 1) % 4];
            [[a, b, 4 + a], [b, 4 + b, 4 + a]]
        });
        let frame = TriangleMesh { vertices, triangles: triangles.collect() };
        let finer = remeshed(&frame, 0.3, 0.0, 100_000).unwrap();
        check_sizes(&finer, 0.3);
        assert!((area(&finer) / area(&frame) - 1.0).abs() < 1e-12);
        let mut turned = frame.clone();
        turned.triangles.reverse();
        turned.triangles.iter_mut().for_each(|corners| corners.rotate_left(1));
        let centres = |mesh: &TriangleMesh| {
            let centre = |corners: &[u32; 3]| {
                let sum: Vector3<f64> = corners.iter().map(|&vertex| mesh.vertices[vertex as usize]).sum();
                [0, 1, 2].map(|k| (sum[k] * 1e6).round() as i64)
            };
            let mut centres: Vec<_> = mesh.triangles.iter().map(centre).collect();
            centres.sort_unstable();
            centres
        };
        assert_eq!(centres(&finer), centres(&remeshed(&turned, 0.3, 0.0, 100_000).unwrap()));
    }
}
