//! Choice of the steps between two evaluations of the field, and the error of the forces in between.
//!
//! Every evaluation checks the forecast that it replaces. The difference between the fresh E and the forecast
//! has two parts:
//!
//! * *drift*, because grains move. The line through the evaluations S₀ steps before the last one and at it
//!   errs by ½ E″ s(s + S₀) after s steps; a field that is held errs by E′ s. With the drift δ at the end of
//!   the interval of S steps, that is δ s(s + S₀)/(S(S + S₀)), or δ s/S.
//! * *jumps*, because charges change at contacts and grains leave. They grow as the charges do: with c(s) the
//!   jump of E that the charges of step s make by a rough formula, and j the part of the jumps in the
//!   difference, they err by j c(s)/c(S).
//!
//! The forces of the step in which the field is evaluated are made with the fresh E, so that s = 1 … S − 1
//! count: a run that evaluates in every step forecasts nothing, and its error is zero.
//!
//! Only drift chooses the interval: the next one, S′, is that at whose end S′(S′ + S) has made the RMS error
//! over the interval as large as is aimed at, within a quarter and twice the present one, like the step of a
//! solver of ordinary differential equations, except that no step is taken back. Charges that change by more
//! than the tolerance have the field evaluated at once.
//!
//! All depends on the grains only, never on a clock.

use amberfield_core::CouplingInterval;
use serde::{Deserialize, Serialize};

/// RMS over a long interval of the drift of an extrapolated field, over that at the interval's end, after an
/// interval as long: √∫(s(s+1)/2)² ds from 0 to 1 = √(31/120).
const EXTRAPOLATED: f64 = 0.508;
/// RMS over a long interval of the drift of a field that is held, over that at its end: √(1/3).
const HELD: f64 = 0.577;
/// RMS error over an interval that is aimed at, over the tolerance. The tuned field leaves about as much to
/// spare: the two together, whose squares add, meet the tolerance.
const AIM: f64 = 0.6;
/// Largest difference of any grain that is aimed at, over the RMS difference that is: grains that few others
/// resemble, such as a lone one that falls on a conductor, are held to this.
const WORST: f64 = 30.0;
/// Least growth of the interval from one evaluation to the next.
const LEAST_GROWTH: f64 = 0.25;
/// Most growth of the interval from one evaluation to the next.
const MOST_GROWTH: f64 = 2.0;

/// Differences between forecast and fresh E at the evaluation that replaced the forecast, over the scale of
/// E.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Check {
    /// Drift in the forces: RMS over the members, each with its charge squared as weight.
    pub(crate) drift: f64,
    /// Jumps in the forces, likewise.
    pub(crate) jump: f64,
    /// RMS drift over the members, whatever their charge.
    pub(crate) drift_of_all: f64,
    /// Largest drift of any member.
    pub(crate) largest: f64,
    /// Squared jump of E by the rough formula [V²/m²].
    pub(crate) jumped: f64,
    /// Error of the forecast that a field solver beside the steps made for itself; it is in every step.
    pub(crate) missed: f64,
    /// Sum over the members of the squared scale of the forces [N²]: how much the interval weighs in a run.
    pub(crate) forces2: f64,
}

/// Intervals of a run between evaluations of the field, and the error of E that they made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Intervals {
    /// Evaluations of the field.
    pub evaluations: u64,
    /// Steps whose forecast has been checked by the evaluation at its end.
    pub checked_steps: u64,
    /// Steps of the interval in progress.
    pub steps_now: u64,
    /// Σ over the checked steps of the squared error of the forces [N²].
    squares: f64,
    /// Σ over the checked steps of the squared scale of the forces [N²].
    forces2: f64,
    /// Largest RMS error over one interval.
    pub largest_error: f64,
}

impl Intervals {
    /// RMS error of the electric forces over members and steps, made by not evaluating every step, over the
    /// RMS scale of the forces. The last grains of a cloud that leaves weigh as little as their forces do.
    #[must_use]
    pub fn error(&self) -> f64 {
        (self.squares / self.forces2.max(f64::MIN_POSITIVE)).sqrt()
    }
}

/// Chooses the intervals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct IntervalControl {
    pub(crate) intervals: Intervals,
    /// Steps since the last evaluation.
    pub(crate) age: u64,
    /// Steps between the last two evaluations; 0: E is held.
    before: u64,
    /// Sum over the steps since the last evaluation of the squared jump of E by the rough formula [V²/m²].
    jumped: f64,
}

impl IntervalControl {
    pub(crate) fn new() -> Self {
        let intervals = Intervals { steps_now: 1, ..Intervals::default() };
        Self { intervals, age: 0, before: 0, jumped: 0.0 }
    }

    /// Books a step; whether the field is due by its interval.
    pub(crate) fn is_due(&mut self) -> bool {
        self.age += 1;
        self.age >= self.intervals.steps_now
    }

    /// Books a step whose forces are forecast, after a squared jump of E by the rough formula [V²/m²].
    pub(crate) fn forecasts(&mut self, jumped: f64) {
        self.jumped += jumped;
    }

