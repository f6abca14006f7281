//! Ball of uniform charge density in free space.

use nalgebra::Vector3;
use std::f64::consts::PI;

/// Uniformly charged ball in free space, centred at the origin: E = k Q r/R³ inside, k Q r/|r|³ outside.
///
/// Source: Griffiths, *Introduction to Electrodynamics*, 4th ed., problem 2.12.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChargedBall {
    /// Coulomb's constant k = 1/(4πε) [V·m/C].
    pub coulomb_constant: f64,
    /// Total charge Q [C].
    pub charge: f64,
    /// Radius R [m].
    pub radius: f64,
}

impl ChargedBall {
    /// Field [V/m] at a point [m].
    #[must_use]
    pub fn field(&self, point: Vector3<f64>) -> Vector3<f64> {
        let distance = point.norm().max(self.radius);
        point * (self.coulomb_constant * self.charge / distance.powi(3))
    }

    /// Potential [V] at a point [m], zero at infinity.
    #[must_use]
    pub fn potential(&self, point: Vector3<f64>) -> f64 {
        let distance = point.norm();
        let scale = self.coulomb_constant * self.charge;
        if distance >= self.radius {
            scale / distance
        } else {
            scale * (3.0 - (distance / self.radius).powi(2)) / (2.0 * self.radius)
        }
    }

    /// Electrostatic energy (3/5) k Q²/R [J] of the continuous ball.
    #[must_use]
    pub fn energy(&self) -> f64 {
        0.6 * self.coulomb_constant * self.charge * self.charge / self.radius
    }
}

/// Points spread evenly through a ball [m]: concentric shells of equal thickness, golden spirals on each.
///
/// Each point stands for the same volume, so that equal charges on them make a discrete, uniformly charged
/// ball. There are `count` points in a ball of the given radius [m] around the origin, ordered from the
/// centre outwards.
#[must_use]
pub fn ball_points(count: usize, radius: f64) -> Vec<Vector3<f64>> {
    // Shell s of n covers s³/n³ to (s + 1)³/n³ of the volume. With this n a shell is as thick as the points
    // are apart.
    let shells = ((count as f64 * 3.0 / (4.0 * PI)).cbrt().round() as usize).max(1);
    let golden_angle = PI * (3.0 - 5.0_f64.sqrt());
    let mut points = Vec::with_capacity(count);
    for shell in 0..shells {
        let outer = ((shell + 1) as f64 / shells as f64).powi(3);
        let end = (outer * count as f64).round() as usize;
        let in_shell = end - points.len();
        let volume_radius = |volume: f64| (volume / count as f64).cbrt() * radius;
        // The points lie on the sphere that halves the shell's volume.
        let shell_radius = volume_radius(points.len() as f64 + 0.5 * in_shell as f64);
        for index in 0..in_shell {
            let height = 1.0 - (2.0 * index as f64 + 1.0) / in_shell as f64;
            let (sine, cosine) = (golden_angle * index as f64 + shell as f64).sin_cos();
            let ring = (1.0 - height * height).sqrt();
            points.push(Vector3::new(ring * cosine, ring * sine, height) * shell_radius);
        }
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::point_charge::{coulomb_field, coulomb_potential};

    const BALL: ChargedBall = ChargedBall { coulomb_constant: 2.0, charge: 3.0, radius: 0.5 };
    /// Error of central differences at step 1e-5 of a quadratic or of 1/r near 1.
    const DIFFERENCES: f64 = 1e-6;

    #[test]
    fn field_is_minus_the_gradient_of_the_potential() {
        let step = 1e-5;
        for point in [Vector3::new(0.1, -0.2, 0.15), Vector3::new(0.7, 0.2, -0.4)] {
            for axis in 0..3 {
                let mut shift = Vector3::zeros();
                shift[axis] = step;
                let slope = (BALL.potential(point + shift) - BALL.potential(point - shift)) / (2.0 * step);
                assert!((slope + BALL.field(point)[axis]).abs() < DIFFERENCES);
            }
        }
    }

    #[test]
    fn discrete_ball_looks_like_a_point_from_outside() {
        let points = ball_points(4000, 0.5);
        assert_eq!(points.len(), 4000);
        let share = BALL.charge / 4000.0;
        let outside = Vector3::new(0.9, 0.3, -0.5);
        let field: Vector3<f64> =
            points.iter().map(|point| coulomb_field(BALL.coulomb_constant, share, outside - point)).sum();
        // Shells without a dipole: what is left is the spirals' unevenness.
        assert!((field - BALL.field(outside)).norm() < 1e-4 * BALL.field(outside).norm());
    }

    #[test]
    fn discrete_ball_has_the_potential_of_the_continuous_one_at_the_centre() {
        let points = ball_points(4000, 0.5);
        let share = BALL.charge / 4000.0;
        let potential: f64 =
            points.iter().map(|point| coulomb_potential(BALL.coulomb_constant, share, *point)).sum();
        // Ten shells: the midpoint rule in the radius errs by some (1/10)².
        assert!((potential / BALL.potential(Vector3::zeros()) - 1.0).abs() < 1e-2);
    }
}
