//! Courses of potentials and fields that change with time.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::ops::{Add, Mul, Sub};

/// Steps, or evaluations, in a period at least; fewer do not show a sine.
pub const LEAST_PER_PERIOD: f64 = 20.0;

/// Quantity over time: a potential [V], or a field [V/m].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Course<T> {
    /// Sine, amplitude·sin(2πft + phase) + offset.
    Sine {
        /// Amplitude.
        amplitude: T,
        /// Frequency f [Hz].
        frequency_hz: f64,
        /// Phase at t = 0 [rad].
        phase: f64,
        /// Mean over a period.
        offset: T,
    },
    /// Values at times, with a straight line between two rows; held before the first and after the last.
    Table {
        /// Name of its file, for messages.
        name: String,
        /// Rows with increasing times, at least two.
        rows: Vec<CourseRow<T>>,
    },
}

/// Value at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct CourseRow<T> {
    /// Time [s].
    pub time_s: f64,
    /// Value.
    pub value: T,
}

impl<T> Course<T>
where
    T: Copy + Add<Output = T> + Sub<Output = T> + Mul<f64, Output = T>,
{
    /// Value at a time [s].
    #[must_use]
    pub fn at(&self, time_s: f64) -> T {
        match self {
            // Whole periods are taken off before they are multiplied by 2π, which is not exact.
            Self::Sine { amplitude, frequency_hz, phase, offset } => {
                *amplitude * (TAU * (frequency_hz * time_s).fract() + phase).sin() + *offset
            }
            Self::Table { rows, .. } => {
                let next = rows.partition_point(|row| row.time_s <= time_s);
                match (next.checked_sub(1).map(|before| rows[before]), rows.get(next)) {
                    (Some(from), Some(to)) => {
                        let part = (time_s - from.time_s) / (to.time_s - from.time_s);
                        from.value + (to.value - from.value) * part
                    }
                    (Some(last), None) => last.value,
                    (None, _) => rows[0].value,
                }
            }
        }
    }

    /// Longest time from now, a time [s], until the next look at it, for one that goes on along a straight
    /// line [s]: a twentieth of a period, or of the present line of a table but not beyond its end. Infinite
    /// where it stays as it is.
    #[must_use]
    pub fn longest_look_s(&self, time_s: f64) -> f64 {
        match self {
            Self::Sine { .. } => self.longest_step_s(),
            Self::Table { rows, .. } => {
                let next = rows.partition_point(|row| row.time_s <= time_s);
                let Some(to) = rows.get(next) else { return f64::INFINITY };
                let left = to.time_s - time_s;
                match next.checked_sub(1) {
                    Some(before) => left.min((to.time_s - rows[before].time_s) / LEAST_PER_PERIOD),
                    None => left,
                }
            }
        }
    }

    /// Longest step of a run that shows it [s]: a twentieth of a period; infinite for a table.
    #[must_use]
    pub fn longest_step_s(&self) -> f64 {
        match self {
            Self::Sine { frequency_hz, .. } => 1.0 / (LEAST_PER_PERIOD * frequency_hz),
            Self::Table { .. } => f64::INFINITY,
        }
    }
}

/// Potential of a face [V] over time.
pub type PotentialCourse = Course<f64>;
/// Uniform field [V/m] over time.
pub type FieldCourse = Course<Vector3<f64>>;

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[(f64, f64)]) -> PotentialCourse {
        let rows = rows.iter().map(|&(time_s, value)| CourseRow { time_s, value }).collect();
        Course::Table { name: "v.csv".into(), rows }
    }

    #[test]
    fn sine_has_its_values_at_quarters_and_after_many_periods() {
        let sine = Course::Sine { amplitude: 3.0, frequency_hz: 50.0, phase: 0.0, offset: 1.0 };
        for (quarter, value) in [(0.0, 1.0), (1.0, 4.0), (2.0, 1.0), (3.0, -2.0), (4e6 + 1.0, 4.0)] {
            assert!((sine.at(quarter * 5e-3) - value).abs() < 1e-7, "{quarter}");
        }
        let quarter_on = Course::Sine { amplitude: 3.0, frequency_hz: 50.0, phase: TAU / 4.0, offset: 0.0 };
        assert_eq!(quarter_on.at(0.0), 3.0);
        let vector = Course::Sine {
            amplitude: Vector3::new(0.0, 2.0, -4.0),
            frequency_hz: 1.0,
            phase: TAU / 4.0,
            offset: Vector3::x(),
        };
        assert_eq!(vector.at(0.0), Vector3::new(1.0, 2.0, -4.0));
    }

    #[test]
    fn tables_go_along_lines_and_are_held_before_and_after() {
        let course = table(&[(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)]);
        for (time, value) in [(0.0, 10.0), (1.0, 10.0), (1.25, 12.5), (2.0, 20.0), (3.0, 10.0), (9.0, 0.0)] {
            assert_eq!(course.at(time), value);
        }
    }

    #[test]
    fn looks_are_twenty_a_period_and_never_beyond_the_next_row() {
        let sine = Course::Sine { amplitude: 1.0, frequency_hz: 50.0, phase: 0.0, offset: 0.0 };
        assert_eq!(sine.longest_look_s(0.3), 1e-3);
        assert_eq!(sine.longest_step_s(), 1e-3);
        let course = table(&[(1.0, 10.0), (2.0, 20.0), (4.0, 0.0)]);
        assert_eq!(course.longest_look_s(0.25), 0.75);
        assert_eq!(course.longest_look_s(1.0), 0.05);
        assert!((course.longest_look_s(1.99) - 0.01).abs() < 1e-15);
        assert_eq!(course.longest_look_s(2.0), 0.1);
        assert_eq!(course.longest_look_s(4.0), f64::INFINITY);
        assert_eq!(course.longest_step_s(), f64::INFINITY);
    }
}
