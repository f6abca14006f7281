//! The report: tables, plots and conclusions, from rows only.

use super::comparison::{Comparison, Verdict, comparisons, verdict};
use super::description::{Goal, Study};
use super::extremes::{EnergyRow, ExtremeRow};
use super::extremes_page;
use super::front::front;
use super::motion::MotionRow;
use super::motion_page;
use super::row::Row;
use crate::StudyError;
use crate::templates::{fill, wrapped};
use amberfield_draw::{Plot, Scale, Series, write_plot};
use minijinja::context;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Factor within which the a-priori model is said to be right.
const WITHIN: f64 = 2.0;
/// Share of the points at which it should be.
const SHARE: f64 = 0.9;

/// Results of a study.
#[derive(Clone, Debug, Default)]
pub struct Results {
    /// Points.
    pub points: Vec<Row>,
    /// Whole runs.
    pub motions: Vec<MotionRow>,
    /// Scenes pushed to an end.
    pub extremes: Vec<ExtremeRow>,
    /// Energies of the extremes over time.
    pub energies: Vec<EnergyRow>,
}

/// Writes the page of a study and its pictures (SVG and PNG) into a folder; rows in the order of the study,
/// those of other problems are left out. Where the page is.
///
/// # Errors
/// A file that cannot be written.
pub fn write_report(
    folder: &Path,
    study: &Study,
    results: &Results,
    repeat: &str,
) -> Result<PathBuf, StudyError> {
    // A swept problem has its value behind its name.
    let known = |row: &&Row| study.problems.iter().any(|problem| row.problem.starts_with(&problem.name));
    let rows: Vec<Row> = results.points.iter().filter(known).cloned().collect();
    let known = |row: &&MotionRow| study.motions.iter().any(|motion| row.problem == motion.name);
    let motions: Vec<MotionRow> = results.motions.iter().filter(known).cloned().collect();
    let (rows, motions) = (&rows[..], &motions[..]);
    let (extremes, energies) = (&results.extremes[..], &results.energies[..]);
    let pictures = folder.join("pictures");
    std::fs::create_dir_all(&pictures)
        .map_err(|source| StudyError::Write { path: pictures.clone(), source })?;
    let name = &study.name;
    let mut page = format!("# {}\n\n{}", study.title, setting(study, results, repeat));
    if !rows.is_empty() {
        page += &conclusions(study, rows);
    }
    for (number, of_problem) in rows.chunk_by(|a, b| a.problem == b.problem).enumerate() {
        let picture = format!("{name}-{number}");
        draw(&pictures, &picture, of_problem)?;
        page += &section(of_problem, &picture);
    }
    motion_page::draw(&pictures, motions, name)?;
    page += &motion_page::section(motions, name);
    extremes_page::draw(&pictures, study, extremes, energies)?;
    page += &extremes_page::section(study, extremes, energies);
    let picture = format!("{name}-model");
    draw_model(&pictures, &picture, rows)?;
    page += &model(rows, &picture);
    if extremes.is_empty() {
        page += &failures(rows, motions);
    }
    if !rows.is_empty() {
        page += &fill(include_str!("../../templates/sweep/bias.md"), context! {});
    }
    let path = folder.join(format!("{name}.md"));
    std::fs::write(&path, wrapped(&page))
        .map_err(|source| StudyError::Write { path: path.clone(), source })?;
    Ok(path)
}

/// Date, commit and machine of the rows; every combination stands once, for rows may be added on another
/// machine.
fn measured(results: &Results) -> String {
    let points = results.points.iter().map(|row| (&row.date, &row.version, &row.processor, row.threads));
    let motions = results.motions.iter().map(|row| (&row.date, &row.version, &row.processor, row.threads));
    let extremes = results.extremes.iter().map(|row| (&row.date, &row.version, &row.processor, row.threads));
    let mut seen: Vec<String> = Vec::new();
    for (date, version, processor, threads) in points.chain(motions).chain(extremes) {
        let plural = if threads == 1 { "" } else { "s" };
        let text = format!("{date} with amberfield {version} on {processor}, {threads} thread{plural}");
        if !seen.contains(&text) {
            seen.push(text);
        }
    }
    seen.join("; ")
}

