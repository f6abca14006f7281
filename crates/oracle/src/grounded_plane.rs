//! Point charge over a grounded plane, with the mirror image −q.

use crate::point_charge::{coulomb_field, coulomb_potential};
use nalgebra::Vector3;

/// Charge q [C] at a height d [m] over the grounded plane z = 0; the field is that in z > 0.
///
/// The force is F = −k q²/(4d²), towards the plane, with k = 1/(4πε).
///
/// Source: Jackson, *Classical Electrodynamics*, 3rd ed., §2.1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundedPlane {
    /// Coulomb's constant k = 1/(4πε) [V·m/C].
    pub coulomb_constant: f64,
    /// Charge q [C].
    pub charge: f64,
    /// Height d of the charge over the plane [m].
    pub height: f64,
}

impl GroundedPlane {
    /// Field of the charge's own image at the charge, along z [V/m].
    #[must_use]
    pub fn self_field(&self) -> f64 {
        -self.coulomb_constant * self.charge / (4.0 * self.height * self.height)
    }

    /// Potential of the charge's own image at the charge [V].
    #[must_use]
    pub fn self_potential(&self) -> f64 {
        -self.coulomb_constant * self.charge / (2.0 * self.height)
    }

    /// Force on the charge along z [N]; never positive.
    #[must_use]
    pub fn force(&self) -> f64 {
        self.charge * self.self_field()
    }

    /// Field [V/m] at a point [m] with z > 0 that is not the charge itself; the charge sits over the origin.
    #[must_use]
    pub fn field(&self, point: Vector3<f64>) -> Vector3<f64> {
        let above = Vector3::z() * self.height;
        coulomb_field(self.coulomb_constant, self.charge, point - above)
            + coulomb_field(self.coulomb_constant, -self.charge, point + above)
    }

    /// Potential [V] at a point [m] with z > 0 that is not the charge itself.
    #[must_use]
    pub fn potential(&self, point: Vector3<f64>) -> f64 {
        let above = Vector3::z() * self.height;
        coulomb_potential(self.coulomb_constant, self.charge, point - above)
            + coulomb_potential(self.coulomb_constant, -self.charge, point + above)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::f_plane;

    /// Closed forms on both sides: rounding of a few operations.
    const ROUNDING: f64 = 1e-14;

    #[test]
    fn agrees_with_the_reference_table() {
        let rows = f_plane();
        assert!(!rows.is_empty());
        for row in rows {
            let plane = GroundedPlane { coulomb_constant: 1.0, charge: 1.0, height: row.height };
            assert!((plane.force() / row.force - 1.0).abs() < ROUNDING);
            assert!((plane.self_potential() / row.potential - 1.0).abs() < ROUNDING);
        }
    }

    #[test]
    fn plane_is_at_zero_potential_and_its_field_is_normal() {
        let plane = GroundedPlane { coulomb_constant: 2.0, charge: 3.0, height: 0.7 };
        let point = Vector3::new(0.4, -0.9, 0.0);
        assert!(plane.potential(point).abs() < ROUNDING);
        assert!(plane.field(point).xy().norm() < ROUNDING);
    }
}
