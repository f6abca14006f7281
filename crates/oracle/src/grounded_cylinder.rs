//! Point charges in a closed grounded cylinder: a Fourier–Bessel series.

use crate::point_charge::coulomb_field;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Terms along the axis and around it are summed up to exponents of this size.
const EXPONENT: f64 = 14.0;
/// Images in the two ends to either side.
const ENDS: i32 = 300;

/// A cylinder around the z axis from z = 0 to z = L, grounded all around.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundedCylinder {
    /// Coulomb's constant k = 1/(4πε) [V·m/C].
    pub coulomb_constant: f64,
    /// Radius R [m].
    pub radius: f64,
    /// Length L [m].
    pub length: f64,
}

/// Place of a charge in cylindrical coordinates.
#[derive(Clone, Copy)]
struct Place {
    r: f64,
    angle: f64,
    z: f64,
}

impl GroundedCylinder {
    /// E [V/m] at every charge, of all others and of all that the walls make of it and them. Positions [m] off the axis,
    /// charges [C].
    ///
    /// Between plates the field is that of image charges along z; what the mantle adds to the potential at r of a charge at r' is
    /// −(4kq/L) Σ_n sin κz sin κz' Σ_m cos m(φ−φ') I_m(κr) I_m(κr') K_m(κR)/I_m(κR), κ = nπ/L, m from −∞ to ∞
    /// (Jackson, Classical Electrodynamics, 3rd ed., §3.11). Relative accuracy some 1e-5.
    #[must_use]
    pub fn field(&self, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<Vector3<f64>> {
        let places: Vec<Place> =
            positions.iter().map(|p| Place { r: p.x.hypot(p.y), angle: p.y.atan2(p.x), z: p.z }).collect();
        let mut e = self.between_plates(positions, charges);
        let gap = places.iter().fold(f64::INFINITY, |gap, place| gap.min(self.radius - place.r));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred terms")]
        let (along, around) = (
            (EXPONENT * self.length / (2.0 * PI * gap)).ceil() as usize,
            (EXPONENT * self.radius / (2.0 * gap)).ceil() as usize,
        );
        for n in 1..=along {
            let kappa = n as f64 * PI / self.length;
            let tables: Vec<_> = places.iter().map(|place| ln_i(kappa * place.r, around + 1)).collect();
            let (wall_i, wall_k) = (ln_i(kappa * self.radius, around), ln_k(kappa * self.radius, around));
            for (at, e) in e.iter_mut().enumerate() {
                for (from, charge) in charges.iter().enumerate() {
                    let amplitude = 4.0 * self.coulomb_constant * charge / self.length;
                    let (here, there) = (&places[at], &places[from]);
                    let turn = here.angle - there.angle;
                    let (mut radial, mut tangential, mut axial) = (0.0, 0.0, 0.0);
                    for m in 0..=around {
                        let share = if m == 0 { 1.0 } else { 2.0 };
                        let order = m as f64;
                        let ln = tables[at][m] + tables[from][m] + wall_k[m] - wall_i[m];
                        let term = share * ln.exp();
                        // I_m' = I_{m+1} + m/x I_m.
                        let slope =
                            kappa * ((tables[at][m + 1] - tables[at][m]).exp() + order / (kappa * here.r));
                        radial += term * slope * (order * turn).cos();
                        tangential -= term * order / here.r * (order * turn).sin();
                        axial += term * kappa * (order * turn).cos();
                    }
                    let source = (kappa * there.z).sin();
                    let (sine, cosine) = (kappa * here.z).sin_cos();
                    let (s, c) = here.angle.sin_cos();
                    let out = Vector3::new(c, s, 0.0) * radial + Vector3::new(-s, c, 0.0) * tangential;
                    *e += amplitude * source * (out * sine + Vector3::z() * axial * cosine);
                }
            }
        }
        e
    }

    /// E at every charge between the two ends alone.
    fn between_plates(&self, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<Vector3<f64>> {
        let field = |at: usize| {
            let mut e = Vector3::zeros();
            for (from, (place, &charge)) in positions.iter().zip(charges).enumerate() {
                for j in -ENDS..=ENDS {
                    let shift = Vector3::z() * (2.0 * self.length * f64::from(j));
                    let mut add = |image: Vector3<f64>, charge: f64| {
                        e += coulomb_field(self.coulomb_constant, charge, positions[at] - image);
                    };
                    if from != at || j != 0 {
                        add(place + shift, charge);
                    }
                    add(Vector3::new(place.x, place.y, -place.z) + shift, -charge);
                }
            }
            e
        };
        (0..positions.len()).map(field).collect()
    }
}

/// ln I_m(x) for m = 0 … `most`: ratios by continued fractions from above, I_0 by its series or asymptote.
fn ln_i(x: f64, most: usize) -> Vec<f64> {
    let beyond = most + 30 + x.ceil().max(0.0) as usize;
    let mut ratio = vec![0.0; beyond + 1];
    // I_m / I_{m−1}
    for m in (1..=beyond).rev() {
        let next = ratio.get(m + 1).copied().unwrap_or(0.0);
        ratio[m] = 1.0 / (2.0 * m as f64 / x + next);
    }
    // e^x = I_0 + 2 Σ I_m.
    let mut sum = 1.0;
    let mut relative = 1.0;
    for ratio in &ratio[1..] {
        relative *= ratio;
        sum += 2.0 * relative;
    }
    let mut ln = vec![x - sum.ln()];
    for m in 1..=most {
        ln.push(ln[m - 1] + ratio[m].ln());
    }
    ln
}

/// ln K_m(x) for m = 0 … `most`: K_0 and K_1 by their integrals ∫ e^{−x cosh t} cosh mt dt, the rest by recurrence.
fn ln_k(x: f64, most: usize) -> Vec<f64> {
    let step = 1.0 / 64.0;
    let integral = |order: f64| {
        // The trapezoidal rule converges exponentially here.
        let term = |t: f64| (-x * (t.cosh() - 1.0)).exp() * (order * t).cosh();
        0.5 * step + (1..1200).map(|i| step * term(step * f64::from(i))).sum::<f64>()
    };
    let (k0, k1) = (integral(0.0), integral(1.0));
    let mut ln = vec![k0.ln() - x];
    let mut ratio = k1 / k0;
    for m in 1..=most {
        ln.push(ln[m - 1] + ratio.ln());
        ratio = 2.0 * m as f64 / x + 1.0 / ratio;
    }
    ln
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Abramowitz & Stegun, tables 9.8 and 9.9.
    #[test]
    fn bessel_functions_are_those_of_the_tables() {
        for (x, i, k) in [
            (1.0, [1.266_065_878, 0.565_159_104], [0.421_024_438, 0.601_907_230]),
            (5.0, [27.239_871_82, 24.335_642_14], [0.003_691_098, 0.004_044_613]),
        ] {
            let (found_i, found_k) = (ln_i(x, 3), ln_k(x, 3));
            for m in 0..2 {
                assert!((found_i[m].exp() / i[m] - 1.0).abs() < 1e-8, "I_{m}({x})");
                assert!((found_k[m].exp() / k[m] - 1.0).abs() < 1e-6, "K_{m}({x})");
            }
            // Wronskian: I_m K_{m+1} + I_{m+1} K_m = 1/x.
            let wronskian = (found_i[2] + found_k[3]).exp() + (found_i[3] + found_k[2]).exp();
            assert!((wronskian * x - 1.0).abs() < 1e-10);
        }
    }

    #[test]
    fn near_the_mantle_it_is_a_plane_and_near_an_end_too() {
        let cylinder = GroundedCylinder { coulomb_constant: 1.0, radius: 1.0, length: 2.0 };
        let depth = 0.02;
        let mantle = cylinder.field(&[Vector3::new(1.0 - depth, 0.0, 1.0)], &[1.0])[0];
        // A cylinder's image is weaker by about 1 − κδ with the mean curvature κ = 1/(2R).
        let plane = 1.0 / (4.0 * depth * depth);
        assert!((mantle.x / plane - 1.0).abs() < 2.0 * depth, "{} {plane}", mantle.x);
        assert!(mantle.y.abs() + mantle.z.abs() < 1e-6 * plane);
        let end = cylinder.field(&[Vector3::new(0.1, 0.0, 0.1)], &[1.0])[0];
        assert!((end.z * 4.0 * 0.01 + 1.0).abs() < 0.01, "{}", end.z);
    }

    /// A charge feels the same whichever way a pair is turned, and two charges at the mirror places of the middle plane
    /// feel mirrored fields.
    #[test]
    fn field_has_the_cylinders_symmetry() {
        let cylinder = GroundedCylinder { coulomb_constant: 1.0, radius: 1.0, length: 2.0 };
        let pair = |angle: f64, up: bool| {
            let z = if up { [0.7, 1.1] } else { [1.3, 0.9] };
            let at = |r: f64, a: f64, z: f64| Vector3::new(r * (a + angle).cos(), r * (a + angle).sin(), z);
            cylinder.field(&[at(0.6, 0.0, z[0]), at(0.8, 0.5, z[1])], &[1.0, -2.0])[0]
        };
        let (a, b, c) = (pair(0.0, true), pair(1.0, true), pair(0.0, false));
        assert!((a.norm() - b.norm()).abs() < 1e-4 * a.norm());
        assert!((Vector3::new(c.x, c.y, -c.z) - a).norm() < 1e-4 * a.norm());
    }
}