    /// Whether the field will be due by its interval in the next step.
    pub(crate) fn may_be_due(&self) -> bool {
        self.age + 1 >= self.intervals.steps_now
    }

    /// Books an evaluation and chooses the next interval of at most `most` steps. `check` is `None` when no
    /// step was taken since the last evaluation.
    pub(crate) fn evaluated(
        &mut self,
        check: Option<Check>,
        wanted: CouplingInterval,
        tolerance: f64,
        most: u64,
    ) {
        self.intervals.evaluations += 1;
        let (steps, jumped) = (std::mem::take(&mut self.age), std::mem::take(&mut self.jumped));
        let Some(check) = check else { return };
        let jumps = if check.jumped > 0.0 { jumped / check.jumped } else { 0.0 };
        let squares = check.drift.powi(2) * drift_squares(steps, self.before)
            + check.jump.powi(2) * jumps
            + (EXTRAPOLATED * check.missed).powi(2) * steps as f64;
        self.intervals.checked_steps += steps;
        self.intervals.squares += squares * check.forces2;
        self.intervals.forces2 += steps as f64 * check.forces2;
        let error = (squares / steps as f64).sqrt();
        self.intervals.largest_error = self.intervals.largest_error.max(error);
        self.intervals.steps_now = match wanted {
            CouplingInterval::Steps(steps) => u64::from(steps.max(1)),
            CouplingInterval::Auto => self.next(steps, check, self.aim(tolerance)).min(most).max(1),
        };
        self.before = steps;
    }

    /// RMS error over an interval that is aimed at. An interval follows what has been seen, and grains that
    /// meet come as a surprise: the more the run has erred so far, the lower the aim.
    fn aim(&self, tolerance: f64) -> f64 {
        let aim = AIM * tolerance;
        let error = self.intervals.error();
        if error > aim { aim * (aim / error).powi(2) } else { aim }
    }

    /// Steps of the next interval, after one of `steps`, for an RMS error over it that is aimed at.
    fn next(&self, steps: u64, check: Check, aim: f64) -> u64 {
        let drift = check.drift.max(check.drift_of_all).max(check.largest / WORST).hypot(check.missed);
        let (length, before) = (steps as f64, self.before as f64);
        let wanted = if self.before == 0 {
            length * (aim / (HELD * drift)).sqrt()
        } else {
            let curvature = drift / (length * (length + before));
            0.5 * ((length * length + 4.0 * aim / (EXTRAPOLATED * curvature)).sqrt() - length)
        };
        wanted.clamp(LEAST_GROWTH * length, self.longest_after(steps)) as u64
    }

    /// Most steps of the interval that begins now.
    pub(crate) fn longest_next(&self) -> u64 {
        self.longest_after(self.age) as u64
    }

    /// Most steps of an interval after one of `steps`. One that charges cut short says little about a longer
    /// one: it comes back to what it was.
    fn longest_after(&self, steps: u64) -> f64 {
        (MOST_GROWTH * steps as f64).max(self.intervals.steps_now as f64)
    }
}

