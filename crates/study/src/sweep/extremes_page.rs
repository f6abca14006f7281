//! Extremes in the report.

use super::description::Study;
use super::extremes::{EnergyRow, ExtremeRow};
use super::page::write_both;
use crate::StudyError;
use crate::templates::fill;
use amberfield_draw::{Plot, Scale, Series};
use minijinja::context;
use std::collections::BTreeMap;
use std::path::Path;

/// The part about extremes; empty without any.
pub(super) fn section(study: &Study, rows: &[ExtremeRow], energies: &[EnergyRow]) -> String {
    if rows.is_empty() {
        return String::new();
    }
    let kept = rows.iter().filter(|row| row.broken.is_empty()).count();
    let expected: BTreeMap<_, _> =
        study.extremes.iter().map(|extreme| (&extreme.name, &extreme.expect)).collect();
    let drawn: Vec<_> = drawn(rows, energies).iter().map(|of_one| &of_one[0].extreme).collect();
    let values = context! { kept, rows, expected, drawn, name => study.name };
    fill(include_str!("../../templates/sweep/extremes.md"), values)
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
