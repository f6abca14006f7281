//! Error of forecast fields that impacts make: they turn grains, and the line through evaluations before them
//! goes on as if they did not.
//!
//! Two grains at a distance d that approach at w feel kq/d² of each other, so that their fields change by
//! 2kqw/d³ in time. After an impact they part about as fast. From then on the line errs by twice that,
//! times the time since. A wall that mirrors the grain's charge at a height h stands for a grain at 2h. The
//! squares of the errors of all impacts add up,
//!
//! ```text
//! δE²(s) = Σ r² (s − s₁)² = A s² − 2B s + C,
//! ```
//!
//! s₁ the step of an impact, r the change of its error per step. The next evaluation sees the whole error,
//! and puts 1 − s₁/S of what the slope lacks into the slope. The rest goes on through the next interval.

use super::FieldStage;
use crate::contacts::Contacts;
use crate::motion::grains::Grains;
use amberfield_core::{Axis, Domain, Side};
use serde::{Deserialize, Serialize};

/// Turn of the velocity of approach by an impact, over this velocity.
const TURN: f64 = 2.0;

/// Impacts since the last evaluation: sums over them, in squares of the forces [N²].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Impacts {
    /// Σ r².
    rates: f64,
    /// Σ r² s₁.
    first: f64,
    /// Σ r² s₁².
    second: f64,
}

impl Impacts {
    /// Adds an impact in step `s` after the evaluation, whose error grows by a rate per step.
    fn add(&mut self, rate: f64, s: f64) {
        let square = rate * rate;
        self.rates += square;
        self.first += square * s;
        self.second += square * s * s;
    }

    /// Squared error in step `s` after the evaluation.
    pub(super) fn error2(&self, s: f64) -> f64 {
        (self.rates * s - 2.0 * self.first) * s + self.second
    }

    /// Goes on after an evaluation, `age` steps after the last one.
    pub(super) fn evaluated(&mut self, age: u64) {
        let rates = if age > 0 { self.second / (age as f64).powi(2) } else { 0.0 };
        *self = Self { rates, ..Self::default() };
    }
}

impl FieldStage {
    /// Books the impacts that began in this step, of a length `step` [s].
    pub(crate) fn book_impacts(&mut self, domain: &Domain, grains: &Grains, contacts: &Contacts, step: f64) {
        if !self.is_automatic() {
            return;
        }
        let (k, s) = (self.settings.permittivity.coulomb(), self.control.age as f64 + 1.0);
        let charge = |grain: usize| self.forecast.charge(grain);
        let Contacts { neighbours, walls, .. } = contacts;
        for pair in neighbours.met() {
            let offset = pair.offset(grains, &neighbours.shifts);
            let distance = offset.norm();
            let speed = (grains.velocity[pair.i] - grains.velocity[pair.j]).dot(&offset) / distance;
            let gradient = 2.0 * k * charge(pair.i) * charge(pair.j) / distance.powi(3);
            // Both grains feel it.
            self.impacts.add(std::f64::consts::SQRT_2 * TURN * gradient * speed * step, s);
        }
        for met in walls.iter().flat_map(|walls| walls.met()) {
            let speed = grains.velocity[met.grain].dot(&met.normal);
            let radius = grains.centre[met.grain][3];
            let height = if met.bounds_field { radius } else { height(domain, grains, met.grain) };
            let gradient = 0.5 * k * charge(met.grain).powi(2) / height.powi(3);
            self.impacts.add(TURN * gradient * speed * step, s);
        }
    }

    /// Whether impacts since the last evaluation make the forecasts err so much that E is due.
    pub(crate) fn impacts_are_due(&self) -> bool {
        let error2 = self.impacts.error2(self.control.age as f64);
        self.is_automatic() && error2 > self.settings.tolerance.powi(2) * self.forecast.squared_forces()
    }
}

/// Distance of a grain's centre from the nearest face that mirrors its charge, at least a radius [m].
fn height(domain: &Domain, grains: &Grains, grain: usize) -> f64 {
    let place = grains.position(grain);
    let of_face = |(axis, side): (Axis, Side)| {
        let face = domain.face(axis, side);
        let n = axis.index();
        let height = match side {
            Side::Min => place[n] - domain.min()[n],
            Side::Max => domain.max()[n] - place[n],
        };
        if face.is_conductor() || face.is_insulating() { height } else { f64::INFINITY }
    };
    let faces = Axis::ALL.into_iter().flat_map(|axis| [(axis, Side::Min), (axis, Side::Max)]);
    faces.map(of_face).fold(f64::INFINITY, f64::min).max(grains.centre[grain][3])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_the_error_of_lines_through_values_that_turn() {
        // Values of three grains go along lines that turn in some step: a turn of the slope, and the step.
        let turns = [(0.3, 2.0), (-0.1, 7.0), (0.2, 9.0)];
        let value = |(turn, at): (f64, f64), s: f64| 0.5 * s + turn * (s - at).max(0.0);
        let mut impacts = Impacts::default();
        turns.iter().for_each(|&(turn, at)| impacts.add(turn, at));
        let error2 = |line: &dyn Fn((f64, f64), f64) -> f64, s: f64| {
            turns.iter().map(|&grain| (value(grain, s) - line(grain, s)).powi(2)).sum::<f64>()
        };
        let before = |_: (f64, f64), s: f64| 0.5 * s;
        assert!((impacts.error2(10.0) - error2(&before, 10.0)).abs() < 1e-12);
        // The next line goes through the values in steps 0 and 10.
        let after = |grain: (f64, f64), s: f64| value(grain, 10.0) * s / 10.0;
        impacts.evaluated(10);
        assert!((impacts.error2(6.0) - error2(&after, 16.0)).abs() < 1e-12);
    }
}
