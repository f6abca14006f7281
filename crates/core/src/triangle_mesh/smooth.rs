//! The smooth surface whose chords the triangles of a mesh are.
//!
//! Each triangle is a cubic Bézier patch through its corners, whose edges leave each corner in the plane
//! across the surface's normal there (Vlachos et al., Curved PN triangles, I3D 2001), and along the crease
//! where two surfaces meet.

use super::TriangleMesh;
use nalgebra::Vector3;
use std::collections::HashMap;
use std::f64::consts::FRAC_PI_2;

/// Angle between two triangles up to which their surface is smooth [rad]: 40 degrees.
pub const SMOOTH_ANGLE: f64 = FRAC_PI_2 * 40.0 / 90.0;

/// Sine of the angle between two normals from which on they tell the direction of a crease.
const LEAST_CREASE: f64 = 0.1;

/// A triangle of a smooth surface: a cubic patch through its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmoothPatch {
    /// Vertices.
    pub corners: [u32; 3],
    /// Control points of the edge from each corner to the next one, a third and two thirds along it [m].
    controls: [[Vector3<f64>; 2]; 3],
}

impl SmoothPatch {
    /// Ends of the edge from corner k to the next one, the lower vertex first.
    #[must_use]
    pub fn edge(&self, k: usize) -> [u32; 2] {
        edge([self.corners[k], self.corners[(k + 1) % 3]])
    }

    /// Place on edge k of the patch [m], from the lower vertex (0) to the higher one (1).
    #[must_use]
    pub fn on_edge(&self, mesh: &TriangleMesh, k: usize, along: f64) -> Vector3<f64> {
        let next = (k + 1) % 3;
        let is_forwards = self.corners[k] < self.corners[next];
        let mut shares = [0.0; 3];
        shares[next] = if is_forwards { along } else { 1.0 - along };
        shares[k] = 1.0 - shares[next];
        self.at(mesh, shares)
    }

    /// Place on the patch [m] at barycentric coordinates, one for each corner.
    #[must_use]
    pub fn at(&self, mesh: &TriangleMesh, shares: [f64; 3]) -> Vector3<f64> {
        let corners = self.corners.map(|vertex| mesh.vertices[vertex as usize]);
        let control = |i: usize, j: usize| {
            if (i + 1) % 3 == j { self.controls[i][0] } else { self.controls[j][1] }
        };
        let mut place = Vector3::zeros();
        let mut mean_of_controls = Vector3::zeros();
        for i in 0..3 {
            place += corners[i] * shares[i].powi(3);
            for j in [(i + 1) % 3, (i + 2) % 3] {
                let control = control(i, j);
                place += control * (3.0 * shares[i] * shares[i] * shares[j]);
                mean_of_controls += control / 6.0;
            }
        }
        let centre = corners.iter().sum::<Vector3<f64>>() / 3.0;
        let middle = mean_of_controls + 0.5 * (mean_of_controls - centre);
        place + middle * (6.0 * shares[0] * shares[1] * shares[2])
    }
}

/// An edge, the lower vertex first.
fn edge([p, q]: [u32; 2]) -> [u32; 2] {
    [p.min(q), p.max(q)]
}

