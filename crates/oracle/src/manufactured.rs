//! Manufactured potentials that satisfy a box's boundary conditions, with the charge density that belongs to
//! them.

use amberfield_core::{Axis, Boundary, Domain};
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Eigenfunction of the box: V = A Π_a sin or cos(k_a (x_a − min_a)), with ρ = ε |k|² V.
///
/// Along an axis it is a sine with k = mπ/L between two conductors, a cosine with k = mπ/L between two
/// insulating faces, a sine or cosine with half-integer m between one of each, and a cosine with k = 2πm/L
/// where the axis is periodic. All face values are zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Manufactured {
    /// Amplitude A [V].
    amplitude: f64,
    /// Wave numbers k [1/m].
    wave_number: Vector3<f64>,
    /// Flag of a sine, per axis; the other axes have a cosine.
    sine: [bool; 3],
    /// Lower corner of the box [m].
    min: Vector3<f64>,
}

impl Manufactured {
    /// Eigenfunction with the given mode numbers and amplitude A [V].
    ///
    /// Face values (potentials, normal fields) are taken as zero. `None` when a face is open or the mode
    /// number of a sine is 0.
    #[must_use]
    pub fn new(domain: &Domain, modes: [u32; 3], amplitude: f64) -> Option<Self> {
        let mut wave_number = Vector3::zeros();
        let mut sine = [false; 3];
        for axis in Axis::ALL {
            let index = axis.index();
            let mode = f64::from(modes[index]);
            let [lower, upper] = domain.faces()[index];
            let half_waves = match (lower, upper) {
                (Boundary::Periodic, Boundary::Periodic) => 2.0 * mode,
                (Boundary::Open, _) | (_, Boundary::Open) => return None,
                (lower, upper) if lower.is_conductor() == upper.is_conductor() => mode,
                _ => mode + 0.5,
            };
            sine[index] = lower.is_conductor();
            if sine[index] && half_waves == 0.0 {
                return None;
            }
            wave_number[index] = PI * half_waves / domain.extent()[index];
        }
        Some(Self { amplitude, wave_number, sine, min: domain.min() })
    }

    /// Factor of one axis in the product.
    fn factor(&self, axis: usize, point: &Vector3<f64>) -> f64 {
        let phase = self.wave_number[axis] * (point[axis] - self.min[axis]);
        if self.sine[axis] { phase.sin() } else { phase.cos() }
    }

    /// Derivative [1/m] of one axis' factor.
    fn slope(&self, axis: usize, point: &Vector3<f64>) -> f64 {
        let phase = self.wave_number[axis] * (point[axis] - self.min[axis]);
        self.wave_number[axis] * if self.sine[axis] { phase.cos() } else { -phase.sin() }
    }

    /// Potential [V] at a point [m].
    #[must_use]
    pub fn potential(&self, point: Vector3<f64>) -> f64 {
        self.amplitude * (0..3).map(|axis| self.factor(axis, &point)).product::<f64>()
    }

    /// Field E = −∇V [V/m] at a point [m].
    #[must_use]
    pub fn field(&self, point: Vector3<f64>) -> Vector3<f64> {
        Vector3::from_fn(|along, _| {
            let factors = (0..3)
                .map(|axis| if axis == along { self.slope(axis, &point) } else { self.factor(axis, &point) });
            -self.amplitude * factors.product::<f64>()
        })
    }

    /// Charge density ρ = ε |k|² V [C/m³] at a point [m] in a medium of permittivity ε [F/m].
    #[must_use]
    pub fn charge_density(&self, point: Vector3<f64>, permittivity: f64) -> f64 {
        permittivity * self.wave_number.norm_squared() * self.potential(point)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const INSULATING: Boundary = Boundary::Insulating { normal_field_v_m: 0.0 };

    fn mixed() -> Domain {
        let faces = [[Boundary::Grounded, INSULATING], [Boundary::Periodic; 2], [INSULATING; 2]];
        Domain::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(2.0, 4.0, 4.5), faces).unwrap()
    }

    #[test]
    fn boundary_conditions_hold() {
        let solution = Manufactured::new(&mixed(), [1, 2, 3], 7.0).unwrap();
        // Rounding of sines at a few multiples of pi.
        let zero = 1e-12;
        assert!(solution.potential(Vector3::new(1.0, 2.3, 3.2)).abs() < zero);
        assert!(solution.field(Vector3::new(2.0, 2.3, 3.2)).x.abs() < zero);
        assert!(solution.field(Vector3::new(1.4, 2.3, 3.0)).z.abs() < zero);
        assert!(solution.field(Vector3::new(1.4, 2.3, 4.5)).z.abs() < zero);
        let (a, b) = (Vector3::new(1.4, 2.0, 3.2), Vector3::new(1.4, 4.0, 3.2));
        assert!((solution.field(a) - solution.field(b)).norm() < 1e-11);
    }

    #[test]
    fn divergence_of_the_field_is_the_charge_density() {
        let solution = Manufactured::new(&mixed(), [0, 1, 2], 1.0).unwrap();
        let (point, step) = (Vector3::new(1.3, 2.9, 3.7), 1e-4);
        let divergence: f64 = (0..3)
            .map(|axis| {
                let mut shift = Vector3::zeros();
                shift[axis] = step;
                (solution.field(point + shift) - solution.field(point - shift))[axis] / (2.0 * step)
            })
            .sum();
        // Central differences at step 1e-4 of waves with |k|⁴ near 700.
        assert!((divergence - solution.charge_density(point, 1.0)).abs() < 1e-5);
    }

    #[test]
    fn open_faces_and_empty_sines_have_no_solution() {
        let open = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3]).unwrap();
        assert_eq!(Manufactured::new(&open, [1, 1, 1], 1.0), None);
        let grounded =
            Domain::new(Vector3::zeros(), Vector3::repeat(1.0), [[Boundary::Grounded; 2]; 3]).unwrap();
        assert_eq!(Manufactured::new(&grounded, [1, 0, 1], 1.0), None);
    }
}
