//! Image charges outside the mesh, which make the far level's boundary data smooth.
//!
//! The field is exact whatever they are, as long as they lie outside. A charge at distance δ from a wall is
//! mirrored in it with the charge −q f(δ) (potential prescribed) or +q f(δ) (slope prescribed): f is 1 up
//! to half the depth D and falls to 0 at D as 1 − u³(10 − 15u + 6u²), u = 2δ/D − 1. In a conductor of mean
//! curvature κ it is the image of the sphere of that curvature, −q/(1 − κδ) at δ/(1 − κδ) (Jackson,
//! Classical Electrodynamics, 3rd ed., §2.2). Two walls at an angle mirror each other's images.

mod curved;
mod flat;
mod patch;

use super::mesh::{Condition, FarMesh};
use curved::CurvedWall;
use flat::FlatWall;
use nalgebra::Vector3;
use patch::{Patch, half_diagonal};

/// Faces whose normals and planes differ by less are flat, over one and over the face's size.
const FLAT: f64 = 1e-6;
/// Cosine of the angle between neighbouring faces up to which they are one wall.
const SMOOTH: f64 = 0.77;
/// Distance of neighbouring faces' centres over their half diagonals.
const NEIGHBOURS: f64 = 1.2;
/// Image charges below this share of their charge are left out.
const LEAST: f64 = 1e-9;
/// Depths over the mesh's extent across a wall: opposite walls' images never meet.
const OF_GAP: f64 = 0.5;
/// Cosine of walls that count as parallel.
const PARALLEL: f64 = 0.7;
/// Walls that mirror one charge at most.
const MOST: usize = 6;

/// Mirror that a wall is for a charge: the tangent plane, the charge's distance and the wall's curvature
/// there.
#[derive(Clone, Copy, Debug)]
struct Mirror {
    normal: Vector3<f64>,
    offset: f64,
    distance: f64,
    /// Mean curvature towards the charge [1/m].
    curvature: f64,
    /// Deepest charge that is mirrored [m].
    depth: f64,
}

impl Mirror {
    /// Charge of the image over the charge's, but for the sign.
    fn factor(&self) -> f64 {
        let u = (2.0 * self.distance / self.depth - 1.0).max(0.0);
        let fade = 1.0 - u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
        fade / (1.0 - self.curvature * self.distance)
    }

    /// The image of the charge itself.
    fn image(&self, point: &Vector3<f64>) -> Vector3<f64> {
        point + self.normal * (self.distance + self.distance / (1.0 - self.curvature * self.distance))
    }

    /// The image of another wall's image, in the plane.
    fn again(&self, point: &Vector3<f64>) -> Vector3<f64> {
        point + self.normal * (2.0 * (self.offset - self.normal.dot(point)))
    }
}

#[derive(Debug)]
enum Shape {
    Flat(FlatWall),
    Curved(CurvedWall),
}

/// A wall and what its images' charges are multiplied with.
#[derive(Debug)]
struct Wall {
    shape: Shape,
    sign: f64,
}

/// The walls of a mesh.
#[derive(Debug)]
pub(crate) struct Walls {
    /// Curved ones first.
    walls: Vec<Wall>,
    /// Point of the wall at which each boundary face's condition holds [m].
    places: Vec<Vector3<f64>>,
}

impl Walls {
    /// Walls that mirror charges up to `depth` [m].
    pub(crate) fn new(mesh: &FarMesh, depth: f64) -> Self {
        let boundary = mesh.boundary();
        let mut places: Vec<_> = boundary.iter().map(|face| mesh.place_of_condition(face)).collect();
        let around = neighbours(mesh);
        let mut walls = Vec::new();
        for faces in connected(&around) {
            let sign = match boundary[faces[0] as usize].condition {
                Condition::Potential(_) => -1.0,
                Condition::Slope(_) => 1.0,
            };
            let shape = match FlatWall::new(mesh, &faces, depth) {
                Some(wall) => Shape::Flat(wall),
                None => {
                    let number = |face: &u32| faces.binary_search(face).expect("connected") as u32;
                    let within: Vec<Vec<u32>> = faces
                        .iter()
                        .map(|&face| around[face as usize].iter().map(number).collect())
                        .collect();
                    let wall = CurvedWall::new(mesh, &faces, &within, depth);
                    for (index, &face) in faces.iter().enumerate() {
                        places[face as usize] = wall.place(index, &places[face as usize]);
                    }
                    Shape::Curved(wall)
                }
            };
            walls.push(Wall { shape, sign });
        }
        walls.sort_by_key(|wall| matches!(wall.shape, Shape::Flat(_)));
        Self { walls, places }
    }

