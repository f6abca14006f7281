//! The report: tables, plots and conclusions, from rows only.

use super::description::Study;
use super::front::front;
use super::row::Row;
use crate::StudyError;
use crate::plot::{Plot, Scale, Series, write_plot};
use std::fmt::Write as _;
use std::path::Path;

/// Factor within which the a-priori model is said to be right.
const WITHIN: f64 = 2.0;
/// Share of the points at which it should be.
const SHARE: f64 = 0.9;

/// Writes `report.md` and its pictures (SVG and PNG) into a folder that exists; rows in the order of the study.
///
/// # Errors
/// A file that cannot be written.
pub fn write_report(folder: &Path, study: &Study, rows: &[Row], repeat: &str) -> Result<(), StudyError> {
    let mut page = format!("# {}\n\n{}", study.title, setting(study, rows, repeat));
    page += &conclusions(rows);
    let mut pictures = Vec::new();
    for (number, of_problem) in rows.chunk_by(|a, b| a.problem == b.problem).enumerate() {
        page += &section(of_problem, number);
        pictures.push((format!("problem-{number}"), of_problem));
    }
    page += &model(rows);
    page += &failures(rows);
    for (name, of_problem) in pictures {
        draw(folder, &name, of_problem)?;
    }
    draw_model(folder, rows)?;
    let path = folder.join("report.md");
    std::fs::write(&path, page).map_err(|source| StudyError::Write { path, source })
}

fn setting(study: &Study, rows: &[Row], repeat: &str) -> String {
    let first = rows.first().cloned().unwrap_or_default();
    format!(
        "Measured {} with amberfield {} on {}, {} thread{}. Every point is first compared with the truth at every grain, then timed {} times, all points of a problem taking turns, \
         each turn at least {} s long; times are medians. Errors are the root mean square of |ΔE| over the grains, relative to the larger of E_rms and q_rms n^{{2/3}}/(4πε). \
         All rows, with the command that repeats each, are in [points.csv](points.csv); the whole study is repeated by\n\n    {repeat}\n\n",
        first.date,
        first.version,
        first.processor,
        first.threads,
        if first.threads == 1 { "" } else { "s" },
        study.passes,
        study.least_s,
    )
}

/// What the rows say, in words.
fn conclusions(rows: &[Row]) -> String {
    let mut text = "## What it says\n\n".to_owned();
    for of_problem in rows.chunk_by(|a, b| a.problem == b.problem) {
        for pair in comparisons(of_problem) {
            let _infallible = writeln!(text, "* {pair}");
        }
    }
    let kept = rows.iter().filter(|row| row.bound.is_some() && row.error.is_some());
    let (broken, all) = (kept.clone().filter(|row| row.breaks_its_bound()).count(), kept.count());
    let _infallible = writeln!(
        text,
        "* Of {all} points with a tolerance or a bound {} keep it.\n",
        if broken == 0 { "all".to_owned() } else { format!("{} (of {all})", all - broken) }
    );
    text
}

/// For every point that promises nothing, how much smaller the error of the points with a promise is in the same time.
fn comparisons(rows: &[Row]) -> Vec<String> {
    let points = |promises: bool| {
        rows.iter().filter_map(move |row| {
            let known = (row.error?, row.ns_per_grain()?, row);
            (row.estimated.is_some() == promises).then_some(known)
        })
    };
    let one = |(error, time, row): (f64, f64, &Row)| {
        let (best, ..) =
            points(true).filter(|(_, ours, _)| *ours <= time).min_by(|a, b| a.0.total_cmp(&b.0))?;
        (best > 0.0 && error > 0.0).then(|| {
            format!(
                "{}: in the time of {} {} ({:.0} ns a grain, error {:.1e}) the best with a promise errs by {best:.1e}, {:.1} times less.",
                row.problem, row.method, row.value, time, error, error / best
            )
        })
    };
    points(false).filter_map(one).collect()
}

fn section(rows: &[Row], number: usize) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let mut text = format!(
        "## {}\n\n{} grains; truth: {}.\n\n![error and time](problem-{number}.svg)\n\n| method | | error | p99 | worst | bias | ns/grain | spread [%] | pairs/grain | MB | front |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
        first.problem, first.grains, first.truth
    );
    let points: Vec<(f64, f64)> =
        rows.iter().map(|row| (row.error.unwrap_or(f64::NAN), row.seconds.unwrap_or(f64::NAN))).collect();
    let best = front(&points);
    for (index, row) in rows.iter().enumerate().filter(|(_, row)| row.failure.is_empty()) {
        let small = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.1e}"));
        let plain =
            |value: Option<f64>, digits| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.digits$}"));
        let spread = row.seconds.zip(row.seconds_least.zip(row.seconds_most));
        let _infallible = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            row.method,
            row.value,
            small(row.error),
            small(row.p99),
            small(row.worst),
            small(row.bias),
            plain(row.ns_per_grain(), 0),
            plain(spread.map(|(middle, (least, most))| 100.0 * (most - least) / middle), 0),
            plain(row.pairs_per_grain, 0),
            plain(row.memory_bytes.map(|bytes| bytes as f64 / 1e6), 1),
            if best.contains(&index) { "●" } else { "" },
        );
    }
    text + "\n"
}

