//! Potential and field of a flat triangle with an even charge: φ = σ I/(4πε), E = −σ ∇I/(4πε),
//! I = ∫ dS/R over the triangle.
//!
//! With d the distance of the point from the plane along the unit normal n, and for each edge s its unit
//! vector, u = s × n (outwards), l₋ and l₊ its ends along s from the point, t the distance of its line along
//! u, R₋ and R₊ the distances of its ends, R₀² = t² + d²:
//!
//! F = ln[(R₊ + l₊)/(R₋ + l₋)],  Ω = Σ [atan(t l₊/(R₀² + |d| R₊)) − atan(t l₋/(R₀² + |d| R₋))],
//! I = Σ t F − |d| Ω,  −∇I = Σ u F + sgn(d) Ω n.
//!
//! I integral [m], σ charge per area [C/m²]. In the plane of the triangle the normal field is the mean of
//! both sides, 0. Range: everywhere but on the edges, where the field is infinite.
//! Source: Wilton et al., IEEE Trans. Antennas Propag. 32, 276 (1984); Graglia, ibid. 41, 1448 (1993).
//!
//! ```
//! use amberfield_laws::charged_triangle::integrals;
//! use nalgebra::Vector3;
//! let corners = [Vector3::zeros(), Vector3::x(), Vector3::y()];
//! // Far away it is a point charge.
//! let (potential, _) = integrals(&Vector3::new(0.0, 0.0, 1e3), &corners);
//! assert!((potential - 0.5 / 1e3).abs() < 1e-9);
//! ```

use nalgebra::Vector3;

/// Distance of a point from an edge's line, over its length, below which it lies on the line.
const ON_LINE: f64 = 1e-14;

/// ∫ dS/R [m] and −∇∫ dS/R (no unit) at a point, over the triangle with these corners [m]. The normal is
/// right-handed about the corners; results do not depend on their order.
#[must_use]
pub fn integrals(at: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> (f64, Vector3<f64>) {
    let across = (corners[1] - corners[0]).cross(&(corners[2] - corners[0]));
    let normal = across / across.norm();
    let height = normal.dot(&(at - corners[0]));
    let above = height.abs();
    let (mut potential, mut angle, mut field) = (0.0, 0.0, Vector3::zeros());
    for k in 0..3 {
        let (from, to) = (corners[k], corners[(k + 1) % 3]);
        let length = (to - from).norm();
        let along = (to - from) / length;
        let outwards = along.cross(&normal);
        let lower = along.dot(&(from - at));
        let upper = lower + length;
        let aside = outwards.dot(&(from - at));
        let nearest2 = aside * aside + height * height;
        if nearest2 <= (ON_LINE * length).powi(2) {
            continue;
        }
        let (to_lower, to_upper) = ((lower * lower + nearest2).sqrt(), (upper * upper + nearest2).sqrt());
        // Two forms of the same: the one without a difference of almost equal numbers.
        let logarithm = if lower + upper > 0.0 {
            ((to_upper + upper) / (to_lower + lower)).ln()
        } else {
            ((to_lower - lower) / (to_upper - upper)).ln()
        };
        potential += aside * logarithm;
        field += outwards * logarithm;
        angle += (aside * upper).atan2(nearest2 + above * to_upper)
            - (aside * lower).atan2(nearest2 + above * to_lower);
    }
    let side = if height == 0.0 { 0.0 } else { height.signum() };
    (potential - above * angle, field + normal * (side * angle))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const CORNERS: [Vector3<f64>; 3] =
        [Vector3::new(0.1, 0.0, 0.2), Vector3::new(1.1, 0.3, 0.1), Vector3::new(0.4, 0.9, -0.3)];

    /// Sum over the centroids of many equal pieces.
    fn by_pieces(at: &Vector3<f64>, corners: &[Vector3<f64>; 3], depth: u32) -> (f64, Vector3<f64>) {
        let [a, b, c] = *corners;
        if depth == 0 {
            let area = 0.5 * (b - a).cross(&(c - a)).norm();
            let apart = at - (a + b + c) / 3.0;
            let distance = apart.norm();
            return (area / distance, apart * (area / distance.powi(3)));
        }
        let (ab, bc, ca) = ((a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0);
        let pieces = [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]];
        pieces
            .iter()
            .map(|piece| by_pieces(at, piece, depth - 1))
            .fold((0.0, Vector3::zeros()), |sum, one| (sum.0 + one.0, sum.1 + one.1))
    }

    #[test]
    fn is_the_sum_over_pieces() {
        for at in [Vector3::new(0.5, 0.4, 0.6), Vector3::new(-2.0, 1.0, 0.3), Vector3::new(0.6, 0.2, -0.5)] {
            let ((potential, field), (summed, of_field)) =
                (integrals(&at, &CORNERS), by_pieces(&at, &CORNERS, 7));
            assert!((potential / summed - 1.0).abs() < 1e-5, "{at}");
            assert!((field - of_field).norm() < 1e-4 * field.norm(), "{at}");
        }
    }

    #[test]
    fn field_is_the_slope_of_the_potential_and_jumps_by_four_pi() {
        let at = Vector3::new(0.5, 0.3, 0.4);
        let step = 1e-5;
        let slope = Vector3::from_fn(|axis, _| {
            let by = Vector3::ith(axis, step);
            (integrals(&(at - by), &CORNERS).0 - integrals(&(at + by), &CORNERS).0) / (2.0 * step)
        });
        assert!((integrals(&at, &CORNERS).1 - slope).norm() < 1e-8);

        let centre = CORNERS.iter().sum::<Vector3<f64>>() / 3.0;
        let normal = (CORNERS[1] - CORNERS[0]).cross(&(CORNERS[2] - CORNERS[0])).normalize();
        let at_height = |height: f64| integrals(&(centre + normal * height), &CORNERS).1.dot(&normal);
        assert!((at_height(1e-9) - at_height(-1e-9) - 4.0 * PI).abs() < 1e-6);
        assert!(at_height(0.0).abs() < 1e-9);
    }

    #[test]
    fn order_and_cutting_of_the_triangle_do_not_matter() {
        let at = Vector3::new(0.9, -0.2, 0.15);
        let (potential, field) = integrals(&at, &CORNERS);
        let [a, b, c] = CORNERS;
        let (other, of_other) = integrals(&at, &[b, a, c]);
        assert!((potential - other).abs() < 1e-14 && (field - of_other).norm() < 1e-13);
        let within = 0.3 * a + 0.5 * b + 0.2 * c;
        let cut = [[a, b, within], [b, c, within], [c, a, within]].map(|piece| integrals(&at, &piece));
        let sum: f64 = cut.iter().map(|one| one.0).sum();
        let of_sum: Vector3<f64> = cut.iter().map(|one| one.1).sum();
        assert!((potential - sum).abs() < 1e-13 && (field - of_sum).norm() < 1e-12);
    }
}
