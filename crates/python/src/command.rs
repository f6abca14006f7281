//! Command line of the package.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Exit code of the command `amberfield` with these arguments, of which the first is its name.
#[pyfunction]
pub(crate) fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| amberfield_cli::command(arguments))
}
