//! Walls that grains touch.

use crate::material::MaterialId;
use crate::triangle_mesh::TriangleMesh;
use crate::wall_motion::{Placement, WallMotion};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Geometry of a wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WallShape {
    /// Infinite plane; grains live on the side that the normal points to.
    Plane {
        /// A point of the plane [m].
        point: Vector3<f64>,
        /// Unit normal, into the grains' side.
        normal: Vector3<f64>,
    },
    /// Triangles; both sides are solid to grains.
    Mesh(TriangleMesh),
}

impl WallShape {
    /// Shape after a motion.
    #[must_use]
    pub fn moved(&self, to: &Placement) -> Self {
        match self {
            Self::Plane { point, normal } => Self::Plane { point: to.place(point), normal: to.turn * normal },
            Self::Mesh(mesh) => Self::Mesh(TriangleMesh {
                vertices: mesh.vertices.iter().map(|vertex| to.place(vertex)).collect(),
                triangles: mesh.triangles.clone(),
            }),
        }
    }
}

/// Treatment of charge by a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum WallCharging {
    /// Conductor at V = 0: takes any charge, keeps none.
    Grounded,
    /// Keeps what it gets.
    Insulating,
    /// Takes no charge.
    #[default]
    None,
}

/// A wall of the scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wall {
    /// Name for messages: the name of the STL file or of the mesh's patch, or `walls[k]`.
    pub name: String,
    /// Geometry.
    pub shape: WallShape,
    /// Material.
    pub material: MaterialId,
    /// Treatment of charge.
    pub charging: WallCharging,
    /// Whether it is a boundary of the electric field too, with its mirror charges: a patch of a field
    /// solver's mesh, or one of the field's conductors. Faces of the domain are known by their place.
    pub bounds_field: bool,
    /// Motions, one after another; empty for a wall at rest.
    pub motion: Vec<WallMotion>,
}
