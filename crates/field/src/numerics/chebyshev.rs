//! Polynomials that stand for smooth functions.

use std::f64::consts::PI;

/// The first `count` Chebyshev coefficients of a function smooth on [−1, 1], from as many samples.
pub(crate) fn chebyshev(function: impl Fn(f64) -> f64, count: usize) -> Vec<f64> {
    let angle = |node: usize| PI * (node as f64 + 0.5) / count as f64;
    let samples: Vec<f64> = (0..count).map(|node| function(angle(node).cos())).collect();
    let coefficient = |degree: usize| {
        let sum: f64 =
            samples.iter().enumerate().map(|(node, value)| value * (degree as f64 * angle(node)).cos()).sum();
        sum * if degree == 0 { 1.0 } else { 2.0 } / count as f64
    };
    (0..count).map(coefficient).collect()
}

/// Power-series coefficients of a Chebyshev series.
pub(crate) fn monomials(series: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; series.len()];
    let (mut before, mut current) = (vec![0.0; series.len()], vec![0.0; series.len()]);
    before[0] = 1.0;
    if series.len() > 1 {
        current[1] = 1.0;
    }
    for (degree, coefficient) in series.iter().enumerate() {
        let polynomial = if degree == 0 { &before } else { &current };
        for (sum, term) in result.iter_mut().zip(polynomial) {
            *sum += coefficient * term;
        }
        if degree > 0 {
            let mut next: Vec<f64> = before.iter().map(|term| -term).collect();
            for power in 1..series.len() {
                next[power] += 2.0 * current[power - 1];
            }
            before = std::mem::replace(&mut current, next);
        }
    }
    result
}
