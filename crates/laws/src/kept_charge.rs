//! Charge that an insulator keeps around the place where a grain left it: σ(ρ) = Q/(2πs²) (1 − ρ²/6s²)².
//!
//! The charge Q is spread over the surface around the place on the scale of the grain, whatever the surface
//! is made of:
//!
//! ```text
//! σ(ρ) = Q/(2πs²) (1 − ρ²/6s²)²  for ρ < √6 s,   ∫ σ dA = Q,   A_f = Q/σ(0) = 2πs²
//! ```
//!
//! ρ distance along the surface [m]; s the larger of the radii of the grain that left the charge and of the
//! one that feels it [m]. A_f makes the kept charge act on the contact as the grain's own charge does: as
//! from a radius away, σ(0)/(2ε) = Q/(4πεs²). So one contact with a bare insulator takes what it takes with a
//! conductor, whose image is as large; and what neighbouring contacts leave adds up to σ/(2ε) of the mean
//! charge per area σ.
//!
//! At an offset d from the place, at the height h = d·n before the surface with unit normal n, the field is
//!
//! ```text
//! E = Q/(4πε) [d/max(|d|, s)³ + n sgn(h) (1 − |h|/s)₊ (1 − ρ²/6s²)₊²/s²],   ρ² = d² − h²
//! ```
//!
//! Coulomb's beyond a few s, that of a charged sheet near the surface, on both of its sides, and never above
//! that of a charge a radius away. Positive h and n are on the side on which the charge was left.
//! Range: surfaces that bend little within s.
//! Source: this model; A_f closes the transfer of J. Kolehmainen, A. Ozel, C. M. Boyce & S. Sundaresan,
//! AIChE J. 63, 1872 (2017), which leaves the facet's area to the mesh.
//!
//! ```
//! use amberfield_laws::kept_charge::KeptCharge;
//! use nalgebra::Vector3;
//! let kept = KeptCharge { scale: 1e-3, normal: Vector3::z() };
//! // At the place itself as from a radius away, and far away Coulomb's.
//! let at_place = kept.field(Vector3::zeros(), 1.0);
//! assert!((at_place.z * 1e-6 - 1.0).abs() < 1e-12);
//! let far = Vector3::new(0.01, 0.0, 0.01);
//! assert!((kept.field(far, 1.0) - far / far.norm().powi(3)).norm() < 1e-9 * 1e4);
//! ```

use nalgebra::Vector3;
use std::f64::consts::PI;

/// Reach of the charge along the surface, over s.
pub const REACH: f64 = 2.449_489_742_783_178;

/// Shape of a charge kept by a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptCharge {
    /// Scale s [m].
    pub scale: f64,
    /// Unit normal n of the surface, on the side on which the charge was left.
    pub normal: Vector3<f64>,
}

impl KeptCharge {
    /// Field over Q/(4πε) [1/m²] at an offset [m] from the place; `side`, 1 or −1, is the sign of the height
    /// where that is round-off.
    #[must_use]
    pub fn field(self, offset: Vector3<f64>, side: f64) -> Vector3<f64> {
        let Self { scale, normal } = self;
        let distance2 = offset.norm_squared();
        let height = offset.dot(&normal);
        let near = (1.0 - height.abs() / scale).max(0.0);
        let spread = (1.0 - (distance2 - height * height).max(0.0) / (6.0 * scale * scale)).max(0.0);
        let sheet = side.signum() * near * (spread / scale).powi(2);
        offset / distance2.sqrt().max(scale).powi(3) + normal * sheet
    }

    /// Charge per area over Q [1/m²] at a distance along the surface [m].
    #[must_use]
    pub fn density(self, distance: f64) -> f64 {
        let spread = (1.0 - distance * distance / (6.0 * self.scale * self.scale)).max(0.0);
        spread * spread / (2.0 * PI * self.scale * self.scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEPT: KeptCharge = KeptCharge { scale: 0.7, normal: Vector3::new(0.0, 0.0, 1.0) };

    #[test]
    fn density_holds_the_charge() {
        let count = 100_000;
        let step = REACH * KEPT.scale / f64::from(count);
        let ring = |n: i32| {
            let rho = (f64::from(n) + 0.5) * step;
            2.0 * PI * rho * KEPT.density(rho) * step
        };
        assert!(((0..count).map(ring).sum::<f64>() - 1.0).abs() < 1e-9);
        assert_eq!(KEPT.density(1.001 * REACH * KEPT.scale), 0.0);
    }

    #[test]
    fn even_cover_has_the_field_of_a_sheet_and_both_sides_feel_it() {
        // Places on a square lattice, a charge of one on each: E = 2πσ over 1/(4πε).
        let apart = 0.4;
        let sheet = |at: Vector3<f64>, side: f64| -> Vector3<f64> {
            let cells = -40_i32..=40;
            let places = cells.clone().flat_map(|i| cells.clone().map(move |j| (i, j)));
            let offset = |(i, j): (i32, i32)| at - Vector3::new(f64::from(i), f64::from(j), 0.0) * apart;
            places.map(|place| KEPT.field(offset(place), side)).sum()
        };
        let expected = 2.0 * PI / (apart * apart);
        for (x, y) in [(0.0, 0.0), (0.2, 0.1), (0.17, 0.2)] {
            let front = sheet(Vector3::new(x, y, 0.0), 1.0).z;
            let back = sheet(Vector3::new(x, y, 0.0), -1.0).z;
            assert!((front / expected - 1.0).abs() < 1e-2, "{front} {expected}");
            assert!((front + back).abs() < 1e-9 * expected);
        }
    }

    #[test]
    fn field_is_bounded_and_continuous() {
        let largest = 2.0 / KEPT.scale.powi(2);
        let mut last = KEPT.field(Vector3::new(0.3, 0.0, 1e-9), 1.0);
        for n in 1..1000 {
            let now = KEPT.field(Vector3::new(0.3, 0.0, 3e-3 * f64::from(n)), 1.0);
            assert!(now.norm() < largest && (now - last).norm() < 0.02 * largest, "{n}: {now} {last}");
            last = now;
        }
    }
}
