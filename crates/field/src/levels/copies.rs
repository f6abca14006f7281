//! Copies of a place in the periods beside it.

use amberfield_core::{Axis, Domain};
use nalgebra::Vector3;

/// Shifts to the copies of a place in the periods before and after it along some axes, none included [m].
pub(super) fn shifts(domain: &Domain, along: [bool; 3]) -> Vec<Vector3<f64>> {
    let steps = |axis: Axis| if along[axis.index()] { -1..=1 } else { 0..=0 };
    let extent = domain.extent();
    let mut shifts = Vec::new();
    for x in steps(Axis::X) {
        for y in steps(Axis::Y) {
            for z in steps(Axis::Z) {
                let step = Vector3::new(f64::from(x), f64::from(y), f64::from(z));
                shifts.push(step.component_mul(&extent));
            }
        }
    }
    shifts
}
