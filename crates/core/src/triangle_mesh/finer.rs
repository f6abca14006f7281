//! Finer meshes of the same surface: each triangle split in four, and long edges cut in two.

use super::TriangleMesh;
use super::smooth::{Patch, edge, middle, patches};
use nalgebra::Vector3;
use std::cmp::Ordering;
use std::collections::{BinaryHeap, HashMap};

impl TriangleMesh {
    /// Splits each triangle in four, towards the smooth surface whose chords the triangles are.
    #[must_use]
    pub fn split(&self) -> Self {
        let mut finer = Finer::new(self, f64::INFINITY);
        let mut middles = HashMap::new();
        let mut triangles = Vec::with_capacity(4 * finer.patches.len());
        for number in 0..finer.patches.len() {
            let [a, b, c] = finer.patches[number].corners;
            let [ab, bc, ca] = [0, 1, 2]
                .map(|k| *middles.entry(finer.edge(number, k)).or_insert_with(|| finer.add(number, k)));
            triangles.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        Self { vertices: finer.vertices, triangles }
    }

    /// Cuts edges longer than `longest` [m] in two, with the triangles at them, the longest one first: so no
    /// triangle gets worse than it was (Rivara, Int. J. Numer. Meth. Eng. 20, 745, 1984). New vertices lie on
    /// the smooth surface where it bulges by `bulge` [m] at most beyond the triangles, and on them elsewhere.
    /// `None` where this takes more than `most` triangles.
    #[must_use]
    pub fn with_edges_cut(&self, longest: f64, bulge: f64, most: usize) -> Option<Self> {
        let mut finer = Finer::new(self, bulge);
        let mut at_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        for number in 0..finer.patches.len() {
            for k in 0..3 {
                at_edge.entry(finer.edge(number, k)).or_default().push(number);
            }
        }
        let is_long = |edge: &Edge| edge.length > longest;
        let mut long: BinaryHeap<Edge> =
            at_edge.keys().map(|&ends| finer.measured(ends)).filter(is_long).collect();
        while let Some(Edge { ends, .. }) = long.pop() {
            let cut = at_edge.remove(&ends).unwrap_or_default();
            let mut new_vertex = None;
            for number in cut {
                let Some(k) = (0..3).find(|&k| finer.edge(number, k) == ends) else { continue };
                let vertex = *new_vertex.get_or_insert_with(|| finer.add(number, k));
                let added = finer.cut(number, k, vertex);
                let others = [finer.edge(number, 0), finer.edge(number, 1)];
                let beside = [finer.edge(added, 0), finer.edge(added, 1)];
                // The side that the first half gave to the second one.
                let moved = at_edge.entry(beside[1]).or_default();
                moved.retain(|&triangle| triangle != number);
                moved.push(added);
                for (edge, triangles) in
                    [(others[0], &[number][..]), (others[1], &[number, added]), (beside[0], &[added])]
                {
                    let known = at_edge.entry(edge).or_default();
                    if known.is_empty() {
                        long.extend(Some(finer.measured(edge)).filter(is_long));
                    }
                    known.extend(triangles);
                }
            }
            if finer.patches.len() > most {
                return None;
            }
        }
        let triangles = finer.patches.iter().map(|patch| patch.corners).collect();
        Some(Self { vertices: finer.vertices, triangles })
    }
}

/// A mesh that becomes finer.
struct Finer {
    vertices: Vec<Vector3<f64>>,
    patches: Vec<Patch>,
}

impl Finer {
    fn new(mesh: &TriangleMesh, bulge: f64) -> Self {
        Self { vertices: mesh.vertices.clone(), patches: patches(mesh, bulge) }
    }

    fn edge(&self, triangle: usize, k: usize) -> [u32; 2] {
        let corners = self.patches[triangle].corners;
        edge([corners[k], corners[(k + 1) % 3]])
    }

    fn measured(&self, ends: [u32; 2]) -> Edge {
        let [p, q] = ends.map(|vertex| self.vertices[vertex as usize]);
        Edge { length: (q - p).norm(), ends }
    }

