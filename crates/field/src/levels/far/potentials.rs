//! Potentials of a mesh's patches that change with time, as the field solver knows them.
//!
//! The solver tells them at any time. It is asked before each solve, for the time of the field and ahead.
//! The part of E that a potential V makes is linear in V, and between two evaluations E is on the line
//! through the last two. V is thus taken as
//!
//! V(s) = V₀ + s (V₀ − V₋₁)/S,
//!
//! s steps after the last evaluation, which came S steps after the one before it. Since V is known ahead, so
//! is how long that line may be followed: until it misses V by [`MISSED`] of the range that V has in the time
//! to come, [`LEAST_PER_PERIOD`] times as long as the longest interval that may follow. A sine is then
//! evaluated 24 times in a period, and a line of a table is not followed far beyond its end.

use super::{FarField, FarMesh};
use crate::error::FieldError;
use amberfield_core::LEAST_PER_PERIOD;

/// Difference between a potential and the line that stands for it, over the potential's range, that ends an
/// interval.
const MISSED: f64 = 0.02;
/// Round-off of a potential, over its size.
const ROUND_OFF: f64 = 1e-12;
/// Difference over the range in a single step that a step does not show, as at the crest of a sine with fewer
/// than 20 steps in a period.
const UNSHOWN: f64 = 0.05;
/// Evaluations, less those that are well, of which steps that do not show a potential are told.
const MANY: u32 = 20;

/// Way to look ahead at potentials that change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    /// Steps since the evaluation before; 0: there is none, and potentials are held.
    pub before: u64,
    /// Length of a step [s].
    pub step_s: f64,
    /// Most steps until the next evaluation.
    pub most: u64,
}

/// Potentials of patches that change with time.
#[derive(Debug)]
pub(super) struct Potentials {
    /// Time of the field [s].
    pub(super) time_s: f64,
    look: Option<Look>,
    /// Steps for which the lines may be followed, of the last look.
    followed: Option<u64>,
    /// Evaluations of late in steps that do not show the potentials, less those in others.
    unshown: u32,
    /// Times that were asked for [s]: that of the field first.
    times: Vec<f64>,
    /// Potentials at these times [V], patch by patch.
    values: Vec<f64>,
}

impl Potentials {
    /// Potentials of a mesh; `None` where none changes.
    pub(super) fn new(mesh: &FarMesh) -> Option<Box<Self>> {
        let (times, values) = (Vec::new(), Vec::new());
        let none = Self { time_s: 0.0, look: None, followed: None, unshown: 0, times, values };
        (!mesh.changing().is_empty()).then(|| Box::new(none))
    }

    /// Looks ahead when the potentials are asked for next.
    pub(super) fn look_ahead(&mut self, look: Look) {
        (self.look, self.followed) = (Some(look), None);
    }

    /// Steps for which the lines may be followed, at least 1; `None` where nobody has looked.
    pub(super) fn followed(&self) -> Option<u64> {
        self.followed
    }

    /// Asks for the potentials at the time of the field, and at the times [s] of known answers.
    pub(super) fn ask(&mut self, solver: &mut dyn FarField, answers: &[f64]) -> Result<(), FieldError> {
        let now = self.time_s;
        self.times.clear();
        self.times.push(now);
        self.times.extend(answers);
        let first = self.times.len();
        let look = self.look.take();
        if let Some(Look { before, step_s, most }) = look {
            self.times.push(now - before as f64 * step_s);
            for stride in [1.0, LEAST_PER_PERIOD] {
                self.times.extend((1..=most).map(|step| now + stride * step as f64 * step_s));
            }
        }
        solver.potentials(&self.times, &mut self.values)?;

        let (times, patches) = (self.times.len(), solver.mesh().changing().len());
        if self.values.len() != times * patches {
            return Err(FieldError::Solver(format!(
                "the field solver gave {} potentials for {patches} patches at {times} times; look at its log",
                self.values.len()
            )));
        }
        for (values, &patch) in self.values.chunks(times).zip(solver.mesh().changing()) {
            if let Some(place) = values[..first].iter().position(|value| !value.is_finite()) {
                return Err(FieldError::Solver(format!(
                    "the potential of patch {} at t = {:e} s is {}; look at the field solver's log",
                    solver.mesh().patches()[patch as usize].name,
                    self.times[place],
                    values[place]
                )));
            }
        }
        if let Some(look) = look {
            self.see(first, look);
        }
        Ok(())
    }

    /// Takes what the last look has seen.
    fn see(&mut self, first: usize, look: Look) {
        let of_patch = |values: &[f64]| {
            let line = Line::new(values[0], &values[first..], look);
            [MISSED, UNSHOWN].map(|share| line.steps_within(share))
        };
        let lines = self.values.chunks(self.times.len()).map(of_patch);
        let [steps, shown] = lines.fold([look.most; 2], |[a, b], [c, d]| [a.min(c), b.min(d)]);
        self.followed = Some(steps.max(1));
        // Jumps are few; where each evaluation follows in the next step already, it is the steps.
        if self.unshown > MANY {
            return;
        }
        let unshown = look.before == 1 && shown == 0;
        self.unshown = if unshown { self.unshown + 1 } else { self.unshown.saturating_sub(1) };
        if self.unshown > MANY {
            tracing::warn!(
                "steps of {:e} s do not show the potentials of the case that change with time, at \
                 t = {:e} s; make time.step_s shorter",
                look.step_s,
                self.time_s
            );
        }
    }

