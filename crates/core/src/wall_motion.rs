//! Motion of walls that grains touch.

use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Motion of a wall, or a part of it: those of a list act one after another, with origins, axes and
/// directions that stay where they are in space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WallMotion {
    /// Kind of motion.
    pub kind: MotionKind,
    /// Time at which it begins [s]; before that, it leaves the wall where it is.
    pub start_s: f64,
    /// Time at which it ends [s], after which the wall stays where it came to; infinite for none.
    pub end_s: f64,
}

/// Kind of a motion; times count from its begin.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum MotionKind {
    /// Rotation at a constant rate.
    Rotate {
        /// Point of the axis [m].
        origin: Vector3<f64>,
        /// Unit vector; the rotation is counter-clockwise about it.
        axis: Vector3<f64>,
        /// Turns in a second.
        turns_per_s: f64,
    },
    /// Translation at a constant velocity [m/s].
    Translate(Vector3<f64>),
    /// Vibration, A [sin(2πft + φ) − sin φ]: the wall begins where it stands.
    Vibrate {
        /// Amplitude A [m].
        amplitude: Vector3<f64>,
        /// Frequency f [Hz].
        frequency_hz: f64,
        /// Phase φ [rad].
        phase: f64,
    },
    /// Surface that slides along itself [m/s], as that of a belt, while the wall stays.
    Slide(Vector3<f64>),
    /// Poses over time, with a cubic between two rows.
    Table {
        /// Point about which rotation vectors turn [m].
        origin: Vector3<f64>,
        /// Rows with increasing times, at least two.
        rows: Vec<MotionRow>,
    },
    /// Plate that grains press against with a given force: it gives way where they press more, and follows
    /// where they press less.
    Servo {
        /// Force of the grains on the wall against the direction [N].
        force_n: f64,
        /// Unit vector along which the wall presses.
        direction: Vector3<f64>,
        /// Largest speed [m/s].
        most_m_s: f64,
    },
}

/// Pose of a wall at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionRow {
    /// Time [s].
    pub time_s: f64,
    /// Displacement [m].
    pub displacement: Vector3<f64>,
    /// Rotation vector: its direction is the axis, its length the angle [rad].
    pub rotation: Vector3<f64>,
}

/// Place of a moved wall: x is moved to `turn` x + `shift`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Rotation.
    pub turn: Matrix3<f64>,
    /// Displacement of the origin [m].
    pub shift: Vector3<f64>,
}

impl Placement {
    /// Place of a wall that has not moved.
    #[must_use]
    pub fn home() -> Self {
        Self { turn: Matrix3::identity(), shift: Vector3::zeros() }
    }

    /// Moved place of a point [m].
    #[must_use]
    pub fn place(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.turn * point + self.shift
    }

    /// Point of a wall that has not moved, of which a place [m] is the moved one.
    #[must_use]
    pub fn home_of(&self, place: &Vector3<f64>) -> Vector3<f64> {
        self.turn.tr_mul(&(place - self.shift))
    }
}
