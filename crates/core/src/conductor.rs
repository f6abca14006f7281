//! Conductors whose surfaces bound the electric field without a mesh around them.

use crate::triangle_mesh::TriangleMesh;
use serde::{Deserialize, Serialize};

/// Given state of a conductor: the other of the two follows from the field.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ConductorState {
    /// Potential [V].
    Potential(f64),
    /// Charge [C]; the conductor floats at the potential that this makes.
    Charge(f64),
}

/// A conductor that bounds the electric field.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conductor {
    /// Name for messages and outputs: that of its wall.
    pub name: String,
    /// Surface. Neither the orientation of its triangles nor their order matters; corners at one place are
    /// one vertex.
    pub surface: TriangleMesh,
    /// Potential or charge.
    pub state: ConductorState,
}
