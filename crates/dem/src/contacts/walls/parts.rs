//! Surfaces made of the walls of a scene, and the wall that each is a part of.

use super::surfaces::{Plane, Surfaces};
use amberfield_core::{TriangleMesh, Vector3, Wall, WallCharging, WallShape};

/// A wall of the scene.
#[derive(Debug)]
pub(super) struct Part {
    /// Number of the wall in the scene.
    pub(super) wall: u32,
    pub(super) name: String,
    pub(super) material: u16,
    pub(super) charging: WallCharging,
    pub(super) bounds_field: bool,
}

/// Checks walls, and makes one body of them: surfaces of triangles first, then planes, with the wall of each.
///
/// # Errors
/// The first wall that has no shape.
pub(super) fn surfaces_of(walls: &[Wall]) -> Result<(Surfaces, Vec<Part>), String> {
    let (mut meshes, mut planes) = (Vec::new(), Vec::new());
    let (mut parts, mut parts_of_planes) = (Vec::new(), Vec::new());
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
                planes.push(plane(&wall.name, point, normal)?);
                parts_of_planes.push(part);
            }
            WallShape::Mesh(mesh) => {
                check(&wall.name, mesh)?;
                meshes.push(mesh);
                parts.push(part);
            }
        }
    }
    let surfaces = Surfaces::new(meshes, planes);
    if let Some(empty) = surfaces.empty_surface() {
        let name = &parts[empty].name;
        return Err(format!("wall '{name}' has no triangle with an area; check its file and scale"));
    }
    parts.append(&mut parts_of_planes);
    Ok((surfaces, parts))
}

/// Plane with a unit normal.
fn plane(name: &str, point: &Vector3<f64>, normal: &Vector3<f64>) -> Result<Plane, String> {
    let size = normal.norm();
    let good = point.iter().all(|x| x.is_finite()) && size.is_finite() && size > 0.0;
    if !good {
        return Err(format!("wall '{name}' needs a finite point and a normal that is not zero"));
    }
    Ok(Plane { point: *point, normal: normal / size })
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
