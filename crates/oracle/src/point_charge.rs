//! Point charges in free space, summed directly.

use nalgebra::Vector3;

/// Field E = k q r/|r|³ [V/m] at an offset r [m] from a charge [C]; `coulomb_constant` k = 1/(4πε) [V·m/C].
#[must_use]
pub fn coulomb_field(coulomb_constant: f64, charge: f64, offset: Vector3<f64>) -> Vector3<f64> {
    let distance = offset.norm();
    offset * (coulomb_constant * charge / (distance * distance * distance))
}

/// Potential V = k q/|r| [V] at an offset r [m] from a charge [C]; `coulomb_constant` k = 1/(4πε) [V·m/C].
#[must_use]
pub fn coulomb_potential(coulomb_constant: f64, charge: f64, offset: Vector3<f64>) -> f64 {
    coulomb_constant * charge / offset.norm()
}

/// Exact field and potential at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExactField {
    /// Field E [V/m].
    pub e: Vector3<f64>,
    /// Potential [V].
    pub potential: f64,
}

/// Field and potential of point charges in free space at the charge `at`, without its own.
///
/// Positions are in [m], charges in [C]; `coulomb_constant` k = 1/(4πε) [V·m/C].
#[must_use]
pub fn open_sum(coulomb_constant: f64, positions: &[Vector3<f64>], charges: &[f64], at: usize) -> ExactField {
    let mut e = Vector3::zeros();
    let mut potential = 0.0;
    for (index, (position, &charge)) in positions.iter().zip(charges).enumerate() {
        if index != at {
            let offset = positions[at] - position;
            e += coulomb_field(coulomb_constant, charge, offset);
            potential += coulomb_potential(coulomb_constant, charge, offset);
        }
    }
    ExactField { e, potential }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_charges_push_each_other_apart_equally() {
        let positions = [Vector3::zeros(), Vector3::new(3.0, 0.0, 4.0)];
        let charges = [2.0, 5.0];
        let force_0 = open_sum(1.0, &positions, &charges, 0).e * charges[0];
        let force_1 = open_sum(1.0, &positions, &charges, 1).e * charges[1];
        assert_eq!(force_0, -force_1);
        assert!((force_1 - Vector3::new(0.6, 0.0, 0.8) * 0.4).norm() < 1e-15);
    }
}