fn setting(study: &Study, results: &Results, repeat: &str) -> String {
    let rows = &results.points;
    let measured = measured(results);
    if measured.is_empty() {
        return measured;
    }
    let template = include_str!("../../templates/sweep/setting.md");
    let values = context! {
        measured,
        repeat,
        points => !rows.is_empty(),
        date => rows.first().map(|row| &row.date),
        name => study.name,
        passes => study.passes,
        least_s => study.least_s,
    };
    fill(template, values)
}

/// Goal with what became of it, as the template wants it.
#[derive(Serialize)]
struct JudgedGoal<'a> {
    text: &'a str,
    verdict: Option<Verdict>,
    /// Attempts that did not reach the goal, where it is missed.
    tried: Option<&'a str>,
}

impl<'a> JudgedGoal<'a> {
    fn new(goal: &'a Goal, rows: &[Row]) -> Self {
        let verdict = verdict(goal, rows);
        let missed = verdict.as_ref().is_some_and(|verdict| verdict.missed > 0);
        Self { text: &goal.text, verdict, tried: goal.tried.as_deref().filter(|_| missed) }
    }
}

/// Point without a promise beside the best with one, as the template wants it.
#[derive(Serialize)]
struct ComparedPoint<'a> {
    problem: &'a str,
    method: &'a str,
    value: &'a str,
    error: f64,
    ns: f64,
    in_time: Option<f64>,
    times_less: Option<f64>,
    as_exact: Option<f64>,
    times_as_fast: Option<f64>,
}

impl<'a> ComparedPoint<'a> {
    fn new(Comparison { row, error, ns, in_time, as_exact }: Comparison<'a>) -> Self {
        Self {
            problem: &row.problem,
            method: &row.method,
            value: &row.value,
            error,
            ns,
            in_time,
            times_less: in_time.map(|best| error / best),
            as_exact,
            times_as_fast: as_exact.map(|other| ns / other),
        }
    }
}

/// Conclusions from the rows, in words.
fn conclusions(study: &Study, rows: &[Row]) -> String {
    let bounded = rows.iter().filter(|row| row.bound().is_some() && row.error.is_some());
    let kept = bounded.clone().filter(|row| !row.breaks_its_bound()).count();
    let goals: Vec<_> = study.goals.iter().map(|goal| JudgedGoal::new(goal, rows)).collect();
    let of_problems = rows.chunk_by(|a, b| a.problem == b.problem);
    let points: Vec<_> = of_problems.flat_map(comparisons).map(ComparedPoint::new).collect();
    let template = include_str!("../../templates/sweep/conclusions.md");
    fill(template, context! { goals, points, kept, bounded => bounded.count() })
}

/// Point with what follows from its row, as the template wants it.
#[derive(Serialize)]
struct ShownPoint<'a> {
    row: &'a Row,
    ns_per_grain: Option<f64>,
    /// Spread of the turns over the time [%].
    spread_percent: Option<f64>,
    megabytes: Option<f64>,
    on_front: bool,
}

/// Section about a problem.
fn section(rows: &[Row], picture: &str) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let points: Vec<(f64, f64)> =
        rows.iter().map(|row| (row.error.unwrap_or(f64::NAN), row.seconds.unwrap_or(f64::NAN))).collect();
    let best = front(&points);
    let shown = |index: usize| {
        let row = &rows[index];
        let spread = row.seconds.zip(row.seconds_least.zip(row.seconds_most));
        ShownPoint {
            row,
            ns_per_grain: row.ns_per_grain(),
            spread_percent: spread.map(|(middle, (least, most))| 100.0 * (most - least) / middle),
            megabytes: row.memory_bytes.map(|bytes| bytes as f64 / 1e6),
            on_front: best.contains(&index),
        }
    };
    let sound = (0..rows.len()).filter(|&index| rows[index].failure.is_empty());
    let points: Vec<_> = sound.map(shown).collect();
    let values = context! {
        problem => first.problem,
        grains => first.grains,
        truth => first.truth,
        drawn => is_drawn(rows),
        picture,
        points,
    };
    fill(include_str!("../../templates/sweep/problem.md"), values)
}

