//! Green function of the seven-point Laplacian on an unbounded grid.
//!
//! −∇²_h g = δ (1 in one cell, 0 in all others) has g(n) = ∫₀^∞ dt Π_a e^{−2t/h_a²} I_{n_a}(2t/h_a²).

use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Step in ln t. The integrand is analytic for |arg t| < π/2: the trapezoid errs by e^{−π²/0.3} = 5e-15.
const STEP: f64 = 0.3;
/// The integral starts where t is this small beside the smallest h².
const START: f64 = 1e-17;
/// Largest t of the integral beside the largest distance²: its integrand falls as t^{−1/2} per step.
const END: f64 = 1e28;

/// g [m²] for distances of 0 to `most` cells along each axis, the last axis running fastest.
pub(super) fn green_function(most: [usize; 3], spacing: Vector3<f64>) -> Vec<f64> {
    let largest = (0..3).map(|a| spacing[a] * (most[a] + 1) as f64).fold(0.0, f64::max);
    let first = (START * spacing.min().powi(2)).ln();
    let last = (END * largest * largest).ln();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "some hundreds")]
    let count = ((last - first) / STEP).ceil() as usize;
    let nodes: Vec<[Vec<f64>; 3]> = (0..=count)
        .map(|node| {
            let t = (first + node as f64 * STEP).exp();
            let mut axes = [0, 1, 2].map(|a| scaled_bessel(2.0 * t / spacing[a].powi(2), most[a]));
            axes[0].iter_mut().for_each(|value| *value *= t * STEP);
            axes
        })
        .collect();
    let [_, rows, row] = most.map(|cells| cells + 1);
    let mut green = vec![0.0; (most[0] + 1) * rows * row];
    green.par_chunks_mut(rows * row).enumerate().for_each(|(i, plane)| {
        for [x, y, z] in &nodes {
            for (line, y) in plane.chunks_mut(row).zip(y) {
                let factor = x[i] * y;
                for (value, z) in line.iter_mut().zip(z) {
                    *value += factor * z;
                }
            }
        }
    });
    green
}

/// e^{−z} I_l(z) for l = 0 to `most`.
fn scaled_bessel(z: f64, most: usize) -> Vec<f64> {
    if z < 1e-3 {
        return small_argument(z, most);
    }
    if z > (most * most).max(1000) as f64 {
        return (0..=most).map(|order| large_argument(z, order)).collect();
    }
    backward_recurrence(z, most)
}

/// Power series.
fn small_argument(z: f64, most: usize) -> Vec<f64> {
    let quarter = 0.25 * z * z;
    let mut leading = (-z).exp();
    (0..=most)
        .map(|order| {
            let next = order as f64 + 1.0;
            let value = leading * (1.0 + quarter / next * (1.0 + quarter / (2.0 * (next + 1.0))));
            leading *= 0.5 * z / next;
            value
        })
        .collect()
}

/// Hankel's series; its terms fall at least as (l²/2z)^k/k! while k is below z.
fn large_argument(z: f64, order: usize) -> f64 {
    let square = 4.0 * (order * order) as f64;
    let (mut sum, mut term) = (1.0, 1.0);
    for k in 1..60 {
        let odd = f64::from(2 * k - 1);
        term *= -(square - odd * odd) / (8.0 * z * f64::from(k));
        sum += term;
        if term.abs() < 1e-18 {
            break;
        }
    }
    sum / (2.0 * PI * z).sqrt()
}

/// Miller's recurrence I_{l−1} = I_{l+1} + (2l/z) I_l from an order at which I is negligible, scaled by
/// I₀ + 2ΣI_l = e^z.
fn backward_recurrence(z: f64, most: usize) -> Vec<f64> {
    const LARGE: f64 = 1e200;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a few times `most`")]
    let start = most + 40 + (80.0 * z).sqrt() as usize;
    let mut values = vec![0.0; most + 1];
    let (mut above, mut value, mut sum) = (0.0, 1e-300, 0.0);
    for order in (0..=start).rev() {
        if value > LARGE {
            let shrink = 1.0 / LARGE;
            (above, value, sum) = (above * shrink, value * shrink, sum * shrink);
            values.iter_mut().for_each(|stored| *stored *= shrink);
        }
        if order <= most {
            values[order] = value;
        }
        sum += if order == 0 { value } else { 2.0 * value };
        (above, value) = (value, above + 2.0 * order as f64 / z * value);
    }
    values.iter_mut().for_each(|value| *value /= sum);
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bessel_functions_join_and_match_tables() {
        // Abramowitz & Stegun, tables 9.8 and 9.9.
        let at_one = scaled_bessel(1.0, 3);
        assert!((at_one[0] - 0.465_759_607_6).abs() < 1e-10 && (at_one[1] - 0.207_910_415_3).abs() < 1e-10);
        for (z, most) in [(1e-3, 6), (1000.0, 5), (10_000.0, 100)] {
            let ways = if z < 1.0 {
                small_argument(z, most)
            } else {
                (0..=most).map(|l| large_argument(z, l)).collect()
            };
            for (a, b) in backward_recurrence(z, most).into_iter().zip(ways) {
                assert!((a - b).abs() < 1e-13 * b.abs().max(1e-3), "z {z}: {a} {b}");
            }
        }
    }

    /// Watson's integral: g(0) h⁻² = 0.2527310098586630 for a cubic lattice; and the equation itself.
    #[test]
    fn green_function_solves_its_equation() {
        let spacing = Vector3::new(0.5, 0.5, 0.5);
        let cubic = green_function([0; 3], spacing);
        assert!((cubic[0] / 0.25 - 0.252_731_009_858_663).abs() < 1e-13, "{}", cubic[0]);
        let spacing = Vector3::new(1e-4, 1.3e-4, 0.8e-4);
        let green = green_function([4, 5, 6], spacing);
        let at = |i: i32, j: i32, k: i32| {
            green[((i.unsigned_abs() * 6 + j.unsigned_abs()) * 7 + k.unsigned_abs()) as usize]
        };
        for (i, j, k) in [(0, 0, 0), (1, 0, 0), (0, 2, 1), (3, 4, 5)] {
            let centre = 2.0 * at(i, j, k);
            let laplacian = (at(i + 1, j, k) + at(i - 1, j, k) - centre) / spacing.x.powi(2)
                + (at(i, j + 1, k) + at(i, j - 1, k) - centre) / spacing.y.powi(2)
                + (at(i, j, k + 1) + at(i, j, k - 1) - centre) / spacing.z.powi(2);
            let source = if (i, j, k) == (0, 0, 0) { 1.0 } else { 0.0 };
            assert!((laplacian + source).abs() < 1e-12, "{laplacian}");
        }
    }
}