    /// Middle of edge k of a triangle, on its smooth surface, and the normal there.
    fn middle(&self, triangle: usize, k: usize) -> [Vector3<f64>; 2] {
        let Patch { corners, normals, .. } = &self.patches[triangle];
        let [p, q] = [corners[k], corners[(k + 1) % 3]].map(|vertex| &self.vertices[vertex as usize]);
        middle([p, q], [&normals[k], &normals[(k + 1) % 3]])
    }

    /// Adds the middle of edge k of a triangle: on the chord where the surface is not smooth beyond it.
    fn add(&mut self, triangle: usize, k: usize) -> u32 {
        let patch = &self.patches[triangle];
        let place = if patch.is_smooth[k] {
            self.middle(triangle, k)[0]
        } else {
            let [p, q] = self.edge(triangle, k).map(|vertex| self.vertices[vertex as usize]);
            0.5 * (p + q)
        };
        self.vertices.push(place);
        self.vertices.len() as u32 - 1
    }

    /// Cuts a triangle from a vertex on its edge k to the corner opposite: its first half begins with the
    /// edge's first end, the vertex and the opposite corner; the second half, with the vertex and the edge's
    /// second end, is added. Returns the number of the latter.
    fn cut(&mut self, triangle: usize, k: usize, vertex: u32) -> usize {
        let [_, normal] = self.middle(triangle, k);
        let Patch { corners, normals, is_smooth } = self.patches[triangle];
        let [i, j] = [(k + 1) % 3, (k + 2) % 3];
        self.patches[triangle] = Patch {
            corners: [corners[k], vertex, corners[j]],
            normals: [normals[k], normal, normals[j]],
            is_smooth: [is_smooth[k], true, is_smooth[j]],
        };
        self.patches.push(Patch {
            corners: [vertex, corners[i], corners[j]],
            normals: [normal, normals[i], normals[j]],
            is_smooth: [is_smooth[k], is_smooth[i], true],
        });
        self.patches.len() - 1
    }
}

/// An edge; the longest one is the greatest, and of equal ones that with the lowest ends.
#[derive(Debug, PartialEq)]
struct Edge {
    length: f64,
    ends: [u32; 2],
}

impl Eq for Edge {}

impl Ord for Edge {
    fn cmp(&self, other: &Self) -> Ordering {
        self.length.total_cmp(&other.length).then_with(|| other.ends.cmp(&self.ends))
    }
}

impl PartialOrd for Edge {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SMOOTH_ANGLE;
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

    fn edges(mesh: &TriangleMesh) -> HashMap<[u32; 2], usize> {
        let mut count = HashMap::new();
        for &[a, b, c] in &mesh.triangles {
            for ends in [[a, b], [b, c], [c, a]] {
                *count.entry(edge(ends)).or_insert(0) += 1;
            }
        }
        count
    }

    fn longest(mesh: &TriangleMesh) -> f64 {
        let length = |ends: &[u32; 2]| {
            let [p, q] = ends.map(|vertex| mesh.vertices[vertex as usize]);
            (q - p).norm()
        };
        edges(mesh).keys().map(length).fold(0.0, f64::max)
    }

    fn area(mesh: &TriangleMesh) -> f64 {
        mesh.sizes().map(|size| 3.0_f64.sqrt() / 4.0 * size * size).sum()
    }

