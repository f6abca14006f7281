//! Whole runs in the report.

use super::motion::MotionRow;
use super::page::{by_method, write_both};
use crate::StudyError;
use amberfield_draw::{Plot, Scale};
use std::fmt::Write as _;
use std::path::Path;

/// Standard deviations that a statistic may lie away from the replicas' mean.
const SPREAD: f64 = 3.0;

/// The part about whole runs; empty without any.
pub(super) fn section(rows: &[MotionRow], name: &str) -> String {
    let mut text = String::new();
    for (number, of_motion) in rows.chunk_by(|a, b| a.problem == b.problem).enumerate() {
        let Some(first) = of_motion.first() else { continue };
        let _infallible = writeln!(
            text,
            "## {}\n\nWhole runs beside one with far finer settings. Trajectories count up to {:.3e} s, at \
             most until a perturbation of 1e-12 radii has grown tenfold; their error is over the way since \
             the start, that of charges over what \
             contacts have moved. Height, kinetic energy and contacts at the end are given in standard \
             deviations of replicas from their mean.\n\n![error and \
             time](pictures/{name}-motion-{number}.svg)\n\n\
             | settings | | wall clock [s] | steps | evaluations | trajectories | charges | height | \
             kinetic | contacts |\n|---|---|---|---|---|---|---|---|---|---|",
            first.problem,
            first.horizon_s.unwrap_or(f64::NAN)
        );
        for row in of_motion {
            let small =
                |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.1e}"));
            let sigma =
                |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:+.1}"));
            let count = |value: Option<u64>| value.map_or_else(|| "–".to_owned(), |value| value.to_string());
            let _infallible = writeln!(
                text,
                "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
                row.method,
                row.value,
                row.seconds.map_or_else(|| row.failure.clone(), |seconds| format!("{seconds:.2}")),
                count(row.steps),
                count(row.evaluations),
                small(row.position_error),
                small(row.charge_error),
                sigma(row.height),
                sigma(row.kinetic),
                sigma(row.contacts),
            );
        }
        let all = || of_motion.iter().flat_map(|row| [row.height, row.kinetic, row.contacts]).flatten();
        let far = all().filter(|sigma| sigma.abs() > SPREAD).count();
        let _infallible = writeln!(
            text,
            "\n{far} of {} statistics lie more than {SPREAD} deviations away.\n",
            all().count()
        );
    }
    text
}

/// Draws error against wall-clock time.
pub(super) fn draw(folder: &Path, rows: &[MotionRow], name: &str) -> Result<(), StudyError> {
    for (number, of_motion) in rows.chunk_by(|a, b| a.problem == b.problem).enumerate() {
        let point = |row: &MotionRow| Some((row.position_error.filter(|error| *error > 0.0)?, row.seconds?));
        let series = by_method(of_motion.iter().filter_map(|row| Some((row.method.as_str(), point(row)?))));
        if series.is_empty() {
            continue;
        }
        let plot = Plot {
            title: &of_motion[0].problem,
            x: "relative RMS error of the trajectories",
            y: "wall clock [s]",
            scales: [Scale::Logarithmic; 2],
            series: &series,
            ringed: &[],
        };
        write_both(folder, &format!("{name}-motion-{number}"), &plot)?;
    }
    Ok(())
}
