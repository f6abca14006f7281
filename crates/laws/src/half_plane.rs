//! Potential that a thin conducting or insulating half plane adds to that of a point charge beside it:
//!
//! V_induced = −q/(4πε) [T(x, y) ± T(x, y*)],  + conductor at potential 0, − insulator,
//!
//! T(x, y) = arccot(c/R)/(πR),  R = |x − y|,  c = 2 (a_x a_y + b_x b_y),
//!
//! y the place of the charge, y* its mirror image in the plane. a and b are parabolic coordinates about the
//! rim, (a + ib)² = p + iz in the plane across it: p is the distance into the plate, z that above it, a has
//! the sign of z and b ≥ 0. With the charge's own potential q/(4πεR) the sum vanishes on both faces of the
//! plate, and falls to nothing deep in its shadow; for an insulator the normal field does.
//!
//! T is the share of a point charge's potential that the plate hides from x, over R: 1/R where the plate
//! lies between x and y and the rim is far, 0 where x sees y and the rim is far. T(x, y) is harmonic in x,
//! finite at x = y, and symmetric.
//!
//! q charge [C]; ε permittivity [F/m]; lengths in m. The functions of this file are for q/(4πε) = 1.
//! Range: every x and y off the plate.
//! Source: Sommerfeld, Proc. London Math. Soc. 28, 395 (1897), the two-sheeted Riemann space; the same in
//! Landau & Lifshitz, Electrodynamics of Continuous Media, 2nd ed., §3, problem 11.
//!
//! ```
//! use amberfield_laws::half_plane::{Across, hidden};
//! // A charge 1 above a plate, 1000 from its rim; a place as high, 2 beside it.
//! let (charge, image) = (Across::new(1000.0, 1.0), Across::new(1000.0, -1.0));
//! let place = Across::new(1000.0, 1.0);
//! let induced = -hidden(2.0, place.between(&charge)).value
//!     - hidden(8.0_f64.sqrt(), place.between(&image)).value;
//! assert!((induced + 1.0 / 8.0_f64.sqrt()).abs() < 1e-3);
//! ```

use std::f64::consts::PI;

/// R/|c| below which series take the place of closed forms that cancel.
const SERIES: f64 = 0.03;

/// Place across the rim of a half plane in parabolic coordinates [m^½].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Across {
    /// a = ±√((r + p)/2), with the sign of z.
    pub a: f64,
    /// b = √((r − p)/2), not negative.
    pub b: f64,
}

/// Hidden share over distance, T [1/m], and its slopes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hidden {
    /// T [1/m].
    pub value: f64,
    /// Slope ∂T/∂R over R, at fixed c [1/m³].
    pub slope_over_distance: f64,
    /// Slope ∂T/∂c, at fixed R [1/m²].
    pub slope_between: f64,
}

impl Across {
    /// Place at a distance p into the plate from its rim [m] (negative: beyond the rim) and a height z
    /// above it [m]. A height of −0 is the lower face.
    #[must_use]
    pub fn new(p: f64, z: f64) -> Self {
        let r = p.hypot(z);
        // The smaller of the two cancels; their product is |z|/2.
        let larger = (0.5 * (r + p.abs())).sqrt();
        let smaller = if larger > 0.0 { 0.5 * z.abs() / larger } else { 0.0 };
        let (a, b) = if p >= 0.0 { (larger, smaller) } else { (smaller, larger) };
        Self { a: a.copysign(z), b }
    }

    /// c = 2 (a a' + b b') of two places [m].
    #[must_use]
    pub fn between(&self, other: &Self) -> f64 {
        2.0 * (self.a * other.a + self.b * other.b)
    }

    /// Slopes ∂c/∂p and ∂c/∂z of [`Self::between`] at this place.
    #[must_use]
    pub fn slope_between(&self, other: &Self) -> [f64; 2] {
        let twice_r = 2.0 * (self.a * self.a + self.b * self.b);
        let along_plate = self.a * other.a - self.b * other.b;
        let across_plate = self.b * other.a + self.a * other.b;
        [2.0 * along_plate / twice_r, 2.0 * across_plate / twice_r]
    }
}

