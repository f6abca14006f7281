//! Norms of the error of a computed field, and observed orders of convergence.

use nalgebra::Vector3;

/// Root of the mean squared length, in the unit of the vectors; 0 for an empty slice.
#[must_use]
pub fn rms(vectors: &[Vector3<f64>]) -> f64 {
    mean_root(vectors.iter().map(Vector3::norm_squared), vectors.len())
}

/// Root of the mean squared length of the differences, in the unit of the vectors; 0 for empty slices.
#[must_use]
pub fn rms_difference(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    mean_root(a.iter().zip(b).map(|(a, b)| (a - b).norm_squared()), a.len())
}

/// Root of the mean square, in the unit of the values; 0 for an empty slice.
#[must_use]
pub fn rms_scalar(values: &[f64]) -> f64 {
    mean_root(values.iter().map(|value| value * value), values.len())
}

fn mean_root(squares: impl Iterator<Item = f64>, count: usize) -> f64 {
    if count == 0 { 0.0 } else { (squares.sum::<f64>() / count as f64).sqrt() }
}

/// Scale to which a tolerance refers: max(E_rms, q_rms n^{2/3}/(4πε)) [V/m].
///
/// The second term keeps the scale positive where symmetry makes every field vanish, as in rock salt.
/// `volume` is the domain's volume [m³], n = N/volume, `coulomb_constant` 1/(4πε) [V·m/C].
#[must_use]
pub fn field_scale(exact: &[Vector3<f64>], charges: &[f64], volume: f64, coulomb_constant: f64) -> f64 {
    let density = charges.len() as f64 / volume;
    rms(exact).max(rms_scalar(charges) * density.powf(2.0 / 3.0) * coulomb_constant)
}

/// Errors of a vector field at a set of particles, each relative to one scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ErrorNorms {
    /// Root mean square of |ΔE|, over the scale.
    pub relative_rms: f64,
    /// 99th percentile of |ΔE|, over the scale.
    pub p99: f64,
    /// Largest |ΔE|, over the scale.
    pub worst: f64,
    /// Index of the particle with the largest error.
    pub worst_index: usize,
}

impl ErrorNorms {
    /// Compares a computed field with the exact one. A value that is not finite makes every norm infinite.
    ///
    /// # Panics
    /// When the slices differ in length or are empty.
    #[must_use]
    pub fn new(computed: &[Vector3<f64>], exact: &[Vector3<f64>], scale: f64) -> Self {
        assert_eq!(computed.len(), exact.len(), "computed and exact field have different lengths");
        assert!(!exact.is_empty(), "no particle to compare");
        let mut errors: Vec<(f64, usize)> = computed
            .iter()
            .zip(exact)
            .map(|(a, b)| (a - b).norm() / scale)
            .map(|error| if error.is_finite() { error } else { f64::INFINITY })
            .zip(0..)
            .collect();
        let relative_rms = mean_root(errors.iter().map(|(error, _)| error * error), errors.len());
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let rank = ((errors.len() as f64 * 0.99).ceil() as usize).clamp(1, errors.len()) - 1;
        let (worst, worst_index) = errors[errors.len() - 1];
        Self { relative_rms, p99: errors[rank].0, worst, worst_index }
    }
}

/// Order p of error = C hᵖ: slope of a least-squares line through (log h, log error).
///
/// # Panics
/// With fewer than two points, or values that are not positive.
///
/// ```
/// let order = amberfield_oracle::observed_order(&[0.1, 0.05], &[4e-2, 1e-2]);
/// assert!((order - 2.0).abs() < 1e-12);
/// ```
#[must_use]
pub fn observed_order(spacings: &[f64], errors: &[f64]) -> f64 {
    assert_eq!(spacings.len(), errors.len(), "one error for each spacing");
    assert!(spacings.len() >= 2, "an order needs two spacings");
    assert!(spacings.iter().chain(errors).all(|&value| value > 0.0), "spacings and errors must be positive");
    let count = spacings.len() as f64;
    let mean = |values: &[f64]| values.iter().map(|value| value.ln()).sum::<f64>() / count;
    let (mean_spacing, mean_error) = (mean(spacings), mean(errors));
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (spacing, error) in spacings.iter().zip(errors) {
        let offset = spacing.ln() - mean_spacing;
        covariance += offset * (error.ln() - mean_error);
        variance += offset * offset;
    }
    covariance / variance
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_fields_have_no_error() {
        let field = vec![Vector3::new(1.0, 2.0, 2.0); 4];
        let norms = ErrorNorms::new(&field, &field, rms(&field));
        assert_eq!((norms.relative_rms, norms.p99, norms.worst), (0.0, 0.0, 0.0));
        assert_eq!(rms(&field), 3.0);
    }

    #[test]
    fn percentile_ignores_a_single_outlier_among_many() {
        let exact = vec![Vector3::x(); 200];
        let mut computed = exact.clone();
        computed[17].y = 0.5;
        let norms = ErrorNorms::new(&computed, &exact, 1.0);
        assert_eq!((norms.p99, norms.worst, norms.worst_index), (0.0, 0.5, 17));
    }

    #[test]
    fn a_value_that_is_not_finite_is_never_accurate() {
        let exact = [Vector3::x(), Vector3::y()];
        let computed = [Vector3::x(), Vector3::repeat(f64::NAN)];
        assert_eq!(ErrorNorms::new(&computed, &exact, 1.0).relative_rms, f64::INFINITY);
    }

    #[test]
    fn scale_stays_positive_where_the_field_vanishes() {
        let scale = field_scale(&[Vector3::zeros(); 64], &[2.0; 64], 8.0, 3.0);
        let expected = 2.0 * 8.0_f64.powf(2.0 / 3.0) * 3.0;
        assert!((scale - expected).abs() < 1e-12 * expected);
    }
}
