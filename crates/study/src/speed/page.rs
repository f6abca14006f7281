//! The page `docs/reports/speed.md`, made from rows only.

use crate::sections::{charging, coupling, dem, field, gas, kernel, lammps, open, rates, rest, scaling};
use amberfield_draw::{Plot, Scale, Series, write_plot};
use amberfield_study::Store;
use amberfield_study::machine::Machine;
use amberfield_study::templates::{fill, wrapped};
use anyhow::{Context as _, Result};
use minijinja::context;
use std::fmt;

/// A Markdown table.
#[derive(Debug)]
pub(crate) struct Table(String);

impl Table {
    pub(crate) fn new(head: &[&str]) -> Self {
        Self(format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len())))
    }

    pub(crate) fn row(&mut self, cells: &[String]) {
        self.0 += &format!("| {} |\n", cells.join(" | "));
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// A number with so many decimals, or a dash.
pub(crate) fn figure(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| "–".to_owned(), |value| format!("{value:.decimals$}"))
}

/// Draws a picture of the report unless there is nothing to draw.
pub(crate) fn plot(store: &Store, name: &str, title: &str, axes: [&str; 2], all: &[Series]) -> Result<()> {
    let series: Vec<Series> = all.iter().filter(|series| !series.points.is_empty()).cloned().collect();
    if series.is_empty() {
        return Ok(());
    }
    let plot =
        Plot { title, x: axes[0], y: axes[1], scales: [Scale::Logarithmic; 2], series: &series, ringed: &[] };
    Ok(write_plot(&store.path(&format!("pictures/{name}.svg")), &plot)?)
}

/// Writes the page from the newest rows of every section.
pub(crate) fn write(store: &Store) -> Result<()> {
    let parts = [
        field::report(store)?,
        open::report(store)?,
        kernel::report(store)?,
        dem::report(store)?,
        rest::report(store)?,
        rates::report(store)?,
        scaling::report(store)?,
        coupling::report(store)?,
        charging::report(store)?,
        gas::report(store)?,
        lammps::report(store)?,
    ];
    let (date, machines) = store.newest::<Machine>("machine")?.unwrap_or_default();
    let mut page = fill(include_str!("../../templates/speed/page.md"), context! { date, machines });
    page += &parts.into_iter().flatten().collect::<Vec<_>>().join("\n");
    let notes = store.path("notes.md");
    if notes.exists() {
        page += "\n";
        page += &std::fs::read_to_string(&notes)?;
    }
    let path = store.path("speed.md");
    std::fs::write(&path, wrapped(&page)).with_context(|| format!("cannot write {}", path.display()))
}