    /// Point of the wall at which each boundary face's condition holds [m].
    pub(crate) fn places(&self) -> &[Vector3<f64>] {
        &self.places
    }

    /// Calls `visit` with every image of a charge at `point` and its charge over the charge's.
    pub(crate) fn for_each(&self, point: &Vector3<f64>, mut visit: impl FnMut(Vector3<f64>, f64)) {
        let mut mirrors = [None; MOST];
        let found = self.walls.iter().filter_map(|wall| {
            let mirror = match &wall.shape {
                Shape::Flat(flat) => flat.mirror(point)?,
                Shape::Curved(curved) => curved.mirror(point)?,
            };
            let factor = wall.sign * mirror.factor();
            (factor.abs() >= LEAST).then_some((mirror, factor))
        });
        for (slot, mirror) in mirrors.iter_mut().zip(found) {
            *slot = Some(mirror);
        }
        let mirrors = mirrors.iter().flatten();
        for (first, (wall, factor)) in mirrors.clone().enumerate() {
            let image = wall.image(point);
            visit(image, *factor);
            for (second, (other, more)) in mirrors.clone().enumerate().skip(first + 1) {
                let factor = factor * more;
                if !are_across(wall, other) || factor.abs() < LEAST {
                    continue;
                }
                let image = other.again(&image);
                visit(image, factor);
                for (third, more) in mirrors.clone().skip(second + 1) {
                    let factor = factor * more;
                    if are_across(wall, third) && are_across(other, third) && factor.abs() >= LEAST {
                        visit(third.again(&image), factor);
                    }
                }
            }
        }
    }
}

/// Whether two walls stand at an angle near a right one.
fn are_across(a: &Mirror, b: &Mirror) -> bool {
    a.normal.dot(&b.normal).abs() < PARALLEL
}

/// Each boundary face's neighbours that go on smoothly, with a condition of the same kind.
fn neighbours(mesh: &FarMesh) -> Vec<Vec<u32>> {
    let boundary = mesh.boundary();
    let all: Vec<u32> = (0..boundary.len() as u32).collect();
    let patch = Patch::new(boundary, &all, 0.0);
    let go_on = |a: usize, b: usize| {
        let (first, second) = (&boundary[a], &boundary[b]);
        let near = NEIGHBOURS * (half_diagonal(first) + half_diagonal(second));
        let kind = |condition| matches!(condition, Condition::Potential(_));
        a != b
            && (first.centre - second.centre).norm() < near
            && first.normal.dot(&second.normal) > SMOOTH
            && kind(first.condition) == kind(second.condition)
    };
    let of = |face: usize| {
        let mut found: Vec<u32> = patch
            .near(&boundary[face].centre)
            .filter(|&other| go_on(face, other))
            .map(|other| other as u32)
            .collect();
        found.sort_unstable();
        found
    };
    (0..boundary.len()).map(of).collect()
}

/// Sets of faces that are connected, each in ascending order.
fn connected(around: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut seen = vec![false; around.len()];
    let mut sets = Vec::new();
    for first in 0..around.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut set = vec![first as u32];
        let mut next = 0;
        while let Some(&face) = set.get(next) {
            next += 1;
            for &other in &around[face as usize] {
                if !std::mem::replace(&mut seen[other as usize], true) {
                    set.push(other);
                }
            }
        }
        set.sort_unstable();
        sets.push(set);
    }
    sets
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::far::mesh::FarMeshParts;
    use amberfield_core::{Boundary, Domain};

    #[test]
    fn corner_of_a_box_has_seven_images_with_the_walls_signs() {
        let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
        let faces = [[Boundary::Grounded; 2], [insulating; 2], [Boundary::Grounded; 2]];
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
        let mesh = FarMesh::new(FarMeshParts::of_box(&domain, [8; 3]).unwrap()).unwrap();
        let images = Walls::new(&mesh, 0.4);
        let mut found = Vec::new();
        images.for_each(&Vector3::new(0.1, 0.12, 0.15), |at, factor| found.push((at, factor)));
        assert_eq!(found.len(), 7);
        for (at, factor) in found {
            let conductors = (0..3).filter(|&axis| axis != 1 && at[axis] < 0.0).count();
            assert!((factor - if conductors == 1 { -1.0 } else { 1.0 }).abs() < 1e-12, "{at} {factor}");
        }
        let mut deep = 0;
        images.for_each(&Vector3::repeat(0.5), |_, _| deep += 1);
        assert_eq!(deep, 0);
    }
}
