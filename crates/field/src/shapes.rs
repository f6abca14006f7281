//! The best shapes of cloud and window for an order and a cut-off.
//!
//! They minimise the error of `crate::error_model` over both shapes (simplex search with three aliases on either side,
//! rounded; near a minimum a few per cent change nothing). A test looks for better ones around them.

use crate::error_model::ORDERS;

/// Cut-off radii over node spacings for which shapes are tabulated.
const RATIOS: [f64; 13] = [1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 8.0, 10.0];

/// Cloud and window, by order and ratio.
#[rustfmt::skip]
const BEST: [[[f64; 2]; 13]; 5] = [
    [[3.22, 4.41], [4.01, 4.57], [4.69, 4.85], [5.23, 5.28], [5.69, 5.75], [6.64, 6.39], [7.17, 6.87],
     [7.61, 7.21], [7.87, 7.46], [8.28, 7.81], [8.49, 8.06], [8.55, 8.43], [8.91, 8.55]],
    [[3.26, 6.03], [4.11, 6.05], [4.92, 6.08], [5.71, 6.15], [6.43, 6.33], [7.34, 7.48], [8.42, 8.20],
     [9.08, 8.81], [9.68, 9.24], [10.41, 9.89], [10.82, 10.35], [11.58, 10.75], [11.81, 10.85]],
    [[3.26, 7.82], [4.12, 7.82], [4.94, 7.82], [5.76, 7.82], [6.59, 7.83], [8.21, 7.93], [8.94, 9.18],
     [10.14, 9.90], [10.88, 10.60], [12.02, 11.61], [12.81, 12.28], [13.51, 13.27], [14.43, 13.69]],
    [[3.26, 9.60], [4.12, 9.60], [4.95, 9.60], [5.77, 9.60], [6.59, 9.60], [8.26, 9.61], [9.94, 9.65],
     [10.54, 10.80], [11.80, 11.59], [13.37, 12.98], [14.42, 13.93], [15.69, 15.31], [17.15, 15.50]],
    [[3.26, 11.36], [4.12, 11.35], [4.95, 11.36], [5.77, 11.36], [6.59, 11.36], [8.26, 11.36], [9.96, 11.38],
     [11.64, 11.40], [12.42, 11.89], [14.52, 13.90], [15.91, 15.23], [17.86, 16.89], [18.53, 18.16]],
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
    let ratio = ratio.clamp(RATIOS[0], RATIOS[RATIOS.len() - 1]);
    let above = RATIOS.partition_point(|&known| known < ratio).max(1);
    let way = (ratio - RATIOS[above - 1]) / (RATIOS[above] - RATIOS[above - 1]);
    let [cloud, window] = [0, 1].map(|i| table[above - 1][i] + way * (table[above][i] - table[above - 1][i]));
    Shapes { cloud, window }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error_model::error_squared;

    /// What another shape may gain in error: the table is rounded and interpolated.
    const GAIN: f64 = 0.12;

    #[test]
    fn no_shapes_nearby_are_better() {
        for order in ORDERS {
            for ratio in [1.6, 2.2, 3.2, 4.5, 7.0] {
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
}
