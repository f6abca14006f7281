//! Splittings by which errors are measured: one with the shapes that suit it, a second one that errs less,
//! and the particles that are looked at.

use crate::levels::grid::shapes::{self, ORDERS, Shapes};
use crate::methods::p3m_parameters::P3mParameters;

/// Grains in the sample on which the error is measured.
const SAMPLE: usize = 600;
/// Cut-off of the second splitting over the first's: some ten times more exact on the same nodes.
const SECOND_CUTOFF: f64 = 1.5;

/// Parameters with the shapes that suit them.
pub(crate) fn with_best_shapes(
    order: usize,
    cutoff_m: f64,
    spacing_m: f64,
    kernel_accuracy: f64,
) -> P3mParameters {
    let Shapes { cloud, window } = shapes::best(order, cutoff_m / spacing_m);
    P3mParameters {
        cutoff_m,
        cloud_shape: cloud,
        spacing_m,
        order,
        window_shape: window,
        kernel_accuracy,
        far: None,
    }
}

/// A second, wider and more exact splitting, to measure the error of a first one with.
pub(crate) fn second_splitting(first: P3mParameters) -> P3mParameters {
    let order = (first.order + 1).min(*ORDERS.end());
    let cutoff = SECOND_CUTOFF * first.cutoff_m;
    let second = with_best_shapes(order, cutoff, first.spacing_m, 0.1 * first.kernel_accuracy);
    P3mParameters { far: first.far, ..second }
}

/// Particles of so many on which an error is measured.
pub(crate) fn sample_of(particles: usize) -> Vec<usize> {
    (0..particles).step_by(sample_step(particles)).collect()
}

/// Distance in the list between two particles on which an error is measured.
pub(crate) fn sample_step(particles: usize) -> usize {
    particles.div_ceil(SAMPLE).max(1)
}
