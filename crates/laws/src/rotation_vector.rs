//! Rotation of a rotation vector r = θ a: R = 1 + sin θ K + (1 − cos θ) K², K the matrix of a×.
//!
//! a unit vector of the axis, θ angle [rad], counter-clockwise about a. A rotation vector that changes at the
//! rate ṙ turns the body at ω = ṙ + (1 − cos θ)/θ² r × ṙ + (θ − sin θ)/θ³ r × (r × ṙ) [rad/s].
//! Range: any r. Source: Rodrigues' formula; Goldstein, Poole & Safko, *Classical Mechanics*, 3rd ed., §4.7.
//!
//! ```
//! use amberfield_core::Vector3;
//! use amberfield_laws::rotation_vector::about;
//! // A quarter turn about z takes x to y.
//! assert_eq!(about(&Vector3::z(), 0.25) * Vector3::x(), Vector3::y());
//! ```

use amberfield_core::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// Angle below which a series stands for the quotients [rad].
const SMALL: f64 = 1e-4;

/// Rotation by a number of turns about a unit vector; whole turns leave everything where it is, exactly.
#[must_use]
pub fn about(axis: &Vector3<f64>, turns: f64) -> Matrix3<f64> {
    let part = turns - turns.floor();
    // Quarter turns are exact.
    let quarters = (4.0 * part).round();
    let (sine, cosine) = (TAU * (part - 0.25 * quarters)).sin_cos();
    let (sine, cosine) = match quarters as u32 % 4 {
        0 => (sine, cosine),
        1 => (cosine, -sine),
        2 => (-sine, -cosine),
        _ => (-cosine, sine),
    };
    by(axis, sine, cosine)
}

/// Rotation by a rotation vector [rad].
#[must_use]
pub fn matrix(rotation: &Vector3<f64>) -> Matrix3<f64> {
    let angle = rotation.norm();
    if angle == 0.0 {
        return Matrix3::identity();
    }
    by(&(rotation / angle), angle.sin(), angle.cos())
}

/// Rotation about a unit vector by the angle of a sine and a cosine.
fn by(axis: &Vector3<f64>, sine: f64, cosine: f64) -> Matrix3<f64> {
    let cross = axis.cross_matrix();
    Matrix3::identity() + cross * sine + cross * cross * (1.0 - cosine)
}

/// Angular velocity [rad/s] of a body whose rotation vector [rad] changes at a rate [rad/s].
#[must_use]
pub fn angular_velocity(rotation: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    let angle = rotation.norm();
    let (first, second) = if angle < SMALL {
        (0.5, 1.0 / 6.0)
    } else {
        ((1.0 - angle.cos()) / (angle * angle), (angle - angle.sin()) / angle.powi(3))
    };
    let across = rotation.cross(rate);
    rate + across * first + rotation.cross(&across) * second
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a few operations on numbers of order one.
    const ROUND_OFF: f64 = 1e-14;

    #[test]
    fn whole_turns_and_quarters_are_exact() {
        let axis = Vector3::new(0.36, 0.48, 0.8);
        assert_eq!(about(&axis, 3.0), Matrix3::identity());
        assert_eq!(about(&Vector3::z(), 0.5) * Vector3::x(), -Vector3::x());
        assert_eq!(about(&Vector3::z(), -0.25) * Vector3::x(), -Vector3::y());
    }

    #[test]
    fn both_ways_to_write_a_rotation_agree_and_keep_lengths() {
        let axis = Vector3::new(0.36, 0.48, 0.8);
        for turns in [0.01, 0.3, 0.77, 1.4] {
            let (one, other) = (about(&axis, turns), matrix(&(axis * (TAU * turns))));
            assert!((one - other).norm() < 10.0 * ROUND_OFF, "{turns}");
            assert!((one * one.transpose() - Matrix3::identity()).norm() < ROUND_OFF, "{turns}");
        }
    }

    #[test]
    fn angular_velocity_is_the_derivative() {
        let (rotation, rate) = (Vector3::new(0.4, -1.1, 0.7), Vector3::new(0.2, 0.5, -0.3));
        for scale in [1.0, 1e-5] {
            let (rotation, h) = (rotation * scale, 1e-5);
            let slope = (matrix(&(rotation + rate * h)) - matrix(&(rotation - rate * h))) / (2.0 * h);
            let spin = angular_velocity(&rotation, &rate).cross_matrix() * matrix(&rotation);
            assert!((slope - spin).norm() < 1e-9, "{scale}");
        }
    }
}
