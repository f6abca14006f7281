//! The a-priori error of p3m for charges without correlation.
//!
//! δE = q_rms √n/(4πε) · √(F(r_c/σ)/σ + Q(p, σ/h)/h), n the number density where the charges are:
//!
//! * near, pairs beyond r_c left out: F(x) = 4π ∫_x^∞ g(t)²/t² dt, g = erfc(t/√2) + √(2/π) t e^{−t²/2};
//! * grid, with the optimal influence function (Hockney & Eastwood 1988, ch. 8):
//!   Q = ∫_zone d³k/(2π)³ [Σ_m |k_m|²R_m² − (Σ_m W_m²|k_m|²R_m)²/(Σ_m W_m² Σ_m W_m²|k_m|²)] at h = 1,
//!   R = 4π e^{−k²σ²/2}/k².

use libm::erfc;
use std::f64::consts::PI;
use std::ops::RangeInclusive;
use std::sync::LazyLock;

/// Quadrature points per axis of an octant of the zone.
const ZONE_POINTS: usize = 7;
/// Aliases on either side.
const ALIASES: i32 = 2;
/// Intervals of the near integral, which ends this many widths beyond the cut-off.
const NEAR_INTERVALS: usize = 160;
const NEAR_WIDTHS: f64 = 8.0;

/// Orders of the splines.
pub(crate) const ORDERS: RangeInclusive<usize> = 4..=8;
/// Smallest and largest σ/h considered: below, the model is no longer a model; above, order 8 has no use.
const RATIOS: [f64; 2] = [0.3, 4.0];
/// Smallest and largest r_c/σ considered.
const CUTOFFS: [f64; 2] = [0.5, 9.0];

/// A falling function tabulated as ln f over ln x.
struct Table(Vec<(f64, f64)>);

impl Table {
    fn new([low, high]: [f64; 2], count: usize, function: impl Fn(f64) -> f64) -> Self {
        let (low, high) = (low.ln(), high.ln());
        let at = |i: usize| low + (high - low) * i as f64 / count as f64;
        Self((0..=count).map(|i| (at(i), function(at(i).exp()).max(f64::MIN_POSITIVE).ln())).collect())
    }

    /// Smallest x whose value is at most `bound`.
    fn solve(&self, bound: f64) -> Option<f64> {
        let bound = bound.ln();
        let at = self.0.partition_point(|(_, value)| *value > bound);
        let (x1, value1) = *self.0.get(at)?;
        if at == 0 {
            return Some(x1.exp());
        }
        let (x0, value0) = self.0[at - 1];
        Some((x0 + (x1 - x0) * (value0 - bound) / (value0 - value1)).exp())
    }
}

static GRID: LazyLock<Vec<Table>> = LazyLock::new(|| {
    ORDERS.map(|order| Table::new(RATIOS, 28, |ratio| grid_error_squared(order, ratio))).collect()
});
static NEAR: LazyLock<Table> = LazyLock::new(|| Table::new(CUTOFFS, 120, near_error_squared));

/// Smallest σ/h whose Q is at most `bound`.
pub(crate) fn sigma_over_spacing_for(order: usize, bound: f64) -> Option<f64> {
    GRID[order - ORDERS.start()].solve(bound)
}

/// Smallest r_c/σ whose F is at most `bound`.
pub(crate) fn cutoff_over_sigma_for(bound: f64) -> Option<f64> {
    NEAR.solve(bound)
}

/// F(x): squared near error per q²n/σ (4πε = 1) of a cut-off of x widths.
pub(crate) fn near_error_squared(cutoff_over_sigma: f64) -> f64 {
    let integrand = |t: f64| {
        let g = erfc(t / 2.0_f64.sqrt()) + (2.0 / PI).sqrt() * t * (-0.5 * t * t).exp();
        (g / t).powi(2)
    };
    let step = NEAR_WIDTHS / NEAR_INTERVALS as f64;
    let sum: f64 = (0..=NEAR_INTERVALS)
        .map(|i| {
            let weight = match i {
                0 | NEAR_INTERVALS => 1.0,
                i if i % 2 == 1 => 4.0,
                _ => 2.0,
            };
            weight * integrand(cutoff_over_sigma + step * i as f64)
        })
        .sum();
    4.0 * PI * sum * step / 3.0
}