    /// Adds the present potentials [V] to the values of the faces of their patches.
    pub(super) fn add(&self, mesh: &FarMesh, boundary: &mut [f64]) {
        self.add_by_patch(mesh, boundary, |values| values[0]);
    }

    /// Adds what a forecast of answers misses of the present potentials: V on the line through those at the
    /// two times that were asked for beside the present one, or V at the one, less V now.
    pub(super) fn add_forecast(&self, mesh: &FarMesh, answers: &[f64], boundary: &mut [f64]) {
        self.add_by_patch(mesh, boundary, |values| match *answers {
            [latest, earlier] if latest > earlier => {
                let ahead = (self.time_s - latest) / (latest - earlier);
                values[1] + ahead * (values[1] - values[2]) - values[0]
            }
            [_, ..] => values[1] - values[0],
            [] => 0.0,
        });
    }

    fn add_by_patch(&self, mesh: &FarMesh, boundary: &mut [f64], value: impl Fn(&[f64]) -> f64) {
        let changing = mesh.changing();
        for (face, boundary) in mesh.boundary().iter().zip(boundary) {
            if let Some(place) = changing.iter().position(|patch| *patch == face.patch) {
                *boundary += value(&self.values[place * self.times.len()..]);
            }
        }
    }
}

/// Line through a potential now and before, and the potential to come.
struct Line<'a> {
    /// Potential now [V].
    now: f64,
    /// Change in a step [V].
    slope: f64,
    /// Potentials in the steps to come [V]; what is not known is no number.
    ahead: &'a [f64],
    /// Range of the potentials to come [V].
    range: f64,
    /// Error of potentials by round-off [V].
    round_off: f64,
}

impl<'a> Line<'a> {
    /// Line of a potential. `course` is that before, in the steps to come, and in these steps times
    /// [`LEAST_PER_PERIOD`] [V].
    fn new(now: f64, course: &'a [f64], look: Look) -> Self {
        let (before, ahead) = (course[0], &course[1..]);
        let slope = if look.before > 0 { (now - before) / look.before as f64 } else { 0.0 };
        let low = ahead.iter().fold(now, |low, value| low.min(*value));
        let high = ahead.iter().fold(now, |high, value| high.max(*value));
        let round_off = ROUND_OFF * high.abs().max(low.abs());
        Self { now, slope, ahead: &ahead[..look.most as usize], range: high - low, round_off }
    }

    /// Steps for which it misses less than a share of the range.
    fn steps_within(&self, share: f64) -> u64 {
        let most = share * self.range + self.round_off;
        let holds = |(step, value): (u64, &f64)| (value - self.now - self.slope * step as f64).abs() <= most;
        (1..).zip(self.ahead).take_while(|step| holds(*step)).count() as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Steps at which a potential is evaluated, up to a last one.
    fn evaluations(potential: impl Fn(f64) -> f64, last: u64) -> Vec<u64> {
        let (mut at, mut steps) = (vec![0], 1);
        let mut before = 0;
        while at[at.len() - 1] < last {
            let now = at[at.len() - 1];
            let look = Look { before, step_s: 1.0, most: (2 * before).max(steps) };
            let time = |stride: f64, step: u64| now as f64 + stride * step as f64;
            let mut course = vec![potential((now - before) as f64)];
            for stride in [1.0, LEAST_PER_PERIOD] {
                course.extend((1..=look.most).map(|step| potential(time(stride, step))));
            }
            steps = Line::new(potential(now as f64), &course, look).steps_within(MISSED).max(1);
            before = steps;
            at.push(now + steps);
        }
        at
    }

    #[test]
    fn sine_is_evaluated_two_dozen_times_in_a_period_whatever_the_step() {
        for (period, phase) in [(300.0, 0.0), (2000.0, 0.7), (50_000.0, 2.0)] {
            let sine = |t: f64| 7.0 + 3.0 * (TAU * t / period + phase).sin();
            let count = evaluations(sine, 10 * period as u64).len();
            assert!((200..330).contains(&count), "{period} {count}");
        }
    }

    #[test]
    fn line_ends_where_a_table_turns_and_where_it_is_not_known() {
        // Level, a pulse of five steps, level, a ramp, level.
        let rows = [(0.0, 0.0), (9000.0, 0.0), (9001.0, 5.0), (9006.0, 5.0), (9007.0, 0.0), (12e3, 0.0)];
        let table = |t: f64| {
            let next = rows.iter().position(|row| row.0 > t);
            let Some(next) = next else { return (0.01 * (t - 12e3)).min(30.0) };
            let ((from, low), (to, high)) = (rows[next - 1], rows[next]);
            low + (high - low) * (t - from) / (to - from)
        };
        let at = evaluations(table, 30_000);
        // A line goes on beyond a corner where that is less than 2 % of the range: for 60 steps of the ramp.
        for (corner, beyond) in [(9000, 0), (9001, 1), (9006, 1), (9007, 1), (12_000, 60), (15_000, 60)] {
            assert!(at.iter().any(|step| (corner..=corner + beyond).contains(step)), "{corner}: {at:?}");
        }
        assert!(at.len() < 120, "{at:?}");
        let look = Look { before: 1, step_s: 1.0, most: 4 };
        let course = [0.0, 2.0, 3.0, f64::NAN, f64::NAN, f64::NAN, f64::NAN, f64::NAN, f64::NAN];
        assert_eq!(Line::new(1.0, &course, look).steps_within(MISSED), 2);
        // The first interval holds what it has: nothing is before it.
        let course = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0];
        assert_eq!(Line::new(0.0, &course, Look { before: 0, ..look }).steps_within(MISSED), 3);
    }
}
