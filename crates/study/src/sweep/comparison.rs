//! Points that promise nothing beside points with a promise, and the goals that a study sets.

use super::description::Goal;
use super::row::Row;
use serde::Serialize;

/// A point beside the best with a promise on the same problem.
pub(super) struct Comparison<'a> {
    pub(super) row: &'a Row,
    pub(super) error: f64,
    pub(super) ns: f64,
    /// Smallest error with a promise in at most the same time.
    pub(super) in_time: Option<f64>,
    /// Shortest time with a promise and at most the same error [ns per grain].
    pub(super) as_exact: Option<f64>,
}

/// Every point of a problem that promises nothing and is not exact.
pub(super) fn comparisons(rows: &[Row]) -> Vec<Comparison<'_>> {
    let points = |promises: bool| {
        rows.iter().filter_map(move |row| {
            let known = (row.error?, row.ns_per_grain()?, row);
            (row.promised.is_some() == promises).then_some(known)
        })
    };
    let one = |(error, ns, row)| Comparison {
        row,
        error,
        ns,
        in_time: points(true).filter(|other| other.1 <= ns).map(|other| other.0).min_by(f64::total_cmp),
        as_exact: points(true).filter(|other| other.0 <= error).map(|other| other.1).min_by(f64::total_cmp),
    };
    points(false).filter(|(error, ..)| *error > 0.0).map(one).collect()
}

/// Verdict on a goal.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct Verdict {
    /// Worst ratio.
    pub(super) ratio: f64,
    /// Point that has the worst ratio.
    pub(super) at: String,
    /// Number of points that miss the goal.
    pub(super) missed: usize,
    /// Number of points that were looked at.
    pub(super) of: usize,
}

/// Verdict on a goal; `None` where nothing was measured.
pub(super) fn verdict(goal: &Goal, rows: &[Row]) -> Option<Verdict> {
    let ratios = match (goal.times_less, goal.times_as_fast, goal.at_most) {
        (Some(_), ..) => beside(goal, rows, |point| Some(point.error / point.in_time?)),
        (_, Some(_), _) => beside(goal, rows, |point| Some(point.ns / point.as_exact?)),
        _ => prices(goal, rows),
    };
    let (wanted, good) = match (goal.times_less.or(goal.times_as_fast), goal.at_most) {
        (Some(least), _) => (least, 1.0),
        (None, Some(most)) => (most, -1.0),
        (None, None) => return None,
    };
    // How far a ratio is on the good side of the wanted one.
    let merit = |ratio: f64| good * (ratio - wanted);
    let (missed, of) = (ratios.iter().filter(|(ratio, _)| merit(*ratio) < 0.0).count(), ratios.len());
    let (ratio, at) = ratios.into_iter().min_by(|a, b| merit(a.0).total_cmp(&merit(b.0)))?;
    Some(Verdict { ratio, at, missed, of })
}

/// A ratio of every point that the goal is about; 0 where nothing with a promise is as good.
fn beside(goal: &Goal, rows: &[Row], ratio: impl Fn(&Comparison<'_>) -> Option<f64>) -> Vec<(f64, String)> {
    rows.chunk_by(|a, b| a.problem == b.problem)
        .filter(|of_problem| goal.is_about(&of_problem[0].problem))
        .flat_map(comparisons)
        .filter(|point| point.row.method == goal.method)
        .filter(|point| goal.value.as_ref().is_none_or(|value| *value == point.row.value))
        .map(|point| (ratio(&point).unwrap_or(0.0), name(point.row)))
        .collect()
}

/// Times of a method on one problem over those on another, value by value.
fn prices(goal: &Goal, rows: &[Row]) -> Vec<(f64, String)> {
    let of = |problem: &str| {
        let problem = problem.to_owned();
        rows.iter().filter(move |row| row.problem == problem && row.method == goal.method)
    };
    let Some([dear, cheap]) = &goal.price else { return Vec::new() };
    let ratio = |row: &Row| {
        let other = of(cheap).find(|other| other.value == row.value)?;
        Some((row.ns_per_grain()? / other.ns_per_grain()?, name(row)))
    };
    of(dear).filter_map(ratio).collect()
}

/// A point in words.
fn name(row: &Row) -> String {
    format!("{} {} on {}", row.method, row.value, row.problem)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(problem: &str, method: &str, error: f64, seconds: f64, promised: bool) -> Row {
        Row {
            problem: problem.to_owned(),
            method: method.to_owned(),
            grains: 1,
            error: Some(error),
            seconds: Some(seconds),
            promised: promised.then_some(1.0),
            ..Row::default()
        }
    }

    fn goal(text: &str) -> Goal {
        toml::from_str(&format!("text = 't'\n{text}")).unwrap()
    }

    #[test]
    fn goals_are_judged_by_their_worst_point() {
        let rows = [
            row("a", "p3m", 1e-2, 1.0, true),
            row("a", "p3m", 1e-3, 2.0, true),
            row("a", "cut-off", 0.3, 1.5, false),
            row("b", "p3m", 1e-2, 1.2, true),
            row("b", "cut-off", 0.2, 3.0, false),
        ];
        let judged = |text: &str| verdict(&goal(text), &rows);
        let near = |found: Option<Verdict>, ratio: f64, missed: usize, of: usize| {
            let found = found.unwrap();
            let right = (found.ratio / ratio - 1.0).abs() < 1e-12;
            assert!(right && found.missed == missed && found.of == of, "{found:?}");
        };
        near(judged("method = 'cut-off'\ntimes_less = 25"), 20.0, 1, 2);
        near(judged("method = 'cut-off'\ntimes_less = 25\nproblems = ['a']"), 30.0, 0, 1);
        near(judged("method = 'cut-off'\ntimes_as_fast = 1.4"), 1.5, 0, 2);
        near(judged("method = 'p3m'\nprice = ['b', 'a']\nat_most = 1.5"), 1.2, 0, 1);
        assert_eq!(judged("method = 'FMM3D'\ntimes_as_fast = 5"), None);
    }
}
