//! Grains of a checkpoint, with which other scenes may begin.

use amberfield_core::{ContactRules, Particles};
use serde::{Deserialize, Serialize};

/// Grains of a checkpoint, with the names that their numbers stand for: other scenes begin with them.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SavedGrains {
    /// Grains that were there, in the order of their scene.
    pub particles: Particles,
    /// Names of their groups; group 0 is `all`.
    pub groups: Vec<String>,
    /// Materials of the scene, and what else its contacts follow from.
    pub rules: ContactRules,
}
