//! What a contact remembers of its charging.

use serde::{Deserialize, Serialize};

/// Contact area and what of its growth has not moved charge yet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Growth {
    /// Area at the last step at which it touched, or the largest since first touch [m²].
    area: f64,
    /// Growth that has not moved charge yet [m²].
    due: f64,
    /// E_x·n at the last evaluation of the field [V/m], if it is `foreseen`.
    field: f64,
    /// Step at which it touched last, its lower bits.
    step: u32,
    foreseen: bool,
}

impl Growth {
    /// Takes the area [m²] at a step; of what grows, only what exceeds the largest area so far counts if `beyond`. Whether
    /// the contact begins, and whether this is the first growth that is due.
    #[inline(always)]
    pub(crate) fn follow(&mut self, area: f64, step: u64, beyond: bool) -> [bool; 2] {
        #[expect(
            clippy::cast_possible_truncation,
            reason = "two steps in a row differ by one in the lower bits too"
        )]
        let now = step as u32;
        let touched = now.wrapping_sub(self.step) <= 1;
        let before = if touched { self.area } else { 0.0 };
        let first = self.due == 0.0;
        // What touches at the start has its area from before the run.
        if step > 0 {
            self.due += (area - before).max(0.0);
        }
        self.area = if beyond { area.max(before) } else { area };
        self.step = now;
        [before == 0.0 && area > 0.0, first && self.due > 0.0]
    }

    /// The same for the partner's list (sign −1), whose normal points the other way.
    pub(crate) fn seen_from(self, sign: f64) -> Self {
        Self { field: sign * self.field, ..self }
    }

    /// E_x·n at the last evaluation of the field [V/m]; `None`: the contact was not foreseen there.
    pub(crate) fn field(&self) -> Option<f64> {
        self.foreseen.then_some(self.field)
    }

    /// Takes E_x·n [V/m] of an evaluation.
    pub(crate) fn foresee(&mut self, field: f64) {
        (self.field, self.foreseen) = (field, true);
    }

    /// Growth that has not moved charge yet [m²].
    pub(crate) fn due(&self) -> f64 {
        self.due
    }

    /// The same, which from now on has.
    pub(crate) fn take_due(&mut self) -> f64 {
        std::mem::take(&mut self.due)
    }
}

/// A pair of a list whose growth is due.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Grown {
    pub(crate) entry: u32,
    /// Grain in the chunk.
    pub(crate) local: u32,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn due_after(areas: &[f64], beyond: bool) -> f64 {
        let mut growth = Growth::default();
        for (step, &area) in areas.iter().enumerate() {
            growth.follow(area, step as u64, beyond);
        }
        growth.due()
    }

    #[test]
    fn only_growth_counts_and_beyond_the_maximum_once() {
        let rocking = [0.0, 1.0, 3.0, 2.0, 3.0, 2.0, 4.0];
        assert_eq!(due_after(&rocking, false), 6.0);
        assert_eq!(due_after(&rocking, true), 4.0);
        assert_eq!(due_after(&[2.0, 1.0, 1.5], false), 0.5);
    }

    #[test]
    fn separated_contact_begins_anew() {
        let mut growth = Growth::default();
        assert_eq!(growth.follow(2.0, 5, true), [true, true]);
        assert_eq!(growth.follow(3.0, 6, true), [false, false]);
        assert_eq!(growth.take_due(), 3.0);
        // It did not touch in steps 7 to 9.
        assert_eq!(growth.follow(1.0, 10, true), [true, true]);
        assert_eq!(growth.due(), 1.0);
    }
}
