//! Image charges outside the mesh, which make the far level's boundary data smooth.
//!
//! The field is exact whatever they are, as long as they lie outside. A charge at distance δ from a flat wall is mirrored in
//! it with the charge −q f(δ) (potential prescribed) or +q f(δ) (slope prescribed): f is 1 up to half the depth D and falls to 0
//! at D as 1 − u³(10 − 15u + 6u²), u = 2δ/D − 1. Two walls at an angle mirror each other's images.

use super::mesh::{BoundaryFace, Condition, FarMesh};
use nalgebra::Vector3;

/// Faces whose normals and planes differ by less are one wall, over one and over the cell size.
const FLAT: f64 = 1e-6;
/// Image charges below this share of their charge are left out.
const LEAST: f64 = 1e-9;
/// Depths over the mesh's extent across a wall: opposite walls' images never meet.
const OF_GAP: f64 = 0.5;
/// Cosine of walls that count as parallel.
const PARALLEL: f64 = 0.7;

/// A flat piece of the boundary.
#[derive(Clone, Debug)]
struct Wall {
    normal: Vector3<f64>,
    offset: f64,
    /// Whether the potential is prescribed.
    conductor: bool,
    /// Corners of its extent [m].
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Deepest charge that it mirrors [m].
    depth: f64,
}

impl Wall {
    fn new(face: &BoundaryFace) -> Self {
        Self {
            normal: face.normal,
            offset: face.normal.dot(&face.centre),
            conductor: matches!(face.condition, Condition::Potential(_)),
            low: face.centre,
            high: face.centre,
            depth: 0.0,
        }
    }

    fn holds(&self, face: &BoundaryFace, size: f64) -> bool {
        (face.normal - self.normal).norm() < FLAT
            && (face.normal.dot(&face.centre) - self.offset).abs() < FLAT * size
            && self.conductor == matches!(face.condition, Condition::Potential(_))
    }

    /// Factor of the image of a charge at a point; 0 where the wall mirrors nothing.
    fn factor(&self, point: &Vector3<f64>) -> f64 {
        let distance = self.offset - self.normal.dot(point);
        let foot = point + self.normal * distance;
        let beside = (0..3).any(|axis| foot[axis] < self.low[axis] || foot[axis] > self.high[axis]);
        if beside || !(0.0..self.depth).contains(&distance) {
            return 0.0;
        }
        let u = (2.0 * distance / self.depth - 1.0).max(0.0);
        let fade = 1.0 - u * u * u * (10.0 - 15.0 * u + 6.0 * u * u);
        if self.conductor { -fade } else { fade }
    }

    fn mirror(&self, point: &Vector3<f64>) -> Vector3<f64> {
        point + self.normal * (2.0 * (self.offset - self.normal.dot(point)))
    }
}

/// The walls of a mesh and what they mirror.
#[derive(Debug)]
pub(crate) struct WallImages {
    walls: Vec<Wall>,
}

impl WallImages {
    /// Walls that mirror charges up to `depth` [m].
    pub(crate) fn new(mesh: &FarMesh, depth: f64) -> Self {
        let size = mesh.largest_cell();
        let mut walls: Vec<Wall> = Vec::new();
        for face in mesh.boundary() {
            let index = match walls.iter().position(|wall| wall.holds(face, size)) {
                Some(index) => index,
                None => {
                    walls.push(Wall::new(face));
                    walls.len() - 1
                }
            };
            let reach = Vector3::repeat(0.5 * face.area.sqrt());
            let wall = &mut walls[index];
            wall.low = wall.low.inf(&(face.centre - reach));
            wall.high = wall.high.sup(&(face.centre + reach));
        }
        for wall in &mut walls {
            let along: f64 =
                (0..3).map(|axis| (wall.normal[axis] * mesh.domain().extent()[axis]).abs()).sum();
            wall.depth = depth.min(OF_GAP * along);
            // Feet lie on the plane to rounding only.
            let slack = Vector3::repeat(FLAT * size);
            (wall.low, wall.high) = (wall.low - slack, wall.high + slack);
        }
        Self { walls }
    }

    /// Calls `visit` with every image of a charge at `point` and its charge over the charge's.
    pub(crate) fn for_each(&self, point: &Vector3<f64>, mut visit: impl FnMut(Vector3<f64>, f64)) {
        for (first, wall) in self.walls.iter().enumerate() {
            let factor = wall.factor(point);
            if factor.abs() < LEAST {
                continue;
            }
            let image = wall.mirror(point);
            visit(image, factor);
            for (second, other) in self.walls.iter().enumerate().skip(first + 1) {
                let factor = factor * across(wall, other) * other.factor(point);
                if factor.abs() < LEAST {
                    continue;
                }
                let image = other.mirror(&image);
                visit(image, factor);
                for third in self.walls.iter().skip(second + 1) {
                    let factor = factor * across(wall, third) * across(other, third) * third.factor(point);
                    if factor.abs() >= LEAST {
                        visit(third.mirror(&image), factor);
                    }
                }
            }
        }
    }
}

/// 1 for two walls at an angle near a right one, 0 for nearly parallel ones.
fn across(a: &Wall, b: &Wall) -> f64 {
    f64::from(u8::from(a.normal.dot(&b.normal).abs() < PARALLEL))
}

#[cfg(test)]
mod tests {
    use super::super::mesh::FarMeshParts;
    use super::*;
    use amberfield_core::{Boundary, Domain};

    #[test]
    fn corner_of_a_box_has_seven_images_with_the_walls_signs() {
        let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
        let faces = [[Boundary::Grounded; 2], [insulating; 2], [Boundary::Grounded; 2]];
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
        let mesh = FarMesh::new(FarMeshParts::of_box(&domain, [8; 3]).unwrap()).unwrap();
        let images = WallImages::new(&mesh, 0.4);
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