    /// Largest distance from the cylinder, but at its ends, where edges stay chords.
    fn off_cylinder(mesh: &TriangleMesh, height: f64) -> f64 {
        let inside = mesh.vertices.iter().filter(|x| x.z > 1e-9 && x.z < height - 1e-9);
        inside.map(|x| (x.x.hypot(x.y) - 1.0).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn split_triangles_of_a_cylinder_lie_on_the_cylinder() {
        let cylinder = cylinder(12, 1.0);
        let finer = cylinder.split();
        assert_eq!(finer.triangles.len(), 4 * cylinder.triangles.len());
        // The cubic is nearly the circle.
        let sagitta = 1.0 - (PI / 12.0).cos();
        let worst = off_cylinder(&finer, 1.0);
        assert!(worst < 0.1 * sagitta, "{worst:.2e} of {sagitta:.2e}");
    }

    #[test]
    fn cut_triangles_of_a_cylinder_lie_on_it_where_it_bulges_little() {
        let cylinder = cylinder(24, 8.0);
        let sagitta = 1.0 - (PI / 24.0).cos();
        let round = cylinder.with_edges_cut(0.2, 2.0 * sagitta, 100_000).unwrap();
        assert!(longest(&round) <= 0.2);
        assert!(off_cylinder(&round, 8.0) < 0.1 * sagitta, "{}", off_cylinder(&round, 8.0));
        // A facet that bulges more than it may stays flat.
        let flat = cylinder.with_edges_cut(0.2, 0.5 * sagitta, 100_000).unwrap();
        assert!((area(&flat) / area(&cylinder) - 1.0).abs() < 1e-12);
        assert!((off_cylinder(&flat, 8.0) / sagitta - 1.0).abs() < 0.1);
    }

    /// Unit cube of two triangles a face.
    fn cube() -> TriangleMesh {
        let vertices =
            (0..8_u32).map(|k| Vector3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)));
        let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
        TriangleMesh { vertices: vertices.collect(), triangles }
    }

    #[test]
    fn a_cube_stays_a_closed_cube() {
        let cube = cube();
        for limit in [2.0, 0.9, 0.3, 0.1] {
            let finer = cube.with_edges_cut(limit, 1.0, 100_000).unwrap();
            assert!(longest(&finer) <= limit);
            assert!(edges(&finer).values().all(|&count| count == 2), "closed, with no T-joint");
            assert!((area(&finer) - 6.0).abs() < 1e-12);
            let bounds = finer.vertices.iter().all(|x| x.iter().any(|x| *x == 0.0 || *x == 1.0));
            assert!(bounds, "all vertices stay in the faces");
        }
        assert_eq!(cube.with_edges_cut(2.0, 1.0, 12).unwrap(), cube, "nothing to do");
        assert!(cube.with_edges_cut(0.1, 1.0, 500).is_none());
    }

    #[test]
    fn slivers_get_short_and_no_worse() {
        // A fan of needles.
        let mut fan = TriangleMesh { vertices: vec![Vector3::zeros()], triangles: Vec::new() };
        for k in 0..=40_u32 {
            fan.vertices.push(Vector3::new(1.0, f64::from(k) / 40.0, 0.0));
        }
        fan.triangles = (1..=40).map(|k| [0, k, k + 1]).collect();
        let shape = |mesh: &TriangleMesh| {
            let quality = mesh.triangles.iter().zip(mesh.sizes()).map(|(&corners, size)| {
                let [a, b, c] = corners.map(|vertex| mesh.vertices[vertex as usize]);
                size / [b - a, c - b, a - c].iter().map(Vector3::norm).fold(0.0, f64::max)
            });
            quality.fold(f64::INFINITY, f64::min)
        };
        let finer = fan.with_edges_cut(0.1, 0.0, 100_000).unwrap();
        assert!(longest(&finer) <= 0.1 && shape(&finer) > 0.5 * shape(&fan), "{}", shape(&finer));
        assert!((area(&finer) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn the_order_of_the_triangles_does_not_matter() {
        let mesh = cylinder(17, 3.0);
        let mut turned = mesh.clone();
        turned.triangles.reverse();
        turned.triangles.iter_mut().for_each(|corners| corners.rotate_left(1));
        let places = |mesh: &TriangleMesh| {
            let finer = mesh.with_edges_cut(0.25, 0.1, 100_000).unwrap();
            let mut places: Vec<[i64; 3]> =
                finer.vertices.iter().map(|x| [0, 1, 2].map(|k| (x[k] * 1e9).round() as i64)).collect();
            places.sort_unstable();
            (places, finer.triangles.len())
        };
        assert_eq!(places(&mesh), places(&turned));
        assert!(TAU / 17.0 < SMOOTH_ANGLE);
    }
}
