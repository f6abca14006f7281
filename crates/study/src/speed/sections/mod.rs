//! Sections, each with a file of its own: what it measures, its rows and its part of the page.

pub(crate) mod charging;
pub(crate) mod coupling;
pub(crate) mod dem;
pub(crate) mod field;
pub(crate) mod gas;
pub(crate) mod kernel;
pub(crate) mod lammps;
pub(crate) mod open;
mod peak;
pub(crate) mod rates;
pub(crate) mod rest;
pub(crate) mod scaling;

use anyhow::{Context as _, Result, ensure};
use std::path::Path;

/// Replaces texts of a file, which must be there.
fn change_file(path: &Path, texts: &[(&str, &str)]) -> Result<()> {
    let mut text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    for (from, to) in texts {
        ensure!(text.contains(from), "{} has no {from}", path.display());
        text = text.replace(from, to);
    }
    Ok(std::fs::write(path, text)?)
}
