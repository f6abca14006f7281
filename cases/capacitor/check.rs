//! Case of parallel plates with a space charge.

use crate::support::Case;
use amberfield_core::constants::VACUUM_PERMITTIVITY;
use amberfield_oracle::ParallelPlates;

const PLATES: ParallelPlates = ParallelPlates {
    permittivity: VACUUM_PERMITTIVITY,
    gap: 0.01,
    lower_potential: 0.0,
    upper_potential: 5000.0,
    charge_density: 2e-13 / (5e-4 * 5e-4 * 5e-4),
};
/// Error because sheets of charges replace an even density, over the RMS field; see the README.
const DISCRETE: f64 = 5e-3;
/// Height at which the field vanishes [m].
const ZERO_M: f64 = 7.767e-3;
/// Uncertainty of that height because of the sheets [m].
const ZERO_TOLERANCE_M: f64 = 2e-5;

#[test]
fn field_between_the_plates_is_a_straight_line() {
    let case = Case::new("capacitor");
    let heights = case.table("grains.csv").column("z_m").to_vec();
    let fields = case.field(&[]).field();
    let (mut error, mut size) = (0.0, 0.0);
    let (mut mean_height, mut mean_field) = (0.0, 0.0);
    let count = heights.len() as f64;
    for (height, field) in heights.iter().zip(&fields) {
        let exact = PLATES.field(*height);
        error += (field.z - exact).powi(2) + field.xy().norm_squared();
        size += exact * exact;
        mean_height += height / count;
        mean_field += field.z / count;
    }
    assert!((error / size).sqrt() < DISCRETE, "relative error {:e}", (error / size).sqrt());

    let (mut covariance, mut variance) = (0.0, 0.0);
    for (height, field) in heights.iter().zip(&fields) {
        covariance += (height - mean_height) * (field.z - mean_field);
        variance += (height - mean_height).powi(2);
    }
    let zero = mean_height - mean_field * variance / covariance;
    assert!((zero - ZERO_M).abs() < ZERO_TOLERANCE_M, "zero at {zero} m");
}
