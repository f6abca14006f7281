//! Models of cohesion.

use serde::{Deserialize, Serialize};

/// Model by which touching bodies stick to each other, of all contacts of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cohesion {
    /// Nothing sticks.
    #[default]
    None,
    /// Constant pull beside Hertz's force: small, hard grains.
    Dmt,
    /// Contact that grows and stretches: large, soft grains.
    Jkr,
}

impl Cohesion {
    /// All models.
    pub const ALL: [Self; 3] = [Self::None, Self::Dmt, Self::Jkr];

    /// The name used in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Dmt => "dmt",
            Self::Jkr => "jkr",
        }
    }
}
