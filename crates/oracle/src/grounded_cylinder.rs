//! Point charges in a closed grounded cylinder, by a Fourier–Bessel series.

use crate::point_charge::coulomb_field;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Largest exponent up to which terms along the axis and around it are summed: e⁻¹⁴ is below 1e-6.
const EXPONENT: f64 = 14.0;
/// Number of images in the two ends, to either side.
const ENDS: i32 = 300;

/// Cylinder around the z axis from z = 0 to z = L, grounded on its mantle and both ends.
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
struct CylindricalPoint {
    /// Distance from the axis [m].
    r: f64,
    /// Angle around the axis [rad].
    angle: f64,
    /// Height along the axis [m].
    z: f64,
}

/// Logarithms of Bessel functions that one wave number κ needs.
struct Tables {
    /// ln I_m(κr) for each charge, m = 0 … `around` + 1.
    charges: Vec<Vec<f64>>,
    /// ln I_m(κR), m = 0 … `around`.
    wall_i: Vec<f64>,
    /// ln K_m(κR), m = 0 … `around`.
    wall_k: Vec<f64>,
}

/// Sums over m of the three components of one wave number's field.
#[derive(Clone, Copy, Default)]
struct Components {
    radial: f64,
    tangential: f64,
    axial: f64,
}

impl GroundedCylinder {
    /// Field E [V/m] at each charge [C]: that of all other charges and of the charges induced on the walls.
    ///
    /// Positions [m] lie off the axis. Between the two ends the field is that of image charges along z. The
    /// mantle adds to the potential of a charge at r' −(4kq/L) Σ_n sin κz sin κz' Σ_m cos m(φ−φ') I_m(κr)
    /// I_m(κr') K_m(κR)/I_m(κR), κ = nπ/L, m from −∞ to ∞. Relative accuracy about 1e-5.
    ///
    /// Source: Jackson, *Classical Electrodynamics*, 3rd ed., §3.11.
    #[must_use]
    pub fn field(&self, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<Vector3<f64>> {
        let places: Vec<CylindricalPoint> = positions
            .iter()
            .map(|p| CylindricalPoint { r: p.x.hypot(p.y), angle: p.y.atan2(p.x), z: p.z })
            .collect();
        let mut e = self.between_plates(positions, charges);

        // Terms decay as e^{−2κ gap} and e^{−2m gap/R}: the charge nearest to the mantle needs most of them.
        let gap = places.iter().fold(f64::INFINITY, |gap, place| gap.min(self.radius - place.r));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundred terms")]
        let (along, around) = (
            (EXPONENT * self.length / (2.0 * PI * gap)).ceil() as usize,
            (EXPONENT * self.radius / (2.0 * gap)).ceil() as usize,
        );
        for n in 1..=along {
            let kappa = n as f64 * PI / self.length;
            let tables = Tables {
                charges: places.iter().map(|place| ln_i(kappa * place.r, around + 1)).collect(),
                wall_i: ln_i(kappa * self.radius, around),
                wall_k: ln_k(kappa * self.radius, around),
            };
            for (at, e) in e.iter_mut().enumerate() {
                for (from, charge) in charges.iter().enumerate() {
                    let amplitude = 4.0 * self.coulomb_constant * charge / self.length;
                    let (here, there) = (&places[at], &places[from]);
                    let turn = here.angle - there.angle;
                    let sum = tables.sum(kappa, [at, from], here.r, turn);

                    let source = (kappa * there.z).sin();
                    let (sine, cosine) = (kappa * here.z).sin_cos();
                    let (s, c) = here.angle.sin_cos();
                    let outwards = Vector3::new(c, s, 0.0) * sum.radial;
                    let around_axis = Vector3::new(-s, c, 0.0) * sum.tangential;
                    let across = outwards + around_axis;
                    *e += amplitude * source * (across * sine + Vector3::z() * sum.axial * cosine);
                }
            }
        }
        e
    }

    /// Field E [V/m] at each charge between the two ends alone, without the mantle.
    fn between_plates(&self, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<Vector3<f64>> {
        let field = |at: usize| {
            let mut e = Vector3::zeros();
            for (from, (place, &charge)) in positions.iter().zip(charges).enumerate() {
                for j in -ENDS..=ENDS {
                    let shift = Vector3::z() * (2.0 * self.length * f64::from(j));
                    let mut add = |image: Vector3<f64>, charge: f64| {
                        e += coulomb_field(self.coulomb_constant, charge, positions[at] - image);
                    };
                    // A charge does not act on itself, but all its images do.
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

impl Tables {
    /// Sum over m for the field at charge `at` of charge `from`, at radius `r` [m], `turn` = φ − φ' [rad].
    fn sum(&self, kappa: f64, [at, from]: [usize; 2], r: f64, turn: f64) -> Components {
        let (here, there) = (&self.charges[at], &self.charges[from]);
        let mut sum = Components::default();
        for m in 0..self.wall_i.len() {
            // Orders m and −m contribute alike.
            let share = if m == 0 { 1.0 } else { 2.0 };
            let order = m as f64;
            // The functions overflow long before their product does; so their logarithms are added.
            let ln = here[m] + there[m] + self.wall_k[m] - self.wall_i[m];
            let term = share * ln.exp();
            // I_m' = I_{m+1} + m/x I_m.
            let slope = kappa * ((here[m + 1] - here[m]).exp() + order / (kappa * r));

            sum.radial += term * slope * (order * turn).cos();
            sum.tangential -= term * order / r * (order * turn).sin();
            sum.axial += term * kappa * (order * turn).cos();
        }
        sum
    }
}

/// Logarithms ln I_m(x) for m = 0 … `most`, by ratios I_m/I_{m−1} as continued fractions from above.
fn ln_i(x: f64, most: usize) -> Vec<f64> {
    let beyond = most + 30 + x.ceil().max(0.0) as usize;
    let mut ratio = vec![0.0; beyond + 1];
    // ratio[m] = I_m/I_{m−1}. The recurrence is stable only downwards.
    for m in (1..=beyond).rev() {
        let next = ratio.get(m + 1).copied().unwrap_or(0.0);
        ratio[m] = 1.0 / (2.0 * m as f64 / x + next);
    }
    // I_0 from e^x = I_0 + 2 Σ I_m.
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

/// Logarithms ln K_m(x) for m = 0 … `most`: K_0 and K_1 by their integrals ∫ e^{−x cosh t} cosh mt dt, the
/// rest by recurrence.
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

    /// Source of the values: Abramowitz & Stegun, tables 9.8 and 9.9.
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

    /// Turning a pair about the axis turns its field, and mirroring it in the middle plane mirrors its field.
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
