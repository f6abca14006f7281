//! The best shapes of cloud and window for an order and a cut-off, and the error that they leave.
//!
//! They minimise the error of `crate::choosing::error_model` over both shapes (an independent program's
//! simplex search, rounded; near a minimum a few per cent change nothing). A test looks for better ones
//! around them.

use std::ops::RangeInclusive;

/// Orders of the windows.
pub(crate) const ORDERS: RangeInclusive<usize> = 4..=8;

/// Cut-off radii over node spacings for which shapes are tabulated: below, the model is no longer a model;
/// above, more cut-off buys too little.
const RATIOS: [f64; NODES] = [
    1.0, 1.25, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.0, 8.0, 10.0, 14.0, 20.0,
    28.0,
];
const NODES: usize = 20;

/// Cloud, window and error √Q, by order and ratio.
#[rustfmt::skip]
const BEST: [[[f64; 3]; NODES]; 5] = [
    [[3.16, 4.41, 3.704e-1], [3.95, 4.60, 1.843e-1], [4.63, 4.90, 9.863e-2], [5.19, 5.32, 5.654e-2],
     [5.69, 5.77, 3.413e-2], [6.17, 6.14, 2.196e-2], [6.61, 6.42, 1.535e-2], [6.93, 6.66, 1.149e-2],
     [7.16, 6.88, 8.957e-3], [7.58, 7.21, 6.062e-3], [7.84, 7.48, 4.539e-3], [8.06, 7.69, 3.652e-3],
     [8.19, 7.87, 3.061e-3], [8.36, 8.15, 2.331e-3], [8.46, 8.33, 1.873e-3], [8.53, 8.45, 1.551e-3],
     [7.72, 8.65, 1.115e-3], [7.04, 8.78, 6.672e-4], [6.41, 8.84, 3.897e-4], [5.81, 8.87, 2.403e-4]],
    [[3.20, 5.94, 3.431e-1], [4.05, 5.99, 1.574e-1], [4.83, 6.06, 7.397e-2], [5.58, 6.21, 3.638e-2],
     [6.26, 6.50, 1.918e-2], [6.84, 6.97, 1.072e-2], [7.37, 7.47, 6.197e-3], [7.90, 7.89, 3.782e-3],
     [8.39, 8.23, 2.493e-3], [9.06, 8.84, 1.280e-3], [9.61, 9.29, 7.657e-4], [9.98, 9.66, 5.112e-4],
     [10.31, 9.94, 3.722e-4], [10.75, 10.38, 2.302e-4], [11.05, 10.67, 1.616e-4], [11.28, 10.88, 1.230e-4],
     [11.42, 11.15, 8.653e-5], [10.77, 10.92, 5.983e-5], [10.09, 10.89, 3.723e-5], [9.52, 10.89, 2.383e-5]],
    [[3.22, 7.57, 3.373e-1], [4.07, 7.59, 1.518e-1], [4.88, 7.60, 6.864e-2], [5.67, 7.62, 3.130e-2],
     [6.45, 7.67, 1.461e-2], [7.21, 7.76, 7.165e-3], [7.90, 8.02, 3.792e-3], [8.45, 8.58, 2.104e-3],
     [9.00, 9.13, 1.180e-3], [10.10, 9.95, 4.369e-4], [10.87, 10.64, 2.021e-4], [11.53, 11.17, 1.094e-4],
     [12.01, 11.63, 6.699e-5], [12.74, 12.34, 3.236e-5], [13.24, 12.85, 1.890e-5], [13.63, 13.21, 1.252e-5],
     [14.15, 13.71, 7.170e-6], [14.13, 14.29, 3.689e-6], [13.81, 14.40, 2.293e-6], [13.22, 14.38, 1.479e-6]],
    [[3.22, 9.27, 3.363e-1], [4.07, 9.27, 1.507e-1], [4.89, 9.27, 6.763e-2], [5.69, 9.28, 3.034e-2],
     [6.48, 9.28, 1.367e-2], [7.28, 9.29, 6.208e-3], [8.07, 9.31, 2.871e-3], [8.84, 9.36, 1.391e-3],
     [9.57, 9.51, 7.428e-4], [10.61, 10.76, 2.306e-4], [11.77, 11.60, 8.013e-5], [12.63, 12.35, 3.447e-5],
     [13.36, 12.97, 1.736e-5], [14.39, 14.00, 6.153e-6], [15.13, 14.73, 2.835e-6], [15.71, 15.24, 1.584e-6],
     [16.49, 16.01, 7.192e-7], [17.13, 16.87, 2.878e-7], [16.98, 17.53, 1.485e-7], [16.73, 17.77, 9.221e-8]],
    [[3.22, 10.95, 3.360e-1], [4.08, 10.95, 1.505e-1], [4.89, 10.95, 6.742e-2], [5.69, 10.95, 3.016e-2],
     [6.49, 10.95, 1.350e-2], [7.29, 10.95, 6.056e-3], [8.09, 10.96, 2.717e-3], [8.89, 10.96, 1.223e-3],
     [9.68, 10.97, 5.580e-4], [11.25, 11.06, 1.419e-4], [12.20, 12.38, 4.565e-5], [13.43, 13.21, 1.516e-5],
     [14.32, 14.04, 6.210e-6], [15.75, 15.37, 1.555e-6], [16.78, 16.34, 5.536e-7], [17.65, 17.03, 2.543e-7],
     [18.58, 18.14, 8.787e-8], [19.78, 19.30, 2.530e-8], [20.10, 20.18, 9.885e-9], [19.89, 20.78, 5.667e-9]],
];

