//! Ranges in which numbers must lie.

use std::fmt;

/// Interval of numbers.
#[derive(Clone, Copy, Debug)]
pub struct Range {
    low: f64,
    low_included: bool,
    high: f64,
}

impl Range {
    /// Interval from `low` to `high`, both included.
    pub(crate) const fn closed(low: f64, high: f64) -> Self {
        Self { low, low_included: true, high }
    }

    /// Interval above 0, up to and including `high`.
    pub(crate) const fn positive(high: f64) -> Self {
        Self { low: 0.0, low_included: false, high }
    }

    /// Lower end, whether it is included, and upper end, which is.
    pub(crate) fn ends(&self) -> (f64, bool, f64) {
        (self.low, self.low_included, self.high)
    }

    /// Tells whether a number lies in the range; NaN never does.
    pub(crate) fn contains(&self, number: f64) -> bool {
        (number > self.low || (self.low_included && number == self.low)) && number <= self.high
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let show = |number: f64| {
            if (1e-3..1e5).contains(&number.abs()) || number == 0.0 {
                format!("{number}")
            } else {
                format!("{number:e}")
            }
        };
        let (low, high) = (show(self.low), show(self.high));
        if self.low_included {
            write!(f, "from {low} to {high}")
        } else {
            write!(f, "above {low} and at most {high}")
        }
    }
}
