//! Charge before a plane wall: F = −q²/(16πεd²) for a grounded wall, F = +q²/(16πεd²) for an insulating one.
//!
//! The wall is replaced by an image charge at the mirror point: −q behind a grounded conductor (V = 0), +q
//! behind an ideal insulator (E·n = 0). F force on the charge along the normal that points from the wall to
//! the charge [N], so that a negative force pulls towards the wall; q charge [C]; d distance of the charge
//! from the wall [m], d > 0; ε permittivity [F/m].
//! Range: infinite plane.
//! Source: Jackson, *Classical Electrodynamics*, 3rd ed., §2.1.
//!
//! ```
//! use amberfield_core::Permittivity;
//! use amberfield_laws::image_in_plane::{PlaneWall, force_on_charge};
//! let f = force_on_charge(Permittivity::VACUUM.coulomb(), 1e-9, 0.01, PlaneWall::Grounded);
//! assert!((f + 2.2469e-5).abs() < 1e-9);
//! ```

use nalgebra::Vector3;

/// Boundary condition of the plane wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneWall {
    /// Grounded conductor: V = 0.
    Grounded,
    /// Ideal insulator: E·n = 0.
    Insulating,
}

impl PlaneWall {
    /// Ratio of the image charge to the charge: −1 or +1.
    #[must_use]
    pub fn image_factor(self) -> f64 {
        match self {
            Self::Grounded => -1.0,
            Self::Insulating => 1.0,
        }
    }
}

/// Mirror point [m] of `position` in the plane through `point` with the unit `normal`.
#[must_use]
pub fn mirror_point(position: Vector3<f64>, point: Vector3<f64>, normal: Vector3<f64>) -> Vector3<f64> {
    position - normal * (2.0 * (position - point).dot(&normal))
}

/// Normal field [V/m] of the image at the charge [C], for a distance d [m] and k = 1/(4πε) [V·m/C].
#[must_use]
pub fn field_at_charge(coulomb_constant: f64, charge: f64, distance: f64, wall: PlaneWall) -> f64 {
    wall.image_factor() * coulomb_constant * charge / (4.0 * distance * distance)
}

/// Normal force [N] on the charge [C], for a distance d [m] and k = 1/(4πε) [V·m/C]; a negative force pulls
/// towards the wall.
#[must_use]
pub fn force_on_charge(coulomb_constant: f64, charge: f64, distance: f64, wall: PlaneWall) -> f64 {
    charge * field_at_charge(coulomb_constant, charge, distance, wall)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Round-off of a handful of operations.
    const ROUND_OFF: f64 = 1e-14;
    /// Error of a central difference.
    const DIFFERENCE: f64 = 1e-8;

    #[test]
    fn exact_point() {
        assert!((force_on_charge(2.0, 3.0, 0.5, PlaneWall::Grounded) + 18.0).abs() < ROUND_OFF);
    }

    #[test]
    fn equals_the_image_charge() {
        let image = mirror_point(Vector3::new(1.0, 2.0, 0.3), Vector3::zeros(), Vector3::z());
        assert!((image - Vector3::new(1.0, 2.0, -0.3)).norm() < ROUND_OFF);
        let e = crate::point_charge::field(1.0, -1.0, Vector3::new(0.0, 0.0, 0.6)).z;
        assert!((field_at_charge(1.0, 1.0, 0.3, PlaneWall::Grounded) - e).abs() < ROUND_OFF);
    }

    #[test]
    fn force_is_minus_derivative_of_half_the_interaction_energy() {
        // W = −k q²/(4d): half of the energy of two real charges 2d apart.
        let energy = |d: f64| -1.0 / (4.0 * d);
        let (d, h) = (0.7, 1e-5);
        let slope = (energy(d + h) - energy(d - h)) / (2.0 * h);
        assert!((force_on_charge(1.0, 1.0, d, PlaneWall::Grounded) + slope).abs() < DIFFERENCE);
    }

    #[test]
    fn even_in_charge_and_opposite_for_an_insulator() {
        let f = force_on_charge(1.0, 2.0, 0.4, PlaneWall::Grounded);
        assert_eq!(f, force_on_charge(1.0, -2.0, 0.4, PlaneWall::Grounded));
        assert_eq!(f, -force_on_charge(1.0, 2.0, 0.4, PlaneWall::Insulating));
        assert!(force_on_charge(1.0, 2.0, 1e9, PlaneWall::Grounded).abs() < 1e-17);
    }
}
