//! Point charge and a grounded sphere, by Kelvin's image.

use crate::point_charge::{coulomb_field, coulomb_potential};
use nalgebra::Vector3;

/// Charge q [C] at distance s [m] from the centre of a grounded sphere of radius R [m], inside (a cavity) or
/// outside; the sphere's centre is the origin and the charge lies on the z axis.
///
/// The image is −qR/s at R²/s.
///
/// Source: Jackson, *Classical Electrodynamics*, 3rd ed., §2.2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundedSphere {
    /// Coulomb's constant k = 1/(4πε) [V·m/C].
    pub coulomb_constant: f64,
    /// Charge q [C].
    pub charge: f64,
    /// Distance s of the charge from the centre [m], above 0 and not R.
    pub distance: f64,
    /// Radius R [m].
    pub radius: f64,
}

/// Image charge of a sphere.
struct Image {
    /// Charge [C].
    charge: f64,
    /// Place [m].
    place: Vector3<f64>,
}

impl GroundedSphere {
    fn image(&self) -> Image {
        let ratio = self.radius / self.distance;
        Image { charge: -self.charge * ratio, place: Vector3::z() * (self.radius * ratio) }
    }

    fn place(&self) -> Vector3<f64> {
        Vector3::z() * self.distance
    }

    /// Field of the charge's own image at the charge, along z (outwards) [V/m].
    #[must_use]
    pub fn self_field(&self) -> f64 {
        let image = self.image();
        coulomb_field(self.coulomb_constant, image.charge, self.place() - image.place).z
    }

    /// Potential of the charge's own image at the charge [V].
    #[must_use]
    pub fn self_potential(&self) -> f64 {
        let image = self.image();
        coulomb_potential(self.coulomb_constant, image.charge, self.place() - image.place)
    }

    /// Force on the charge along z (outwards) [N].
    #[must_use]
    pub fn force(&self) -> f64 {
        self.charge * self.self_field()
    }

    /// Force [N] when the sphere is isolated and without net charge, the charge outside: a second image +qR/s
    /// lies at the centre.
    #[must_use]
    pub fn force_isolated(&self) -> f64 {
        let centre = self.charge * self.radius / self.distance;
        self.force() + self.charge * coulomb_field(self.coulomb_constant, centre, self.place()).z
    }

    /// Field [V/m] at a point [m] on the charge's side of the sphere that is not the charge itself.
    #[must_use]
    pub fn field(&self, point: Vector3<f64>) -> Vector3<f64> {
        let image = self.image();
        coulomb_field(self.coulomb_constant, self.charge, point - self.place())
            + coulomb_field(self.coulomb_constant, image.charge, point - image.place)
    }

    /// Potential [V] at a point [m] on the charge's side of the sphere that is not the charge itself.
    #[must_use]
    pub fn potential(&self, point: Vector3<f64>) -> f64 {
        let image = self.image();
        coulomb_potential(self.coulomb_constant, self.charge, point - self.place())
            + coulomb_potential(self.coulomb_constant, image.charge, point - image.place)
    }
}

/// Field E [V/m] at each charge [C] in a grounded spherical cavity of a radius [m] around the origin.
///
/// The field is that of all other charges and of all Kelvin images, the charge's own included. Positions are
/// in [m]; none is at the centre.
#[must_use]
pub fn grounded_cavity(
    coulomb_constant: f64,
    radius: f64,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Vec<Vector3<f64>> {
    let field = |at: usize| {
        let mut e = Vector3::zeros();
        for (from, (place, &charge)) in positions.iter().zip(charges).enumerate() {
            let ratio = radius / place.norm();
            let image = place * (ratio * ratio);
            e += coulomb_field(coulomb_constant, -charge * ratio, positions[at] - image);
            if from != at {
                e += coulomb_field(coulomb_constant, charge, positions[at] - place);
            }
        }
        e
    };
    (0..positions.len()).map(field).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::f_sphere;

    /// The gap s − 1 is as small as 5e-3 and enters squared: rounding grows to some 1e-13.
    const ROUNDING: f64 = 1e-11;

    #[test]
    fn agrees_with_the_reference_table() {
        let rows = f_sphere();
        assert!(!rows.is_empty());
        for row in rows {
            let sphere =
                GroundedSphere { coulomb_constant: 1.0, charge: 1.0, distance: row.distance, radius: 1.0 };
            assert!((sphere.force() / row.force_grounded - 1.0).abs() < ROUNDING);
            assert!((sphere.force_isolated() / row.force_isolated - 1.0).abs() < ROUNDING);
            assert!((sphere.self_potential() / row.potential_grounded - 1.0).abs() < ROUNDING);
        }
    }

    #[test]
    fn sphere_is_at_zero_potential_from_either_side() {
        for distance in [0.3, 2.5] {
            let sphere = GroundedSphere { coulomb_constant: 1.0, charge: 1.0, distance, radius: 1.0 };
            let point = Vector3::new(0.6, 0.0, 0.8);
            assert!(sphere.potential(point).abs() < ROUNDING);
            assert!(sphere.field(point).cross(&point).norm() < ROUNDING, "the field is normal to the sphere");
        }
    }
}