/// Q(p, σ/h): squared grid error per q²n/h (4πε = 1).
pub(crate) fn grid_error_squared(order: usize, sigma_over_spacing: f64) -> f64 {
    let step = PI / ZONE_POINTS as f64;
    let axis: Vec<AxisAliases> = (0..ZONE_POINTS)
        .map(|i| AxisAliases::new(step * (i as f64 + 0.5), order, sigma_over_spacing))
        .collect();
    let mut sum = 0.0;
    for x in 0..ZONE_POINTS {
        for y in 0..=x {
            for z in 0..=y {
                // Number of distinct permutations.
                let weight = match (x == y, y == z) {
                    (true, true) => 1.0,
                    (false, false) => 6.0,
                    _ => 3.0,
                };
                sum += weight * zone_integrand([&axis[x], &axis[y], &axis[z]]);
            }
        }
    }
    8.0 * sum * step.powi(3) / (2.0 * PI).powi(3)
}

/// Aliases of one wave-number component, the principal one first: k², W², e^{−k²σ²/2}.
struct AxisAliases(Vec<[f64; 3]>);

impl AxisAliases {
    fn new(wave: f64, order: usize, sigma: f64) -> Self {
        let aliases = std::iter::once(0).chain((1..=ALIASES).flat_map(|m| [m, -m]));
        Self(
            aliases
                .map(|m| {
                    let k = wave + 2.0 * PI * f64::from(m);
                    let window = ((0.5 * k).sin() / (0.5 * k)).powi(2 * order as i32);
                    [k * k, window, (-0.5 * k * k * sigma * sigma).exp()]
                })
                .collect(),
        )
    }
}

/// The bracket of Q, arranged so that nothing cancels: the principal alias is split off every sum.
fn zone_integrand(axis: [&AxisAliases; 3]) -> f64 {
    let (mut windows, mut squares, mut crossed, mut aliased) = (0.0, 0.0, 0.0, 0.0);
    let (mut window0, mut k0, mut r0) = (0.0, 0.0, 0.0);
    for (i, a) in axis[0].0.iter().enumerate() {
        for (j, b) in axis[1].0.iter().enumerate() {
            for (l, c) in axis[2].0.iter().enumerate() {
                let wave_squared = a[0] + b[0] + c[0];
                let window = a[1] * b[1] * c[1];
                let reference = 4.0 * PI * a[2] * b[2] * c[2] / wave_squared;
                if i + j + l == 0 {
                    (window0, k0, r0) = (window, wave_squared, reference);
                } else {
                    windows += window;
                    squares += window * wave_squared;
                    crossed += window * wave_squared * reference;
                    aliased += wave_squared * reference * reference;
                }
            }
        }
    }
    let denominator = (window0 + windows) * (window0 * k0 + squares);
    let lost = window0 * squares + windows * window0 * k0 + windows * squares;
    k0 * r0 * r0 * lost / denominator + aliased - crossed * (2.0 * window0 * k0 * r0 + crossed) / denominator
}

#[cfg(test)]
mod tests {
    use super::*;

    /// NUMERICS: C for order 5 at r_c = 3.5 σ (near and grid together), order 6 at 4 σ.
    #[test]
    fn agrees_with_measured_coefficients() {
        for (order, ratio, cutoff, measured) in [
            (4, 0.8, 3.5, 0.075),
            (5, 0.8, 3.5, 0.049),
            (5, 1.0, 3.5, 0.0132),
            (5, 1.0, 3.0, 0.0185),
            (6, 0.9, 3.5, 0.018),
            (6, 1.2, 4.0, 0.0020),
        ] {
            let squared = grid_error_squared(order, ratio) + near_error_squared(cutoff) / ratio;
            let ratio_to_measured = squared.sqrt() / measured;
            assert!((0.7..1.5).contains(&ratio_to_measured), "{order} {ratio}: {ratio_to_measured}");
        }
    }

    #[test]
    fn tables_invert_the_functions() {
        for cutoff in [1.3, 2.9, 4.4, 6.1] {
            let found = cutoff_over_sigma_for(near_error_squared(cutoff)).unwrap();
            assert!((found / cutoff - 1.0).abs() < 1e-3, "{cutoff}: {found}");
        }
        for order in ORDERS {
            let found = sigma_over_spacing_for(order, grid_error_squared(order, 1.1)).unwrap();
            assert!((found / 1.1 - 1.0).abs() < 1e-2, "{order}: {found}");
        }
        assert!(cutoff_over_sigma_for(0.0).is_none());
    }

    #[test]
    fn errors_fall_with_cutoff_width_and_order() {
        assert!(near_error_squared(4.0) < 0.1 * near_error_squared(3.0));
        assert!(grid_error_squared(5, 1.2) < 0.1 * grid_error_squared(5, 0.8));
        assert!(grid_error_squared(8, 1.2) < 0.1 * grid_error_squared(5, 1.2));
    }
}
