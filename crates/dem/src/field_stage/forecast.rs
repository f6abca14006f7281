//! E at the grains between two evaluations: on the straight line through the last two,
//!
//! E(s) = E₀ + s (E₀ − E₋₁)/S,
//!
//! s steps after the last evaluation, which came S steps after the one before it. Why not impulses or a field
//! that is held: `docs/decisions/several-rates.md`.

use super::interval::Check;
use amberfield_core::Vector3;
use serde::{Deserialize, Serialize};

/// Slot of a grain that neither makes nor feels the field.
pub(crate) const NO_SLOT: u32 = u32::MAX;

/// E and its change, by slots: the members in the order of the last evaluation.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Forecast {
    /// Slot of each grain, sorted order.
    pub(crate) slot: Vec<u32>,
    /// E at the last evaluation [V/m].
    e: Vec<Vector3<f64>>,
    /// Its change per step [V/m].
    slope: Vec<Vector3<f64>>,
    /// Memory of the next evaluation.
    #[serde(skip)]
    spare: (Vec<u32>, Vec<Vector3<f64>>),
}

impl Forecast {
    /// E [V/m] of a slot, `age` steps after the last evaluation.
    #[inline(always)]
    pub(crate) fn at(&self, slot: usize, age: f64) -> Vector3<f64> {
        self.e[slot] + self.slope[slot] * age
    }

    /// Whether it is one of `count` grains and `slots` slots.
    pub(crate) fn fits(&self, count: usize, slots: usize) -> bool {
        let known = |slot: &u32| *slot == NO_SLOT || (*slot as usize) < slots;
        let lengths = [self.e.len(), self.slope.len()];
        self.slot.len() == count && lengths == [slots; 2] && self.slot.iter().all(known)
    }

    /// Moves the slots along with grains that are reordered to `order[new] = old`.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        // Nothing is known before the first evaluation.
        if !self.slot.is_empty() {
            crate::grains::pick(&mut self.slot, order, &mut self.spare.0);
        }
    }

    /// Takes a fresh E of the members, whose sorted indices among `count` grains are `index`, `age` steps after
    /// the last evaluation. The difference from what was forecast, over `scale` [V/m]; `None` the first time
    /// and when no step was taken.
    pub(crate) fn renew(
        &mut self,
        index: &[u32],
        count: usize,
        fresh: &[Vector3<f64>],
        age: u64,
        scale: f64,
    ) -> Option<Check> {
        let known = !self.slot.is_empty() && age > 0;
        let age = age as f64;
        let (mut squares, mut largest2) = (0.0, 0.0_f64);
        let mut slope = std::mem::take(&mut self.spare.1);
        slope.clear();
        slope.extend(index.iter().zip(fresh).map(|(&i, fresh)| {
            if !known {
                return Vector3::zeros();
            }
            let slot = self.slot[i as usize] as usize;
            let error2 = (fresh - self.at(slot, age)).norm_squared();
            squares += error2;
            largest2 = largest2.max(error2);
            (fresh - self.e[slot]) / age
        }));
        self.spare.1 = std::mem::replace(&mut self.slope, slope);
        self.e.clear();
        self.e.extend_from_slice(fresh);
        self.slot.clear();
        self.slot.resize(count, NO_SLOT);
        for (slot, &i) in index.iter().enumerate() {
            self.slot[i as usize] = slot as u32;
        }
        let over = |value: f64| if value == 0.0 { 0.0 } else { value / scale };
        let mean2 = squares / index.len().max(1) as f64;
        known.then(|| Check { rms: over(mean2.sqrt()), largest: over(largest2.sqrt()) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// E of grain g at a time in steps: a parabola of its own.
    fn parabola(grain: u32, time: f64) -> Vector3<f64> {
        let g = f64::from(grain);
        Vector3::new(1.0 + g, -g, 0.5)
            + Vector3::new(0.1, 0.2 * g, -0.3) * time
            + Vector3::x() * (g * time * time)
    }

    fn fresh(grains: &[u32], time: f64) -> Vec<Vector3<f64>> {
        grains.iter().map(|&g| parabola(g, time)).collect()
    }

    #[test]
    fn forecast_is_held_first_then_follows_the_line_and_is_checked() {
        let mut forecast = Forecast::default();
        // Grain 1 of 0…3 is no member.
        let members = [0_u32, 2, 3];
        assert_eq!(forecast.renew(&members, 4, &fresh(&members, 0.0), 0, 1.0), None);
        assert_eq!(forecast.at(1, 5.0), parabola(2, 0.0));
        let check = forecast.renew(&members, 4, &fresh(&members, 2.0), 2, 10.0).expect("steps were taken");
        let largest = (parabola(3, 2.0) - parabola(3, 0.0)).norm() / 10.0;
        assert!((check.largest - largest).abs() < 1e-15);
        // The line through times 0 and 2, three steps on, misses the parabola by g·3·5.
        assert!((forecast.at(2, 3.0) - parabola(3, 5.0) + Vector3::x() * 45.0).norm() < 1e-12);

        // The grains are sorted anew as 3, 2, 1, 0, and the last one leaves.
        forecast.reorder(&[3, 2, 1, 0]);
        forecast.reorder(&[0, 1, 2]);
        assert_eq!(forecast.slot, [2, 1, NO_SLOT]);
        let check = forecast.renew(&[0, 1], 3, &fresh(&[3, 2], 5.0), 3, 1.0).expect("steps were taken");
        assert!((check.rms - f64::sqrt((45.0 * 45.0 + 30.0 * 30.0) / 2.0)).abs() < 1e-12);
        assert!((forecast.at(0, 0.0) - parabola(3, 5.0)).norm() < 1e-12);
    }

    #[test]
    fn second_evaluation_at_the_same_time_starts_afresh() {
        let mut forecast = Forecast::default();
        forecast.renew(&[0], 1, &fresh(&[0], 0.0), 0, 1.0);
        assert_eq!(forecast.renew(&[0], 1, &fresh(&[1], 0.0), 0, 1.0), None);
        assert_eq!(forecast.at(0, 9.0), parabola(1, 0.0));
    }
}
