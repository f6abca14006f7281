//! Places whose clouds are felt in a part of a domain.

use crate::levels::copies::shifts;
use amberfield_core::{Axis, Boundary, Domain};
use nalgebra::Vector3;

/// Extents that differ by less, relatively, are one period.
const SAME: f64 = 1e-9;

/// Part of a domain, and the margin around it from which clouds reach into it.
#[derive(Debug)]
pub struct CloudReach {
    /// Whole domain, which says what is periodic.
    whole: Domain,
    /// The part with its margin, as one period of a grid.
    padded: Domain,
    /// Shifts to the copies that may lie in it, none included [m].
    shifts: Vec<Vector3<f64>>,
}

impl CloudReach {
    /// Reach of clouds of a radius [m] into the part of a domain from `low` to `high` [m]; its periodic axes
    /// count.
    #[must_use]
    pub fn new(whole: &Domain, low: Vector3<f64>, high: Vector3<f64>, radius_m: f64) -> Self {
        let spans = |axis: Axis| {
            let length = whole.extent()[axis.index()];
            whole.is_periodic(axis) && high[axis.index()] - low[axis.index()] >= length * (1.0 - SAME)
        };
        let spans = Axis::ALL.map(spans);
        let end = |axis: usize, given: f64, margin: f64, whole: f64| {
            if spans[axis] { whole } else { given + margin }
        };
        let min = Vector3::from_fn(|axis, _| end(axis, low[axis], -radius_m, whole.min()[axis]));
        let max = Vector3::from_fn(|axis, _| end(axis, high[axis], radius_m, whole.max()[axis]));
        let padded = Domain::new(min, max, [[Boundary::Periodic; 2]; 3]).expect("a radius is positive");
        let shifts = shifts(whole, Axis::ALL.map(|axis| whole.is_periodic(axis) && !spans[axis.index()]));
        Self { whole: whole.clone(), padded, shifts }
    }

    /// The part with its margin, as one period of a grid.
    pub(super) fn padded(&self) -> &Domain {
        &self.padded
    }

    /// Copies of a place whose clouds reach the part [m].
    pub(super) fn copies(&self, place: Vector3<f64>) -> impl Iterator<Item = Vector3<f64>> {
        let place = self.whole.wrap(place);
        self.shifts.iter().map(move |by| place + by).filter(|moved| self.padded.contains(moved))
    }

    /// Whether the cloud at a place [m] reaches the part.
    #[must_use]
    pub fn has(&self, place: Vector3<f64>) -> bool {
        self.copies(place).next().is_some()
    }
}
