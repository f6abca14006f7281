//! Case of grains in a grounded hollow sphere: their field against Kelvin's images, and their places at the
//! end.

use crate::support::{COULOMB, Case};
use amberfield_oracle::{ErrorNorms, grounded_cavity, rms};

const RADIUS_M: f64 = 6e-3;
const GRAIN_M: f64 = 2e-4;
/// Largest allowed RMS error, over the RMS field.
const MOST: f64 = 1.5e-2;

#[test]
fn field_is_that_of_the_images_and_the_grains_coat_the_wall() {
    let case = Case::new("grounded-sphere");
    let grains = case.table("grains.csv");
    let exact = grounded_cavity(COULOMB, RADIUS_M, &grains.positions(), grains.column("charge_C"));
    let norms = ErrorNorms::new(&case.field(&[]).field(), &exact, rms(&exact));
    assert!(norms.relative_rms < MOST, "{norms:?}");

    let end = case.run(&[]).last_particles().positions();
    assert_eq!(end.len(), exact.len());
    let touching = end.iter().filter(|place| place.norm() > RADIUS_M - 3.0 * GRAIN_M).count();
    assert!(2 * touching > end.len(), "{touching} grains at the wall");
    let farthest = end.iter().map(|place| place.norm()).fold(0.0, f64::max);
    assert!(farthest < RADIUS_M - 0.9 * GRAIN_M, "{farthest:e} m");
}