/// Shapes β of the cloud and of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shapes {
    pub(crate) cloud: f64,
    pub(crate) window: f64,
}

/// Shapes for a window of the given order and a cut-off radius of `ratio` node spacings.
pub(crate) fn best(order: usize, ratio: f64) -> Shapes {
    let table = &BEST[order - ORDERS.start()];
    let ratio = ratio.clamp(RATIOS[0], RATIOS[NODES - 1]);
    let above = RATIOS.partition_point(|&known| known < ratio).max(1);
    let way = (ratio - RATIOS[above - 1]) / (RATIOS[above] - RATIOS[above - 1]);
    let [cloud, window] = [0, 1].map(|i| table[above - 1][i] + way * (table[above][i] - table[above - 1][i]));
    Shapes { cloud, window }
}

/// Smallest r_c/h whose squared error Q with the best shapes is at most `bound`.
pub(crate) fn cutoff_over_spacing_for(order: usize, bound: f64) -> Option<f64> {
    let table = &BEST[order - ORDERS.start()];
    let bound = 0.5 * bound.ln();
    let above = table.iter().position(|[.., error]| error.ln() <= bound)?;
    if above == 0 {
        return Some(RATIOS[0]);
    }
    let ln = |i: usize| (RATIOS[i].ln(), table[i][2].ln());
    let ((x0, error0), (x1, error1)) = (ln(above - 1), ln(above));
    Some((x0 + (x1 - x0) * (error0 - bound) / (error0 - error1)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choosing::error_model::error_squared;

    /// Gain in error that another shape may have: the table is rounded and interpolated.
    const GAIN: f64 = 0.06;
    /// Fewer digits, and another quadrature.
    const AGREEMENT: f64 = 0.12;

    #[test]
    fn no_shapes_nearby_are_better() {
        for order in ORDERS {
            for ratio in [1.6, 2.2, 3.2, 4.2, 6.5] {
                let shapes = best(order, ratio);
                let here = error_squared(order, ratio, shapes).sqrt();
                for (cloud, window) in [(0.3, 0.0), (-0.3, 0.0), (0.0, 0.5), (0.0, -0.5), (0.3, 0.5)] {
                    let other = Shapes { cloud: shapes.cloud + cloud, window: shapes.window + window };
                    let there = error_squared(order, ratio, other).sqrt();
                    assert!(
                        there > (1.0 - GAIN) * here,
                        "{order} {ratio}: {there:e} for {here:e} at {other:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn tabulated_errors_are_the_models_and_are_inverted() {
        for order in ORDERS {
            let table = &BEST[order - ORDERS.start()];
            for (&ratio, [.., tabulated]) in RATIOS.iter().zip(table) {
                let model = error_squared(order, ratio, best(order, ratio)).sqrt();
                assert!((model / tabulated - 1.0).abs() < AGREEMENT, "{order} {ratio}: {model:e}");
                let found = cutoff_over_spacing_for(order, tabulated * tabulated).unwrap();
                assert!((found / ratio - 1.0).abs() < 1e-9, "{order} {ratio}: {found}");
            }
        }
        assert!(cutoff_over_spacing_for(8, 0.0).is_none());
    }
}
