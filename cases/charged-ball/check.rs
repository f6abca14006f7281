//! Case of a ball of uniform charge in free space.

use crate::support::{COULOMB, Case};
use amberfield_core::Vector3;
use amberfield_oracle::{ChargedBall, ErrorNorms, field_scale, open_sum};

const RADIUS_M: f64 = 0.01;
const EDGE_M: f64 = 0.025;
/// Tolerance of the scene.
const TOLERANCE: f64 = 1e-3;
/// Error because 1500 points replace a continuum: the slope of the plain pair sum is 1.5 % lower.
const DISCRETE: f64 = 0.02;

#[test]
fn slope_is_that_of_a_uniform_ball() {
    let case = Case::new("charged-ball");
    let points = case.table("points.csv");
    let (positions, charges) = (points.positions(), points.column("charge_C").to_vec());
    let fields = case.field(&[]).field();

    let centre = Vector3::repeat(0.5 * EDGE_M);
    let (mut outwards, mut squares) = (0.0, 0.0);
    for (position, field) in positions.iter().zip(&fields) {
        outwards += field.dot(&(position - centre));
        squares += (position - centre).norm_squared();
    }
    let ball = ChargedBall { coulomb_constant: COULOMB, charge: charges.iter().sum(), radius: RADIUS_M };
    let expected = ball.field(Vector3::x() * RADIUS_M).x / RADIUS_M;
    let slope = outwards / squares;
    assert!((slope / expected - 1.0).abs() < DISCRETE, "slope {slope:e}, expected {expected:e} V/m²");

    let exact: Vec<_> =
        (0..positions.len()).map(|at| open_sum(COULOMB, &positions, &charges, at).e).collect();
    let scale = field_scale(&exact, &charges, EDGE_M.powi(3), COULOMB);
    let norms = ErrorNorms::new(&fields, &exact, scale);
    assert!(norms.relative_rms <= TOLERANCE, "{norms:?}");
}
