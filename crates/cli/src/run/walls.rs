//! Walls of a run where they are: those that move have a place over time.

#[cfg(feature = "plots")]
use amberfield_core::Wall;
use amberfield_core::WallShape;
use amberfield_dem::Simulation;
use amberfield_scene::{Scene, WallFace};

/// Walls of a scene where they are now.
#[cfg(feature = "plots")]
pub(crate) fn now(scene: &Scene, simulation: &Simulation) -> Vec<Wall> {
    let mut walls = scene.walls.clone();
    for (number, placement) in simulation.wall_placements() {
        let wall = &mut walls[number as usize];
        wall.shape = wall.shape.moved(&placement);
    }
    walls
}

/// Faces of the walls that move, where they are now.
pub(crate) fn faces(scene: &Scene, simulation: &Simulation) -> Vec<WallFace> {
    let mut faces = Vec::new();
    for (wall, placement) in simulation.wall_placements() {
        match scene.walls[wall as usize].shape.moved(&placement) {
            WallShape::Plane { point, normal } => {
                let corners = scene.domain.as_ref().map(|domain| domain.section(&point, &normal));
                let corners = corners.unwrap_or_default();
                faces.extend((corners.len() > 2).then_some(WallFace { wall, corners }));
            }
            WallShape::Mesh(mesh) => faces.extend(mesh.triangles.iter().map(|triangle| {
                let corners = triangle.iter().map(|vertex| mesh.vertices[*vertex as usize]).collect();
                WallFace { wall, corners }
            })),
        }
    }
    faces
}
