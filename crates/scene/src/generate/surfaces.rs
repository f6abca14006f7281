//! Surfaces of triangles from which a generator keeps grains away, and the side of them on which it stays.

use amberfield_core::TriangleMesh;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Most cells of the search along an axis.
const MOST_CELLS: f64 = 64.0;

/// Corners of a triangle [m].
type Corners = [Vector3<f64>; 3];

/// All surfaces of a scene.
#[derive(Clone, Debug)]
pub(super) struct Surfaces {
    triangles: Vec<Corners>,
    /// Surface of each triangle.
    surface: Vec<u32>,
    /// Side of each surface on which grains are: inside, outside, or any where it is not closed.
    inside: Vec<Option<bool>>,
    /// Lower corner of the cells [m].
    min: Vector3<f64>,
    /// Edge of a cell [m].
    edge: f64,
    /// Triangles whose boxes meet a cell.
    cells: HashMap<[i64; 3], Vec<u32>>,
    /// Triangles whose boxes meet a column of cells along z.
    columns: HashMap<[i64; 2], Vec<u32>>,
}

impl Surfaces {
    /// Sorts the triangles of surfaces; grains are on the side of each closed one on which most of the
    /// `places` are.
    pub(super) fn new<'a>(meshes: impl Iterator<Item = &'a TriangleMesh>, places: &[Vector3<f64>]) -> Self {
        let (mut triangles, mut surface, mut closed) = (Vec::new(), Vec::new(), Vec::new());
        for (number, mesh) in (0..).zip(meshes) {
            for corners in &mesh.triangles {
                triangles.push(corners.map(|k| mesh.vertices[k as usize]));
                surface.push(number);
            }
            closed.push(is_closed(mesh));
        }
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        for corner in triangles.iter().flatten() {
            (low, high) = (low.inf(corner), high.sup(corner));
        }
        let edge = if triangles.is_empty() { 1.0 } else { ((high - low).max() / MOST_CELLS).max(1e-12) };
        let mut found = Self {
            triangles,
            surface,
            inside: vec![None; closed.len()],
            min: low,
            edge,
            cells: HashMap::new(),
            columns: HashMap::new(),
        };
        for (number, corners) in (0..).zip(&found.triangles) {
            let (low, high) = (found.cell(&least(corners)), found.cell(&most(corners)));
            for x in low[0]..=high[0] {
                for y in low[1]..=high[1] {
                    found.columns.entry([x, y]).or_default().push(number);
                    for z in low[2]..=high[2] {
                        found.cells.entry([x, y, z]).or_default().push(number);
                    }
                }
            }
        }
        for (number, _) in closed.iter().enumerate().filter(|(_, closed)| **closed) {
            let inside = places.iter().filter(|place| found.is_inside(number as u32, place)).count();
            found.inside[number] = Some(2 * inside > places.len());
        }
        found
    }

    /// Whether a sphere touches no surface and is on the side of each closed one on which grains are.
    pub(super) fn allow(&self, centre: &Vector3<f64>, radius: f64) -> bool {
        let is_near = self.near(centre, radius).any(|t| (self.closest(t, centre) - centre).norm() < radius);
        !is_near
            && (0..).zip(&self.inside).all(|(surface, inside)| {
                inside.is_none_or(|inside| self.is_inside(surface, centre) == inside)
            })
    }

    /// Moves a centre off the surfaces that a sphere touches, one after another.
    pub(super) fn push_off(&self, mut centre: Vector3<f64>, radius: f64) -> Vector3<f64> {
        let near: Vec<u32> = self.near(&centre, radius).collect();
        for triangle in near {
            let off = centre - self.closest(triangle, &centre);
            let distance = off.norm();
            if distance < radius && distance > 0.0 {
                centre += off * ((radius - distance) / distance);
            }
        }
        centre
    }

    fn cell(&self, place: &Vector3<f64>) -> [i64; 3] {
        #[expect(clippy::cast_possible_truncation, reason = "cells are few, and places beyond saturate")]
        std::array::from_fn(|axis| ((place[axis] - self.min[axis]) / self.edge).floor() as i64)
    }

    /// Triangles that may be within a distance [m] of a place, some of them more than once.
    fn near<'a>(&'a self, place: &Vector3<f64>, distance: f64) -> impl Iterator<Item = u32> + 'a {
        let reach = Vector3::repeat(distance);
        let last = MOST_CELLS as i64 + 1;
        let low = self.cell(&(place - reach)).map(|cell| cell.max(-1));
        let high = self.cell(&(place + reach)).map(|cell| cell.min(last));
        let all = (low[0]..=high[0]).flat_map(move |x| {
            (low[1]..=high[1]).flat_map(move |y| (low[2]..=high[2]).map(move |z| [x, y, z]))
        });
        all.filter_map(|cell| self.cells.get(&cell)).flatten().copied()
    }

    /// Whether a place is inside a closed surface: a ray along z leaves it through an odd number of
    /// triangles.
    fn is_inside(&self, surface: u32, place: &Vector3<f64>) -> bool {
        let [x, y, _] = self.cell(place);
        let column = self.columns.get(&[x, y]).map_or(&[][..], Vec::as_slice);
        let crossed = |triangle: &&u32| {
            self.surface[**triangle as usize] == surface
                && is_above(&self.triangles[**triangle as usize], place)
        };
        column.iter().filter(crossed).count() % 2 == 1
    }

    /// Closest point of a triangle.
    fn closest(&self, triangle: u32, place: &Vector3<f64>) -> Vector3<f64> {
        let corners = &self.triangles[triangle as usize];
        let [a, b, c] = corners;
        let normal = (b - a).cross(&(c - a));
        let foot = place - normal * ((place - a).dot(&normal) / normal.norm_squared());
        let is_within = (0..3).all(|k| {
            let (from, to) = (corners[k], corners[(k + 1) % 3]);
            (to - from).cross(&(foot - from)).dot(&normal) >= 0.0
        });
        if is_within {
            return foot;
        }
        let on_edges = (0..3).map(|k| {
            let (from, edge) = (corners[k], corners[(k + 1) % 3] - corners[k]);
            from + edge * ((place - from).dot(&edge) / edge.norm_squared()).clamp(0.0, 1.0)
        });
        let distance = |point: &Vector3<f64>| (point - place).norm_squared();
        on_edges.min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("three edges")
    }
}

fn least(corners: &Corners) -> Vector3<f64> {
    corners[0].inf(&corners[1]).inf(&corners[2])
}

fn most(corners: &Corners) -> Vector3<f64> {
    corners[0].sup(&corners[1]).sup(&corners[2])
}

/// Whether each edge of a surface belongs to two triangles.
fn is_closed(mesh: &TriangleMesh) -> bool {
    let mut count: HashMap<[u32; 2], u32> = HashMap::new();
    for &[a, b, c] in &mesh.triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            *count.entry([from.min(to), from.max(to)]).or_default() += 1;
        }
    }
    count.values().all(|count| *count == 2)
}

/// Whether a triangle is above a place along z. Edges belong to one side, so that a ray that meets one
/// crosses one of two triangles.
fn is_above(corners: &Corners, place: &Vector3<f64>) -> bool {
    let crosses = |k: usize| {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let left = from.x + (place.y - from.y) / (to.y - from.y) * (to.x - from.x);
        (from.y > place.y) != (to.y > place.y) && place.x < left
    };
    let is_within = (0..3).filter(|&k| crosses(k)).count() % 2 == 1;
    let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
    // Height of the triangle's plane over the place.
    is_within && (corners[0] - place).dot(&normal) * normal.z > 0.0
}
