//! The box, conducting faces as plates, and walls.

use super::PictureScene;
use super::camera::{Camera, corners};
use super::depth_image::{Corner, DepthImage};
use crate::colour::Colour;
use amberfield_core::{Axis, Domain, Side, Vector3, WallShape};

const EDGE: Colour = [120, 126, 138];
const PLATE: Colour = [186, 192, 202];
const WALL: Colour = [150, 156, 168];
/// Share of the light that a plate or wall in front hides.
const VEIL: f64 = 0.16;
/// Width of the box's edges [px].
const EDGE_WIDTH: f64 = 1.6;

/// A face of the box: its corners in order around it, its outward normal, whether it is solid.
struct Face {
    corners: [Vector3<f64>; 4],
    normal: Vector3<f64>,
    solid: bool,
}

/// Faces that show their inside, and so lie behind the grains.
pub(super) fn behind(image: &mut DepthImage, camera: &Camera, scene: &PictureScene<'_>) {
    for face in faces(scene).iter().filter(|face| face.solid && !camera.sees_outside(&face.normal)) {
        fill(image, camera, &face.corners, shade(camera, &-face.normal), 1.0);
    }
}

/// The box's edges, walls inside it, and solid faces between the grains and the viewer as a veil.
pub(super) fn in_front(image: &mut DepthImage, camera: &Camera, scene: &PictureScene<'_>) {
    for wall in scene.walls {
        match &wall.shape {
            WallShape::Plane { point, normal } => {
                if !on_face(scene.domain, point, normal) {
                    let polygon = scene.domain.section(point, normal);
                    fill(image, camera, &polygon, WALL, VEIL);
                    outline(image, camera, &polygon);
                }
            }
            WallShape::Mesh(mesh) => {
                for triangle in &mesh.triangles {
                    let corners = triangle.map(|vertex| mesh.vertices[vertex as usize]);
                    fill(image, camera, &corners, WALL, VEIL);
                }
            }
        }
    }
    for face in faces(scene) {
        outline(image, camera, &face.corners);
        if face.solid && camera.sees_outside(&face.normal) {
            fill(image, camera, &face.corners, shade(camera, &face.normal), VEIL);
        }
    }
}

fn shade(camera: &Camera, normal: &Vector3<f64>) -> Colour {
    let light = 0.86 + 0.16 * camera.light_on(normal);
    PLATE.map(|value| (f64::from(value) * light).clamp(0.0, 255.0) as u8)
}

fn faces(scene: &PictureScene<'_>) -> Vec<Face> {
    let domain = scene.domain;
    let all = corners(&domain.min(), &domain.max());
    let mut faces = Vec::with_capacity(6);
    for axis in Axis::ALL {
        for side in [Side::Min, Side::Max] {
            let [second, third] = [(axis.index() + 1) % 3, (axis.index() + 2) % 3].map(|other| 1 << other);
            let first = (side as usize) << axis.index();
            let mut normal = Vector3::zeros();
            normal[axis.index()] = if side == Side::Max { 1.0 } else { -1.0 };
            let centre = domain.centre() + normal.component_mul(&(domain.extent() * 0.5));
            let touched = scene.walls.iter().any(|wall| match &wall.shape {
                WallShape::Plane { point, normal: inwards } => {
                    inwards.dot(&normal) < -1.0 + 1e-9
                        && (point - centre).dot(&normal).abs() < tolerance(domain)
                }
                WallShape::Mesh(_) => false,
            });
            faces.push(Face {
                corners: [first, first | second, first | second | third, first | third]
                    .map(|number| all[number]),
                normal,
                solid: touched || domain.face(axis, side).is_conductor(),
            });
        }
    }
    faces
}

fn tolerance(domain: &Domain) -> f64 {
    1e-6 * domain.extent().norm()
}

/// Whether a plane is one of the box's faces or does not enter the box.
fn on_face(domain: &Domain, point: &Vector3<f64>, normal: &Vector3<f64>) -> bool {
    corners(&domain.min(), &domain.max())
        .iter()
        .all(|corner| (corner - point).dot(normal) > -tolerance(domain))
}

fn fill(image: &mut DepthImage, camera: &Camera, polygon: &[Vector3<f64>], colour: Colour, weight: f64) {
    let projected: Vec<Corner> = polygon.iter().map(|corner| camera.project(corner)).collect();
    for index in 2..projected.len() {
        image.triangle([projected[0], projected[index - 1], projected[index]], colour, weight);
    }
}

fn outline(image: &mut DepthImage, camera: &Camera, polygon: &[Vector3<f64>]) {
    for index in 0..polygon.len() {
        let ends = [index, (index + 1) % polygon.len()].map(|end| camera.project(&polygon[end]));
        image.segment(ends[0], ends[1], EDGE_WIDTH, EDGE, 0.55);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;

    #[test]
    fn slanted_plane_cuts_a_cube_in_a_hexagon() {
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3]).unwrap();
        let normal = Vector3::repeat(1.0).normalize();
        assert_eq!(domain.section(&Vector3::repeat(0.5), &normal).len(), 6);
        assert!(on_face(&domain, &Vector3::zeros(), &Vector3::z()));
        assert!(!on_face(&domain, &Vector3::repeat(0.5), &normal));
    }
}
