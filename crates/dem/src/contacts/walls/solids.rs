//! Solids made of the walls of a scene.

use super::mesh::MeshWall;
use super::{Part, Shape, Solid};
use amberfield_core::{TriangleMesh, Vector3, Wall, WallShape};

/// Checks walls and makes solids of them: one for each plane, and one of all surfaces of triangles, in the
/// place of the first of them.
///
/// # Errors
/// The first wall that has no shape.
pub(super) fn solids_of(walls: &[Wall]) -> Result<Vec<Solid>, String> {
    let mut solids = Vec::new();
    let mut surfaces: Vec<&TriangleMesh> = Vec::new();
    let (mut parts, mut place) = (Vec::new(), 0);
    for (number, wall) in walls.iter().enumerate() {
        let part = Part {
            wall: number as u32,
            name: wall.name.clone(),
            material: wall.material.0,
            charging: wall.charging,
            bounds_field: wall.bounds_field,
        };
        match &wall.shape {
            WallShape::Plane { point, normal } => {
                let shape = plane(&wall.name, point, normal)?;
                solids.push(Solid { shape, parts: vec![part] });
            }
            WallShape::Mesh(mesh) => {
                check(&wall.name, mesh)?;
                if surfaces.is_empty() {
                    place = solids.len();
                }
                surfaces.push(mesh);
                parts.push(part);
            }
        }
    }
    if !surfaces.is_empty() {
        let mesh = MeshWall::new(surfaces);
        if let Some(empty) = mesh.empty_surface() {
            let name = &parts[empty].name;
            return Err(format!("wall '{name}' has no triangle with an area; check its file and scale"));
        }
        solids.insert(place, Solid { shape: Shape::Mesh(Box::new(mesh)), parts });
    }
    Ok(solids)
}

/// Shape of a plane.
fn plane(name: &str, point: &Vector3<f64>, normal: &Vector3<f64>) -> Result<Shape, String> {
    let size = normal.norm();
    let good = point.iter().all(|x| x.is_finite()) && size.is_finite() && size > 0.0;
    if !good {
        return Err(format!("wall '{name}' needs a finite point and a normal that is not zero"));
    }
    Ok(Shape::Plane { point: *point, normal: normal / size })
}

/// Refuses a surface whose vertices are not there or nowhere.
fn check(name: &str, mesh: &TriangleMesh) -> Result<(), String> {
    let known = mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.vertices.len());
    let finite = mesh.vertices.iter().all(|v| v.iter().all(|x| x.is_finite()));
    if known && finite {
        return Ok(());
    }
    Err(format!("wall '{name}' has a triangle with an unknown vertex or a vertex that is not finite"))
}