impl TriangleMesh {
    /// Patches of the smooth surface whose chords the triangles are, without triangles that have no area.
    ///
    /// An edge is smooth where two triangles meet at less than [`SMOOTH_ANGLE`] and the surface bulges by
    /// `most` [m] beyond them at most.
    #[must_use]
    pub fn smooth_patches(&self, most: f64) -> Vec<SmoothPatch> {
        let faces: Vec<Face> =
            self.triangles.iter().filter_map(|&corners| Face::new(self, corners)).collect();
        let mut at_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        let mut at_vertex = vec![Vec::new(); self.vertices.len()];
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
        let normals: Vec<[Vector3<f64>; 3]> = (0..faces.len())
            .map(|number| [0, 1, 2].map(|k| normal(&faces, &at_vertex, number, k, beyond)))
            .collect();
        // Neighbours of a vertex along the rim.
        let mut on_rim: HashMap<u32, Vec<u32>> = HashMap::new();
        for (&[p, q], _) in at_edge.iter().filter(|(_, faces)| faces.len() == 1) {
            on_rim.entry(p).or_default().push(q);
            on_rim.entry(q).or_default().push(p);
        }
        // Control points of edge k of a face.
        let controls = |number: usize, k: usize| {
            let ends = [k, (k + 1) % 3].map(|k| faces[number].corners[k]);
            let [p, q] = ends.map(|vertex| self.vertices[vertex as usize]);
            let straight = [p + (q - p) / 3.0, q + (p - q) / 3.0];
            let own = [normals[number][k], normals[number][(k + 1) % 3]];
            let bent = match *at_edge[&faces[number].edge(k)].as_slice() {
                [_] => {
                    let beyond = |at: usize| match on_rim[&ends[at]].as_slice() {
                        &[a, b] => Some(self.vertices[if a == ends[1 - at] { b } else { a } as usize]),
                        _ => None,
                    };
                    along_rim([p, q], [beyond(0), beyond(1)])
                }
                [_, _] if beyond(number, k).is_some() => in_planes([p, q], own),
                [a, b] => {
                    let other = if a == number { b } else { a };
                    along_crease([p, q], own, ends.map(|vertex| faces[other].at(vertex, &normals[other])))
                }
                _ => straight,
            };
            let bulge = 3.0 / 8.0 * ((bent[0] - straight[0]) + (bent[1] - straight[1])).norm();
            if bulge <= most { bent } else { straight }
        };
        let of_face = |(number, face): (usize, &Face)| SmoothPatch {
            corners: face.corners,
            controls: [0, 1, 2].map(|k| controls(number, k)),
        };
        faces.iter().enumerate().map(of_face).collect()
    }
}

/// Control points of an edge that leaves its ends in the planes across the surface's normals.
fn in_planes([p, q]: [Vector3<f64>; 2], [n, m]: [Vector3<f64>; 2]) -> [Vector3<f64>; 2] {
    let along = q - p;
    [p + (along - n * n.dot(&along)) / 3.0, q - (along - m * m.dot(&along)) / 3.0]
}

/// Control points of an edge of a rim between the corners beyond its ends: it leaves each end as the chord
/// through both its neighbours does, where the rim does not turn there by more than [`SMOOTH_ANGLE`].
fn along_rim([p, q]: [Vector3<f64>; 2], beyond: [Option<Vector3<f64>>; 2]) -> [Vector3<f64>; 2] {
    let along = q - p;
    let direction = |place: Vector3<f64>, beyond: Option<Vector3<f64>>, to: Vector3<f64>| {
        let chord = beyond.map(|beyond| (to - place, place - beyond));
        let smooth = chord.filter(|(next, last)| next.angle(last) < SMOOTH_ANGLE);
        smooth.map_or(along, |(next, last)| {
            // The tangent of the circle through the three corners.
            let mean = (next / next.norm_squared() + last / last.norm_squared()).normalize();
            mean * mean.dot(&along)
        })
    };
    [p + direction(p, beyond[0], q) / 3.0, q - direction(q, beyond[1], p) / 3.0]
}

/// Control points of an edge in which two surfaces meet: it leaves its ends in the planes of both.
fn along_crease(
    [p, q]: [Vector3<f64>; 2],
    own: [Vector3<f64>; 2],
    other: [Vector3<f64>; 2],
) -> [Vector3<f64>; 2] {
    let along = q - p;
    let direction = |k: usize| {
        let common = own[k].cross(&other[k]);
        common.try_normalize(LEAST_CREASE).map_or(along, |common| common * common.dot(&along))
    };
    [p + direction(0) / 3.0, q - direction(1) / 3.0]
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

    /// Normal at a vertex, of those at the corners.
    fn at(&self, vertex: u32, normals: &[Vector3<f64>; 3]) -> Vector3<f64> {
        (0..3).find(|&k| self.corners[k] == vertex).map_or(self.normal, |k| normals[k])
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