/// Sum over the steps s = 1 … S − 1 of an interval of S steps of the squared drift over that at its end. It
/// grows as s(s + S₀) after an interval of S₀ steps, or as s where S₀ is 0.
fn drift_squares(steps: u64, before: u64) -> f64 {
    let (length, before) = (steps as f64, before as f64);
    let last = length - 1.0;
    let squares = last * length * (2.0 * last + 1.0) / 6.0;
    if before == 0.0 {
        return squares / length.powi(2);
    }
    let cubes = (0.5 * last * length).powi(2);
    let fourths = squares * (3.0 * last * last + 3.0 * last - 1.0) / 5.0;
    (fourths + 2.0 * before * cubes + before * before * squares) / (length * (length + before)).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-2;

    /// Drift at the end of an interval of S steps after one of S₀: `curvature` (S(S + S₀)/2)^(`power`/2).
    fn drift(control: &IntervalControl, curvature: f64, power: f64) -> f64 {
        let before = if control.before == 0 { control.age } else { control.before };
        curvature * (0.5 * (control.age * (control.age + before)) as f64).powf(0.5 * power)
    }

    /// Interval after many evaluations whose forecasts err by such a drift.
    fn settled(curvature: f64, power: f64, most: u64) -> IntervalControl {
        let mut control = IntervalControl::new();
        control.evaluated(None, CouplingInterval::Auto, TOLERANCE, most);
        for _ in 0..40 {
            while !control.is_due() {}
            let drift = drift(&control, curvature, power);
            let check = Check { drift, largest: 3.0 * drift, forces2: 1.0, ..Check::default() };
            control.evaluated(Some(check), CouplingInterval::Auto, TOLERANCE, most);
        }
        control
    }

    #[test]
    fn interval_settles_where_the_error_over_it_is_what_is_aimed_at() {
        for (power, steps) in [(2.0, 20.0_f64), (1.3, 30.0)] {
            let curvature = AIM * TOLERANCE / EXTRAPOLATED / steps.powf(power);
            let control = settled(curvature, power, u64::MAX);
            let now = control.intervals.steps_now as f64;
            // Whole steps: it goes to and fro by one.
            assert!((now - steps).abs() <= 0.07 * steps, "{now} {steps}");
            assert!(control.intervals.error() <= AIM * TOLERANCE);
        }
        // A worst grain that is 300 times as bad as the RMS asks for a tenth of the error.
        let mut control = settled(1e-5, 2.0, u64::MAX);
        for _ in 0..40 {
            while !control.is_due() {}
            let drift = drift(&control, 1e-5, 2.0);
            let check = Check { drift, largest: 10.0 * WORST * drift, forces2: 1.0, ..Check::default() };
            control.evaluated(Some(check), CouplingInterval::Auto, TOLERANCE, u64::MAX);
        }
        let end = 1e-5 * (control.intervals.steps_now as f64).powi(2);
        assert!((0.8..=1.05).contains(&(EXTRAPOLATED * end / (0.1 * AIM * TOLERANCE))), "{end}");
    }

    #[test]
    fn interval_stays_between_one_step_and_the_most_allowed() {
        assert_eq!(settled(1.0, 2.0, 100).intervals.steps_now, 1);
        assert_eq!(settled(0.0, 2.0, 100).intervals.steps_now, 100);
    }

    /// A check that found drift alone.
    fn drifted(drift: f64) -> Option<Check> {
        Some(Check { drift, drift_of_all: drift, largest: drift, forces2: 1.0, ..Check::default() })
    }

    #[test]
    fn fixed_interval_is_kept_and_its_error_reported() {
        let fixed = CouplingInterval::Steps(3);
        let mut control = IntervalControl::new();
        control.evaluated(None, fixed, TOLERANCE, 3);
        assert!(control.is_due());
        control.evaluated(drifted(1.0), fixed, TOLERANCE, 3);
        // The only step was evaluated.
        assert_eq!(control.intervals.error(), 0.0);
        assert_eq!((1..).find(|_| control.is_due()), Some(3));
        control.evaluated(drifted(2.0), fixed, TOLERANCE, 3);
        // s(s + 1)/12 of 2: 1/3 and 1.
        let over_interval = f64::sqrt((1.0 / 9.0 + 1.0) / 3.0);
        let Intervals { evaluations, checked_steps, largest_error, .. } = control.intervals;
        assert_eq!((evaluations, checked_steps), (3, 4));
        assert!((largest_error - over_interval).abs() < 1e-15);
        assert!((control.intervals.error() - over_interval * f64::sqrt(3.0 / 4.0)).abs() < 1e-15);
    }

    #[test]
    fn intervals_weigh_as_much_as_their_forces() {
        let mut control = IntervalControl::new();
        let fixed = CouplingInterval::Steps(2);
        control.evaluated(None, fixed, TOLERANCE, 2);
        control.intervals.steps_now = 2;
        // The drift of two held steps is half that at the end after the first, none after the second.
        for (drift, forces2) in [(0.01, 1.0), (1.0, 1e-8)] {
            control.before = 0;
            while !control.is_due() {}
            let check = Check { drift, forces2, ..Check::default() };
            control.evaluated(Some(check), fixed, TOLERANCE, 2);
        }
        let of_first = 0.01 * f64::sqrt(0.125);
        assert!((control.intervals.error() - of_first).abs() < 1e-3 * of_first);
        assert!((control.intervals.largest_error - f64::sqrt(0.125)).abs() < 1e-12);
    }

    #[test]
    fn drift_grows_along_its_parabola_and_a_jump_when_charges_do() {
        let sum = |steps: u64, before: u64| {
            let at = |s: u64| if before == 0 { s as f64 } else { (s * (s + before)) as f64 };
            (1..steps).map(|s| (at(s) / at(steps)).powi(2)).sum::<f64>()
        };
        for (steps, before) in [(1, 0), (1, 5), (2, 0), (7, 3), (40, 1), (200, 200)] {
            assert!((drift_squares(steps, before) - sum(steps, before)).abs() < 1e-11);
        }
        let long = (drift_squares(10_000, 10_000) / 1e4).sqrt();
        assert!((long - EXTRAPOLATED).abs() < 1e-3);
        // Charges that change in the third of four steps, all of what is found at the end.
        let mut control = IntervalControl::new();
        (0..4).for_each(|_| assert!(control.is_due()));
        [0.0, 0.0, 5.0].into_iter().for_each(|jumped| control.forecasts(jumped));
        let check = Check { jump: 0.2, jumped: 5.0, forces2: 1.0, ..Check::default() };
        control.evaluated(Some(check), CouplingInterval::Auto, TOLERANCE, 9);
        assert!((control.intervals.error() - 0.1).abs() < 1e-15);
        // Jumps do not shorten the next interval.
        assert_eq!(control.intervals.steps_now, 8);
    }
}