/// Hidden share over distance T(R, c), for R ≥ 0 [m]; R > 0 where c ≤ 0.
#[must_use]
pub fn hidden(distance: f64, between: f64) -> Hidden {
    let (r, c) = (distance, between);
    let slope_between = -1.0 / (PI * (r * r + c * c));
    if c > 0.0 && r < SERIES * c {
        let y = (r / c).powi(2);
        let value = (1.0 - y / 3.0 + y * y / 5.0 - y * y * y / 7.0) / (PI * c);
        let slope =
            (-2.0 / 3.0 + 4.0 / 5.0 * y - 6.0 / 7.0 * y * y + 8.0 / 9.0 * y * y * y) / (PI * c.powi(3));
        return Hidden { value, slope_over_distance: slope, slope_between };
    }
    let value = r.atan2(c) / (PI * r);
    let slope = (c / (PI * (r * r + c * c)) - value) / (r * r);
    Hidden { value, slope_over_distance: slope, slope_between }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Potential at (p, z), `along` the rim from a unit charge at (p, z) = `charge`.
    fn potential(at: [f64; 3], charge: [f64; 2], image_sign: f64) -> f64 {
        let [p, z, along] = at;
        let place = Across::new(p, z);
        let distance = |height: f64| ((p - charge[0]).powi(2) + (z - height).powi(2) + along * along).sqrt();
        let term =
            |height: f64| hidden(distance(height), place.between(&Across::new(charge[0], height))).value;
        1.0 / distance(charge[1]) - term(charge[1]) + image_sign * term(-charge[1])
    }

    #[test]
    fn conductor_has_no_potential_and_insulator_no_slope_on_either_face() {
        for charge in [[1.0, 0.3], [0.05, 0.4], [-0.7, 0.2], [2.0, -0.5]] {
            for p in [0.01, 0.4, 3.0] {
                for z in [0.0, -0.0] {
                    assert!(potential([p, z, 0.3], charge, -1.0).abs() < 1e-14, "{charge:?} {p}");
                    let side = 1.0_f64.copysign(z);
                    let step = |height: f64| potential([p, side * height, 0.3], charge, 1.0);
                    let slope = (4.0 * step(1e-4) - step(2e-4) - 3.0 * step(0.0)) / 2e-4;
                    assert!(slope.abs() < 2e-4, "{charge:?} {p} {slope}");
                }
            }
        }
    }

    #[test]
    fn potential_is_harmonic_and_symmetric_and_goes_smoothly_around_the_rim() {
        let step = 1e-3;
        for at in [[-0.4, 0.1, 0.2], [-0.3, 0.0, 0.1], [0.5, -0.6, 0.0]] {
            let shifted = |axis: usize, by: f64| {
                let mut moved = at;
                moved[axis] += by;
                potential(moved, [0.8, 0.5], -1.0)
            };
            let centre = shifted(0, 0.0);
            let laplacian: f64 = (0..3)
                .map(|axis| (shifted(axis, step) + shifted(axis, -step) - 2.0 * centre) / step.powi(2))
                .sum();
            assert!(laplacian.abs() < 1e-5, "{at:?} {laplacian}");
            let back = potential([0.8, 0.5, at[2]], [at[0], at[1]], -1.0);
            assert!((centre - back).abs() < 1e-13);
        }
    }

    #[test]
    fn far_from_the_rim_the_plate_is_a_plane() {
        let in_front = potential([1e6, 1.0, 2.0], [1e6, 1.0], -1.0);
        assert!((in_front - (0.5 - 1.0 / 8.0_f64.sqrt())).abs() < 1e-5);
        assert!(potential([1e6, -1.0, 2.0], [1e6, 1.0], -1.0).abs() < 1e-5);
    }

    #[test]
    fn slopes_are_those_of_the_value() {
        for (r, c) in [(0.3, 2.0), (0.3, -2.0), (1.5, 0.1), (0.01, 2.0), (0.0599, 2.0), (0.0601, 2.0)] {
            let step = 1e-5;
            let given = hidden(r, c);
            let of_r = (hidden(r + step, c).value - hidden(r - step, c).value) / (2.0 * step * r);
            let of_c = (hidden(r, c + step).value - hidden(r, c - step).value) / (2.0 * step);
            assert!((given.slope_over_distance - of_r).abs() < 1e-6, "{r} {c} {given:?} {of_r}");
            assert!((given.slope_between - of_c).abs() < 1e-8, "{r} {c}");
        }
        let (place, other) = (Across::new(0.3, -0.4), Across::new(1.0, 0.2));
        let moved = |p: f64, z: f64| Across::new(0.3 + p, -0.4 + z).between(&other);
        let [of_p, of_z] = place.slope_between(&other);
        assert!((of_p - (moved(1e-6, 0.0) - moved(-1e-6, 0.0)) / 2e-6).abs() < 1e-8);
        assert!((of_z - (moved(0.0, 1e-6) - moved(0.0, -1e-6)) / 2e-6).abs() < 1e-8);
    }
}
