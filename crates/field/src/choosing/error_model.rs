//! The a-priori error of p3m for charges without correlation.
//!
//! δE = q_rms/(4πε) · √(n Q(p, r_c/h)/h), n the number density where the charges are, with (Hockney &
//! Eastwood, *Computer Simulation Using Particles*, 1988, ch. 8, for a given influence function G)
//!
//! Q = ∫_zone d³k/(2π)³ [Σ_m |k_m|²R_m² − 2G Σ_m W_m²|k_m|²R_m + G² Σ_m W_m² Σ_m W_m²|k_m|²] at h = 1,
//!
//! R = 4π χ(k)/k² the cloud's potential, W the window, G = R/W² what makes every wave of the zone exact.
//! The near level ends where the cloud does and leaves nothing out.
//!
//! Charges of one sign have a mean field besides, which is smooth and not random. A potential that falls
//! evenly is gathered with the window's slope: the wave m of the grid, which the window lets through where
//! it meets a slope, adds 2w_m cos(2πmx/h) of the field along each axis, w_m = dW/dk at 2πm, times 2πm. So
//! δE² grows by 2 Σ_m w_m² times the square of the grid's part of E.

use crate::levels::grid::shapes::Shapes;
use crate::levels::grid::window::Window;
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use std::f64::consts::PI;

/// Quadrature points per axis of an octant of the zone.
const ZONE_POINTS: usize = 16;
/// Wave numbers, in shapes over the cloud's radius, beyond which its spectrum counts for nothing.
const WAVES: f64 = 2.5;
/// Aliases on either side.
const ALIASES: i32 = 2;

/// Q: squared error per q²n/h (4πε = 1) of a window of order p and a cut-off of `ratio` node spacings.
pub(crate) fn error_squared(order: usize, ratio: f64, shapes: Shapes) -> f64 {
    let cloud = Cloud { radius: ratio, shape: shapes.cloud };
    let window = Window::new(order, shapes.window);
    // Nothing is left of a wide cloud's waves in most of the zone.
    let edge = PI.min(WAVES * shapes.cloud / ratio);
    let step = edge / ZONE_POINTS as f64;
    let axis: Vec<AxisAliases> =
        (0..ZONE_POINTS).map(|i| AxisAliases::new(step * (i as f64 + 0.5), &window)).collect();
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
                sum += weight * zone_integrand(cloud, [&axis[x], &axis[y], &axis[z]]);
            }
        }
    }
    8.0 * sum * step.powi(3) / (2.0 * PI).powi(3)
}

/// Squared error over the square of the grid's part of E, where that is smooth.
pub(crate) fn smooth_error_squared(order: usize, window_shape: f64) -> f64 {
    /// Waves that count.
    const WAVES_OF_GRID: i32 = 4;
    /// Step of the difference quotient.
    const STEP: f64 = 1e-4;
    let window = Window::new(order, window_shape);
    let wave = |m: i32| {
        let k = 2.0 * PI * f64::from(m);
        k * (window.transform(k + STEP) - window.transform(k - STEP)) / (2.0 * STEP)
    };
    2.0 * (1..=WAVES_OF_GRID).map(|m| wave(m).powi(2)).sum::<f64>() / window.transform(0.0).powi(2)
}

/// Aliases of one wave-number component, the principal one first: k², W².
struct AxisAliases(Vec<[f64; 2]>);

impl AxisAliases {
    fn new(phase: f64, window: &Window) -> Self {
        let aliases = std::iter::once(0).chain((1..=ALIASES).flat_map(|m| [m, -m]));
        let of = |m: i32| {
            let k = phase + 2.0 * PI * f64::from(m);
            [k * k, window.transform(k).powi(2)]
        };
        Self(aliases.map(of).collect())
    }
}

/// The bracket of Q, arranged so that nothing cancels: the principal alias is split off every sum, its own
/// terms add up to zero.
fn zone_integrand(cloud: Cloud, axis: [&AxisAliases; 3]) -> f64 {
    let (mut windows, mut squares, mut crossed, mut aliased) = (0.0, 0.0, 0.0, 0.0);
    let (mut window0, mut k0, mut r0) = (0.0, 0.0, 0.0);
    for (i, a) in axis[0].0.iter().enumerate() {
        for (j, b) in axis[1].0.iter().enumerate() {
            for (l, c) in axis[2].0.iter().enumerate() {
                let wave_squared = a[0] + b[0] + c[0];
                let window = a[1] * b[1] * c[1];
                let reference = 4.0 * PI * cloud.spectrum(wave_squared) / wave_squared;
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
    let influence = r0 / window0;
    let doubled = window0 * squares + windows * (window0 * k0 + squares);
    aliased - 2.0 * influence * crossed + influence * influence * doubled
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::grid::shapes;

    #[test]
    fn errors_fall_with_cutoff_and_order() {
        let error = |order, ratio| error_squared(order, ratio, shapes::best(order, ratio));
        assert!(error(5, 3.0) < 0.1 * error(5, 2.0));
        assert!(error(8, 4.0) < 0.1 * error(5, 4.0));
    }
}
