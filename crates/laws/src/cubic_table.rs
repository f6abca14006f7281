//! Cubic between two rows of a table: y = h₀₀ y₀ + h₁₀ Δt m₀ + h₀₁ y₁ + h₁₁ Δt m₁, Hermite's polynomial.
//!
//! With s = (t − t₀)/Δt: h₀₀ = (1 + 2s)(1 − s)², h₁₀ = s(1 − s)², h₀₁ = s²(3 − 2s), h₁₁ = s²(s − 1). The
//! slope m at a row is that of the parabola through it and its neighbours, at an end that of the parabola of
//! its end, so that tables of parabolas are exact, y and dy/dt go on at every row, and the error is of third
//! order. Range: rising times.
//! Source: Fritsch & Carlson, SIAM J. Numer. Anal. 17, 238 (1980), eq. 1; slopes by three points.
//!
//! ```
//! use amberfield_core::Vector3;
//! use amberfield_laws::cubic_table::{Row, between};
//! let row = |time: f64| Row { time, value: Vector3::repeat(time * time) };
//! let rows = [row(0.0), row(1.0), row(3.0)];
//! assert!((between(&rows, 2.0).value.x - 4.0).abs() < 1e-14);
//! assert!((between(&rows, 2.0).rate.x - 4.0).abs() < 1e-14);
//! ```

use amberfield_core::Vector3;

/// Row of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time [s].
    pub time: f64,
    /// Value there.
    pub value: Vector3<f64>,
}

/// Value of a table at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Between {
    /// Value.
    pub value: Vector3<f64>,
    /// Derivative [1/s].
    pub rate: Vector3<f64>,
}

/// Value and derivative at a time [s]; before the first row and after the last, the value there, at rest.
///
/// # Panics
/// If there is no row.
#[must_use]
pub fn between(rows: &[Row], time: f64) -> Between {
    let after = rows.partition_point(|row| row.time <= time);
    if after == 0 || after == rows.len() {
        let row = if after == 0 { rows[0] } else { rows[rows.len() - 1] };
        return Between { value: row.value, rate: Vector3::zeros() };
    }
    let (from, to) = (&rows[after - 1], &rows[after]);
    let (first, last) = (slope(rows, after - 1), slope(rows, after));
    let length = to.time - from.time;
    let s = (time - from.time) / length;
    let rest = 1.0 - s;
    // Written with the difference of the values: where both are one, it is exactly this value.
    let step = to.value - from.value;
    Between {
        value: from.value
            + step * (s * s * (3.0 - 2.0 * s))
            + (first * (s * rest * rest) - last * (s * s * rest)) * length,
        rate: step * (6.0 * s * rest / length)
            + first * (rest * (1.0 - 3.0 * s))
            + last * (s * (3.0 * s - 2.0)),
    }
}

/// Slope of the parabola through a row and its neighbours, at the row [1/s].
fn slope(rows: &[Row], at: usize) -> Vector3<f64> {
    if rows.len() == 2 {
        return (rows[1].value - rows[0].value) / (rows[1].time - rows[0].time);
    }
    let middle = at.clamp(1, rows.len() - 2);
    let [a, b, c] = [rows[middle - 1], rows[middle], rows[middle + 1]];
    let (before, after) = (b.time - a.time, c.time - b.time);
    let (rise, next) = ((b.value - a.value) / before, (c.value - b.value) / after);
    let bend = (next - rise) / (before + after);
    // dy/dt of y_b + (t − t_b) [rise + bend (t − t_a)].
    rise + bend * (2.0 * rows[at].time - a.time - b.time)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(count: usize, of: impl Fn(f64) -> f64) -> Vec<Row> {
        let at = |k: usize| k as f64 / (count - 1) as f64;
        (0..count).map(|k| Row { time: at(k), value: Vector3::repeat(of(at(k))) }).collect()
    }

    #[test]
    fn error_is_of_third_order() {
        let error = |count: usize| {
            let rows = table(count, |t| (3.0 * t).sin());
            let off = |k: usize| {
                let time = k as f64 / 1000.0;
                (between(&rows, time).value.x - (3.0 * time).sin()).abs()
            };
            (0..=1000).map(off).fold(0.0, f64::max)
        };
        let order = (error(11) / error(21)).log2();
        assert!(order > 2.8, "{order}");
    }

    #[test]
    fn rate_is_the_derivative_and_goes_on_at_rows() {
        let rows = table(6, |t| (3.0 * t).sin());
        let h = 1e-6;
        for time in [0.1, 0.2, 0.33, 0.4, 0.95] {
            let slope = (between(&rows, time + h).value - between(&rows, time - h).value) / (2.0 * h);
            assert!((slope - between(&rows, time).rate).norm() < 1e-5, "{time}");
        }
    }

    #[test]
    fn ends_are_at_rest_and_equal_rows_stay_where_they_are() {
        let rows = table(5, |_| 0.1);
        for time in [-1.0, 0.03, 0.77, 2.0] {
            let Between { value, rate } = between(&rows, time);
            assert_eq!((value.x, rate.x), (0.1, 0.0), "{time}");
        }
    }
}