/// Predicted and measured error.
fn model_points(rows: &[Row]) -> Vec<(f64, f64)> {
    rows.iter().filter_map(|row| Some((row.estimated?, row.error?))).collect()
}

fn model(rows: &[Row], picture: &str) -> String {
    let points = model_points(rows);
    if points.is_empty() {
        return String::new();
    }
    let within = points.iter().filter(|(model, error)| (error / model).max(model / error) <= WITHIN).count();
    let share = within as f64 / points.len() as f64;
    let values = context! {
        picture,
        factor => WITHIN,
        within,
        points => points.len(),
        percent => 100.0 * share,
        goal_percent => 100.0 * SHARE,
        met => share >= SHARE,
    };
    fill(include_str!("../../templates/sweep/model.md"), values)
}

/// Point or run that failed, or whose error is above its bound.
#[derive(Serialize)]
struct FailedPoint<'a> {
    problem: &'a str,
    method: &'a str,
    value: &'a str,
    reason: String,
}

fn failures(rows: &[Row], motions: &[MotionRow]) -> String {
    let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
    let failed = rows.iter().map(|row| FailedPoint {
        problem: &row.problem,
        method: &row.method,
        value: &row.value,
        reason: row.failure.clone(),
    });
    let of_motions = motions.iter().map(|row| FailedPoint {
        problem: &row.problem,
        method: &row.method,
        value: &row.value,
        reason: row.failure.clone(),
    });
    let broken = rows.iter().filter(|row| row.breaks_its_bound()).map(|row| FailedPoint {
        problem: &row.problem,
        method: &row.method,
        value: &row.value,
        reason: format!("error {:.2e} above {:e}", number(row.error), number(row.bound())),
    });
    let failures: Vec<_> =
        failed.chain(of_motions).filter(|point| !point.reason.is_empty()).chain(broken).collect();
    fill(include_str!("../../templates/sweep/failures.md"), context! { failures })
}

/// Whether there is anything to draw.
fn is_drawn(rows: &[Row]) -> bool {
    rows.iter().any(|row| row.error.is_some_and(|error| error > 0.0) && row.seconds.is_some())
}

fn draw(folder: &Path, name: &str, rows: &[Row]) -> Result<(), StudyError> {
    if !is_drawn(rows) {
        return Ok(());
    }
    let point = |row: &Row| Some((row.error?, row.ns_per_grain()?));
    let series = by_method(rows.iter().filter_map(|row| Some((row.method.as_str(), point(row)?))));
    let points: Vec<(f64, f64)> = rows.iter().filter_map(point).collect();
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

/// A curve for each method, in the order in which they come.
pub(super) fn by_method<'r>(points: impl Iterator<Item = (&'r str, (f64, f64))>) -> Vec<Series> {
    let mut series: Vec<Series> = Vec::new();
    for (name, point) in points {
        match series.iter_mut().find(|series| series.name == name) {
            Some(series) => series.points.push(point),
            None => series.push(Series { name: name.to_owned(), points: vec![point] }),
        }
    }
    series
}

fn draw_model(folder: &Path, name: &str, rows: &[Row]) -> Result<(), StudyError> {
    let points = model_points(rows);
    if points.is_empty() {
        return Ok(());
    }
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
    write_both(folder, name, &plot)
}

/// Writes a plot as SVG and as PNG.
pub(super) fn write_both(folder: &Path, name: &str, plot: &Plot<'_>) -> Result<(), StudyError> {
    write_plot(&folder.join(format!("{name}.svg")), plot)?;
    Ok(write_plot(&folder.join(format!("{name}.png")), plot)?)
}