/// Predicted and measured error.
fn model_points(rows: &[Row]) -> Vec<(f64, f64)> {
    rows.iter().filter_map(|row| Some((row.estimated?, row.error?))).collect()
}

fn model(rows: &[Row]) -> String {
    let points = model_points(rows);
    if points.is_empty() {
        return String::new();
    }
    let within = points.iter().filter(|(model, error)| (error / model).max(model / error) <= WITHIN).count();
    let share = within as f64 / points.len() as f64;
    format!(
        "## The error model\n\n![predicted and measured error](model.svg)\n\nThe model ([equations](../equations.md#error-model)) is within a factor {WITHIN} of the measured error at {within} of {} points ({:.0} %); \
         goal {:.0} %: {}.\n\n",
        points.len(),
        100.0 * share,
        100.0 * SHARE,
        if share >= SHARE { "**met**" } else { "**missed**" }
    )
}

fn failures(rows: &[Row]) -> String {
    let mut text = "## What failed\n\n".to_owned();
    let broken = rows.iter().filter(|row| row.breaks_its_bound()).map(|row| {
        let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
        (row, format!("error {:.2e} above {:e}", number(row.error), number(row.bound)))
    });
    let failed = rows.iter().filter(|row| !row.failure.is_empty()).map(|row| (row, row.failure.clone()));
    let all: Vec<_> = failed.chain(broken).collect();
    if all.is_empty() {
        text += "Nothing.\n";
    }
    for (row, reason) in all {
        let _infallible = writeln!(text, "* {}, {} {}: {reason}", row.problem, row.method, row.value);
    }
    text
}

fn draw(folder: &Path, name: &str, rows: &[Row]) -> Result<(), StudyError> {
    let mut series: Vec<Series> = Vec::new();
    for row in rows {
        let (Some(error), Some(ns)) = (row.error, row.ns_per_grain()) else { continue };
        match series.iter_mut().find(|series| series.name == row.method) {
            Some(series) => series.points.push((error, ns)),
            None => series.push(Series { name: row.method.clone(), points: vec![(error, ns)] }),
        }
    }
    let points: Vec<(f64, f64)> =
        rows.iter().filter_map(|row| Some((row.error?, row.ns_per_grain()?))).collect();
    let title = rows.first().map_or("", |row| &row.problem);
    let ringed: Vec<(f64, f64)> = front(&points).into_iter().map(|index| points[index]).collect();
    let plot = Plot {
        title,
        x: "relative RMS error of E",
        y: "time per evaluation [ns per grain]",
        scales: [Scale::Logarithmic; 2],
        series: &series,
        ringed: &ringed,
    };
    write_both(folder, name, &plot)
}

fn draw_model(folder: &Path, rows: &[Row]) -> Result<(), StudyError> {
    let points = model_points(rows);
    let ends = points.iter().flat_map(|&(a, b)| [a, b]);
    let (low, high) = ends.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let line = |factor: f64| vec![(low, low * factor), (high, high * factor)];
    let series = [
        Series { name: "points".to_owned(), points },
        Series { name: "measured as predicted".to_owned(), points: line(1.0) },
        Series { name: format!("{WITHIN} times"), points: line(WITHIN) },
        Series { name: format!("1/{WITHIN}"), points: line(1.0 / WITHIN) },
    ];
    let plot = Plot {
        title: "The error model",
        x: "predicted relative error",
        y: "measured relative error",
        scales: [Scale::Logarithmic; 2],
        series: &series,
        ringed: &[],
    };
    write_both(folder, "model", &plot)
}

/// As SVG and PNG, unless there is nothing to draw.
fn write_both(folder: &Path, name: &str, plot: &Plot<'_>) -> Result<(), StudyError> {
    let shown = |series: &Series| series.points.iter().any(|(x, y)| *x > 0.0 && *y > 0.0);
    if !plot.series.iter().any(shown) {
        return Ok(());
    }
    write_plot(&folder.join(format!("{name}.svg")), plot)?;
    write_plot(&folder.join(format!("{name}.png")), plot)
}
