//! The smooth surface whose chords the triangles of a mesh are.
//!
//! The middle of an edge from p to p' is that of the cubic curve through both with their normals n and n',
//! ½(p + p') − [n n·(p' − p) + n' n'·(p − p')]/8 (Vlachos et al., Curved PN triangles, I3D 2001).

use super::TriangleMesh;
use nalgebra::Vector3;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

/// Angle between two triangles up to which their surface is smooth [rad]: 40 degrees.
pub const SMOOTH_ANGLE: f64 = FRAC_PI_2 * 40.0 / 90.0;

/// A triangle of a smooth surface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patch {
    /// Vertices.
    pub(super) corners: [u32; 3],
    /// Unit normal of the smooth surface at each corner, all on one side.
    pub(super) normals: [Vector3<f64>; 3],
    /// Whether the surface goes on smoothly beyond the edge from each corner to the next one.
    pub(super) is_smooth: [bool; 3],
}

/// An edge, the lower vertex first.
pub(super) fn edge([p, q]: [u32; 2]) -> [u32; 2] {
    [p.min(q), p.max(q)]
}

/// Middle of an edge of the smooth surface: place [m] and unit normal.
pub(super) fn middle(ends: [&Vector3<f64>; 2], normals: [&Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
    let ([p, q], [n, m]) = (ends, normals);
    let along = q - p;
    let bulge = (n * n.dot(&along) - m * m.dot(&along)) / 8.0;
    // The sum of both normals, mirrored in the plane across the edge, for normals that turn at an even rate.
    let sum = n + m;
    let turned = sum - along * (2.0 * along.dot(&sum) / along.norm_squared().max(f64::MIN_POSITIVE));
    [0.5 * (p + q) - bulge, (sum + turned).normalize()]
}

/// Patches of a mesh, without triangles that have no area. An edge is smooth where two triangles meet at less
/// than [`SMOOTH_ANGLE`] and the surface bulges by no more than `most` [m] beyond them.
pub(super) fn patches(mesh: &TriangleMesh, most: f64) -> Vec<Patch> {
    let faces: Vec<Face> = mesh.triangles.iter().filter_map(|&corners| Face::new(mesh, corners)).collect();
    let mut at_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
    let mut at_vertex = vec![Vec::new(); mesh.vertices.len()];
    for (number, face) in faces.iter().enumerate() {
        for k in 0..3 {
            at_edge.entry(face.edge(k)).or_default().push(number);
            at_vertex[face.corners[k] as usize].push(number);
        }
    }
    // The face beyond an edge, where the surface is smooth there.
    let beyond = |number: usize, k: usize| {
        let [a, b] = *at_edge[&faces[number].edge(k)].as_slice() else { return None };
        let other = if a == number { b } else { a };
        faces[number].goes_on(&faces[other], k, most).then_some(other)
    };
    let of_face = |(number, face): (usize, &Face)| Patch {
        corners: face.corners,
        normals: [0, 1, 2].map(|k| normal(&faces, &at_vertex, number, k, beyond)),
        is_smooth: [0, 1, 2].map(|k| beyond(number, k).is_some()),
    };
    faces.iter().enumerate().map(of_face).collect()
}

/// A triangle with an area.
struct Face {
    corners: [u32; 3],
    /// Unit normal.
    normal: Vector3<f64>,
    /// Angle at each corner [rad].
    angles: [f64; 3],
    /// Height of the triangle over the edge from each corner to the next one [m].
    heights: [f64; 3],
}

impl Face {
    fn new(mesh: &TriangleMesh, corners: [u32; 3]) -> Option<Self> {
        let places = corners.map(|vertex| mesh.vertices[vertex as usize]);
        let side = |k: usize| places[(k + 1) % 3] - places[k % 3];
        let across = side(0).cross(&side(1));
        let normal = across.try_normalize(f64::MIN_POSITIVE)?;
        let angles = [0, 1, 2].map(|k| side(k).angle(&-side(k + 2)));
        let heights = [0, 1, 2].map(|k| across.norm() / side(k).norm());
        Some(Self { corners, normal, angles, heights })
    }

    fn edge(&self, k: usize) -> [u32; 2] {
        edge([self.corners[k], self.corners[(k + 1) % 3]])
    }

    /// Whether the surface is smooth at edge k, beyond which another face lies.
    fn goes_on(&self, other: &Self, k: usize, most: f64) -> bool {
        let along = self.edge(k);
        let beyond = (0..3).find(|&k| other.edge(k) == along).map_or(0.0, |k| other.heights[k]);
        let angle = self.normal.dot(&other.normal).abs().min(1.0).acos();
        angle < SMOOTH_ANGLE && angle * 0.5 * (self.heights[k] + beyond) / 8.0 <= most
    }
}

/// Normal at corner k of a face, on its side: that of the faces that can be reached over smooth edges at the
/// corner and are turned by less than [`SMOOTH_ANGLE`] against it, each by its angle there.
fn normal(
    faces: &[Face],
    at_vertex: &[Vec<usize>],
    number: usize,
    k: usize,
    beyond: impl Fn(usize, usize) -> Option<usize>,
) -> Vector3<f64> {
    let own = faces[number].normal;
    let vertex = faces[number].corners[k];
    let here = &at_vertex[vertex as usize];
    let mut reached = vec![number];
    let mut next = 0;
    while let Some(&at) = reached.get(next) {
        next += 1;
        for side in (0..3).filter(|&side| faces[at].edge(side).contains(&vertex)) {
            let Some(other) = beyond(at, side) else { continue };
            let turned = faces[other].normal.dot(&own).abs() < SMOOTH_ANGLE.cos();
            if !turned && !reached.contains(&other) {
                reached.push(other);
            }
        }
    }
    // In the order of the faces, so that the sum does not depend on where the walk began.
    let of = |&other: &usize| {
        let face = &faces[other];
        let corner = (0..3).find(|&k| face.corners[k] == vertex).unwrap_or_default();
        face.normal * (face.angles[corner] * own.dot(&face.normal).signum())
    };
    here.iter().filter(|other| reached.contains(other)).map(of).sum::<Vector3<f64>>().normalize()
}
