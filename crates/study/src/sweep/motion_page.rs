//! Whole runs in the report.

use super::motion::MotionRow;
use super::page::{by_method, write_both};
use crate::StudyError;
use crate::templates::fill;
use amberfield_draw::{Plot, Scale};
use minijinja::context;
use std::path::Path;

/// Standard deviations that a statistic may lie away from the replicas' mean.
const SPREAD: f64 = 3.0;

/// The part about whole runs; empty without any.
pub(super) fn section(rows: &[MotionRow], name: &str) -> String {
    let mut text = String::new();
    for (number, of_motion) in rows.chunk_by(|a, b| a.problem == b.problem).enumerate() {
        let Some(first) = of_motion.first() else { continue };
        let all = || of_motion.iter().flat_map(|row| [row.height, row.kinetic, row.contacts]).flatten();
        let values = context! {
            problem => first.problem,
            horizon_s => first.horizon_s.unwrap_or(f64::NAN),
            picture => format!("{name}-motion-{number}"),
            rows => of_motion,
            far => all().filter(|sigma| sigma.abs() > SPREAD).count(),
            statistics => all().count(),
            spread => SPREAD,
        };
        text += &fill(include_str!("../../templates/sweep/motion.md"), values);
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
