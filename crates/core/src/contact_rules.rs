//! Rules of the contacts of a scene, as a checkpoint keeps them for other scenes.

use crate::{Cohesion, Fingerprint, Material, MaterialId, MaterialPair, RollingModel, Wall, WallShape};
use serde::{Deserialize, Serialize};

/// Rules of the contacts of a scene: what grains and walls are made of, and where walls are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactRules {
    /// Materials.
    pub materials: Vec<Material>,
    /// Values of pairs of materials.
    pub pairs: Vec<MaterialPair>,
    /// Model of rolling friction.
    pub rolling_model: RollingModel,
    /// Model of cohesion.
    pub cohesion: Cohesion,
    /// Walls, in the order of the scene.
    pub walls: Vec<WallRule>,
}

/// Wall as far as it matters whether it is one of another scene too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct WallRule {
    /// Fingerprint of the shape.
    pub shape: u64,
    /// Material.
    pub material: MaterialId,
    /// Whether the wall never moves.
    pub is_at_rest: bool,
}

impl WallRule {
    /// Rule of a wall.
    #[must_use]
    pub fn of(wall: &Wall) -> Self {
        Self { shape: fingerprint(&wall.shape), material: wall.material, is_at_rest: wall.motion.is_empty() }
    }
}

/// Fingerprint of a shape, by the bits of its numbers.
fn fingerprint(shape: &WallShape) -> u64 {
    let mut print = Fingerprint::new();
    let mut add = |x: f64| print.add(&x.to_bits().to_le_bytes());
    match shape {
        WallShape::Plane { point, normal } => point.iter().chain(normal).copied().for_each(add),
        WallShape::Mesh(mesh) => {
            mesh.vertices.iter().flatten().copied().for_each(&mut add);
            mesh.triangles.iter().flatten().for_each(|vertex| add(f64::from(*vertex)));
        }
    }
    print.value()
}
