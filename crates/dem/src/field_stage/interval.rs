//! Choice of the steps between two evaluations of the field.
//!
//! Every evaluation checks the forecast that it replaces: δ, the RMS over the members of the difference
//! between the fresh E and the forecast, over the scale of E, is the error that the forecast had reached. It
//! grows about as the square of the time since the evaluation, so that
//!
//! next = present · √(aim/δ), within a quarter and twice the present interval,
//!
//! like the step of a solver of ordinary differential equations, except that no step is taken back. A
//! forecast from two evaluations that are as far apart as the next one errs by δ s(s+1)/2 at the part s of
//! its interval, 0.51 δ in RMS over the interval; a field that is held errs by δ s, 0.58 δ.
//!
//! All depends on the grains only, never on a clock.

use amberfield_core::CouplingInterval;
use serde::{Deserialize, Serialize};

/// RMS over an interval of the error of an extrapolated field, over the error at the interval's end:
/// √∫(s(s+1)/2)² ds from 0 to 1 = √(31/120).
const EXTRAPOLATED: f64 = 0.508;
/// RMS over an interval of the error of a field that is held, over the error at its end: √(1/3).
const HELD: f64 = 0.577;
/// RMS error over an interval that is aimed at, over the tolerance. The tuned field leaves about as much to
/// spare: the two together, whose squares add, meet the tolerance.
const AIM: f64 = 0.8;
/// Largest difference of any grain that is aimed at, over the RMS difference that is: grains that few others
/// resemble, such as a lone one that falls on a conductor, are held to this.
const WORST: f64 = 30.0;
/// Least growth of the interval from one evaluation to the next.
const LEAST_GROWTH: f64 = 0.25;
/// Most growth of the interval from one evaluation to the next.
const MOST_GROWTH: f64 = 2.0;

/// Error of a forecast, found at the evaluation that replaced it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Check {
    /// RMS difference over the members between forecast and fresh E, over the scale of E.
    pub(crate) rms: f64,
    /// Largest difference of any member, likewise.
    pub(crate) largest: f64,
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
    /// Σ over the checked steps of the squared relative error.
    squares: f64,
    /// Largest RMS error over one interval.
    pub largest_error: f64,
}

impl Intervals {
    /// RMS error of E, over members and steps and over the scale of E, made by not evaluating every step.
    #[must_use]
    pub fn error(&self) -> f64 {
        (self.squares / self.checked_steps.max(1) as f64).sqrt()
    }
}

/// Chooses the intervals.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct IntervalControl {
    pub(crate) intervals: Intervals,
    /// Steps since the last evaluation.
    pub(crate) age: u64,
    /// Whether two evaluations in a row are known.
    extrapolates: bool,
}

impl IntervalControl {
    pub(crate) fn new() -> Self {
        let intervals = Intervals { steps_now: 1, ..Intervals::default() };
        Self { intervals, age: 0, extrapolates: false }
    }

    /// Books a step; whether the field is due by its interval.
    pub(crate) fn is_due(&mut self) -> bool {
        self.age += 1;
        self.age >= self.intervals.steps_now
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
        let age = std::mem::take(&mut self.age);
        let Some(check) = check else { return };
        let over_interval = if self.extrapolates { EXTRAPOLATED } else { HELD };
        let error = over_interval * check.rms;
        self.intervals.checked_steps += age;
        self.intervals.squares += age as f64 * error * error;
        self.intervals.largest_error = self.intervals.largest_error.max(error);
        self.intervals.steps_now = match wanted {
            CouplingInterval::Steps(steps) => u64::from(steps.max(1)),
            CouplingInterval::Auto => {
                let error = error.max(over_interval * check.largest / WORST);
                let growth = (AIM * tolerance / error).sqrt().clamp(LEAST_GROWTH, MOST_GROWTH);
                ((age as f64 * growth) as u64).clamp(1, most.max(1))
            }
        };
        self.extrapolates = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: f64 = 1e-2;

    /// Interval after many evaluations whose forecasts err by `curvature` × interval^`power` at their end.
    fn settled(curvature: f64, power: f64, most: u64) -> IntervalControl {
        let mut control = IntervalControl::new();
        control.evaluated(None, CouplingInterval::Auto, TOLERANCE, most);
        for _ in 0..40 {
            while !control.is_due() {}
            let rms = curvature * (control.age as f64).powf(power);
            let check = Check { rms, largest: 3.0 * rms };
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
            assert!((0.93 * steps..=steps).contains(&now), "{now} {steps}");
            assert!(control.intervals.error() <= AIM * TOLERANCE);
        }
        // A worst grain that is 300 times as bad as the RMS asks for a tenth of the error.
        let mut control = settled(1e-5, 2.0, u64::MAX);
        for _ in 0..40 {
            while !control.is_due() {}
            let rms = 1e-5 * (control.age as f64).powi(2);
            let check = Check { rms, largest: 10.0 * WORST * rms };
            control.evaluated(Some(check), CouplingInterval::Auto, TOLERANCE, u64::MAX);
        }
        let end = 1e-5 * (control.intervals.steps_now as f64).powi(2);
        assert!((0.8..=1.0).contains(&(EXTRAPOLATED * end / (0.1 * AIM * TOLERANCE))), "{end}");
    }

    #[test]
    fn interval_stays_between_one_step_and_the_most_allowed() {
        assert_eq!(settled(1.0, 2.0, 100).intervals.steps_now, 1);
        assert_eq!(settled(0.0, 2.0, 100).intervals.steps_now, 100);
    }

    #[test]
    fn fixed_interval_is_kept_and_its_error_reported() {
        let mut control = IntervalControl::new();
        control.evaluated(None, CouplingInterval::Steps(7), TOLERANCE, 3);
        assert!(control.is_due());
        control.evaluated(Some(Check { rms: 1.0, largest: 1.0 }), CouplingInterval::Steps(7), TOLERANCE, 3);
        assert_eq!((1..).find(|_| control.is_due()), Some(7));
        control.evaluated(Some(Check { rms: 2.0, largest: 2.0 }), CouplingInterval::Steps(7), TOLERANCE, 3);
        let Intervals { evaluations, checked_steps, largest_error, .. } = control.intervals;
        assert_eq!((evaluations, checked_steps, largest_error), (3, 8, 2.0 * EXTRAPOLATED));
        let mean = ((HELD.powi(2) + 7.0 * (2.0 * EXTRAPOLATED).powi(2)) / 8.0).sqrt();
        assert!((control.intervals.error() - mean).abs() < 1e-15);
    }
}
