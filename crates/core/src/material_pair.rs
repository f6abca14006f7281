//! Values of a pair of materials, instead of those mixed from each.

use crate::MaterialId;
use serde::{Deserialize, Serialize};

/// Values of a pair of materials; what is absent is mixed from the two materials.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MaterialPair {
    /// The two materials, in any order; one twice for its contacts with itself.
    pub between: [MaterialId; 2],
    /// Coefficient of restitution e in (0, 1].
    pub restitution: Option<f64>,
    /// Coulomb friction coefficient μ.
    pub friction: Option<f64>,
    /// Rolling friction coefficient μ_r.
    pub rolling_friction: Option<f64>,
    /// Half of the work of adhesion [J/m²].
    pub surface_energy_j_m2: Option<f64>,
}

impl MaterialPair {
    /// Whether it is of materials `a` and `b`, in any order.
    #[must_use]
    pub fn is_between(&self, a: MaterialId, b: MaterialId) -> bool {
        self.between == [a, b] || self.between == [b, a]
    }
}
