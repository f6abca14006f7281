//! Settings of the motion in time.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Time step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Step {
    /// A stated fraction of the tightest stability guard at the start.
    Auto,
    /// Fixed [s].
    Seconds(f64),
}

/// Neighbour-list skin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Skin {
    /// A fixed rule of the grains' sizes, never timed.
    Auto,
    /// Fixed [m].
    Metres(f64),
}

/// Fate of a grain that leaves through a face that is not periodic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OnExit {
    /// The run stops.
    #[default]
    Stop,
    /// The grain is removed and booked.
    Delete,
}

/// Settings of a scene's motion in time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TimeSettings {
    /// Time step.
    pub step: Step,
    /// End of the run [s].
    pub end_s: f64,
    /// Gravity [m/s²].
    pub gravity_m_s2: Vector3<f64>,
    /// Neighbour-list skin.
    pub skin: Skin,
    /// Whether a step beyond a stability guard is a warning instead of an error.
    pub allow_unstable: bool,
    /// Fate of grains that leave.
    pub on_exit: OnExit,
    /// Whether overlaps above half the smaller radius are accepted at the start.
    pub allow_overlap: bool,
}
