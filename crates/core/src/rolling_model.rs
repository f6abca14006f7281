//! Models of rolling friction.

use serde::{Deserialize, Serialize};

/// Model of rolling friction of all contacts of a scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum RollingModel {
    /// Spring with a dashpot that acts below the spring's limit.
    #[default]
    Epsd,
    /// Spring without a dashpot, as stiff as the tangential one.
    Epsd2,
    /// Constant torque against the motion.
    Cdt,
}

impl RollingModel {
    /// All models.
    pub const ALL: [Self; 3] = [Self::Epsd, Self::Epsd2, Self::Cdt];

    /// The name used in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Epsd => "epsd",
            Self::Epsd2 => "epsd2",
            Self::Cdt => "cdt",
        }
    }
}
