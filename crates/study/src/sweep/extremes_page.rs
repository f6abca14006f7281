//! Extremes in the report.

use super::description::{Extreme, Study};
use super::extremes::{EnergyRow, ExtremeRow};
use super::page::write_both;
use crate::StudyError;
use amberfield_draw::{Plot, Scale, Series};
use std::fmt::Write as _;
use std::path::Path;

/// The part about extremes; empty without any.
pub(super) fn section(study: &Study, rows: &[ExtremeRow], energies: &[EnergyRow]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let kept = rows.iter().filter(|row| row.broken.is_empty()).count();
    let mut text = format!(
        "## What is asked, and what it says\n\nEvery scene goes through the command, as a user would send \
         it, and must end as it was said before: well (exit code 0), refused before anything runs (2), or \
         stopped by the run itself as no longer sound (4), \
         in no more than the time allowed, with the words asked for, and with no more gain and loss of \
         energy, kinetic energy per grain or error of E than stated in the study. Gain and loss are those \
         of kinetic energy, gravity, contacts and field together, over the largest energy that was turned \
         over; \
         the charge of grains and walls changes by round-off only, at most 1e-12 of the sizes of all \
         charges, unless grains may leave. Whatever is not so breaks the verdict.\n\n**{kept} of {} scenes \
         end as expected.**\n\n",
        rows.len()
    );
    for row in rows.iter().filter(|row| !row.broken.is_empty()) {
        let _infallible = writeln!(text, "* {} {}: {}", row.extreme, row.value, row.broken);
    }
    text += "\n| pushed | | expected | ended | gain | loss | charge | kinetic [J/grain] | limited | error | \
        s | as expected |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n";
    for row in rows {
        let small = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.1e}"));
        let expect = of(study, row).map_or("", |extreme| &extreme.expect);
        let _infallible = writeln!(
            text,
            "| {} | {} | {expect} | {} | {} | {} | {} | {} | {} | {} | {:.1} | {} |",
            row.extreme,
            row.value,
            row.ended,
            small(row.gain),
            small(row.loss),
            small(row.charge_drift),
            small(row.kinetic_j),
            row.limited.map_or_else(|| "–".to_owned(), |limited| limited.to_string()),
            small(row.error),
            row.seconds,
            if row.broken.is_empty() { "yes" } else { "**no**" }
        );
    }
    text += "\n## Energy over time\n\nChange of the energy since the start, over the largest that was \
        turned over.\n\n";
    for (number, of_one) in drawn(rows, energies).iter().enumerate() {
        let _infallible =
            writeln!(text, "![{}](pictures/{}-energy-{number}.svg)\n", of_one[0].extreme, study.name);
    }
    text += "## What was said\n\n";
    for row in rows.iter().filter(|row| !row.said.is_empty()) {
        let _infallible = writeln!(text, "* {} {}: `{}`", row.extreme, row.value, row.said);
    }
    text + "\n"
}

fn of<'s>(study: &'s Study, row: &ExtremeRow) -> Option<&'s Extreme> {
    study.extremes.iter().find(|extreme| extreme.name == row.extreme)
}

/// Energies that there are to draw: those of extremes that ended well with an energy that changes.
fn drawn<'e>(rows: &[ExtremeRow], energies: &'e [EnergyRow]) -> Vec<&'e [EnergyRow]> {
    let well = |name: &str| rows.iter().any(|row| row.extreme == name && row.ended == "well");
    let groups = energies.chunk_by(|a, b| a.extreme == b.extreme);
    groups
        .filter(|group| well(&group[0].extreme) && group.iter().any(|energy| energy.change != 0.0))
        .collect()
}

/// Draws energy over time.
pub(super) fn draw(
    folder: &Path,
    study: &Study,
    rows: &[ExtremeRow],
    energies: &[EnergyRow],
) -> Result<(), StudyError> {
    for (number, of_one) in drawn(rows, energies).into_iter().enumerate() {
        let curve = |of_value: &[EnergyRow]| {
            let end_s = of_value.last().map_or(0.0, |last| last.time_s);
            let points =
                of_value.iter().map(|energy| (energy.time_s / end_s.max(f64::MIN_POSITIVE), energy.change));
            Series { name: of_value[0].value.clone(), points: points.collect() }
        };
        let series: Vec<Series> = of_one.chunk_by(|a, b| a.value == b.value).map(curve).collect();
        let plot = Plot {
            title: &of_one[0].extreme,
            x: "time over that at the end",
            y: "change of the energy",
            scales: [Scale::Linear; 2],
            series: &series,
            ringed: &[],
        };
        write_both(folder, &format!("{}-energy-{number}", study.name), &plot)?;
    }
    Ok(())
}
