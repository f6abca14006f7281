//! Native half of the Python package `amberfield`: it takes and gives numpy arrays and texts. What users see
//! stands in `python/amberfield`.
#![forbid(unsafe_code)]

mod arrays;
mod errors;
mod field;
mod host_log;
mod run;
mod threads;

use pyo3::prelude::*;

/// Native functions and types of the package.
#[pymodule(name = "_native")]
mod native {
    #[pymodule_export]
    use super::command;
    #[pymodule_export]
    use super::field::NativeField;
    #[pymodule_export]
    use super::run::run;
}

/// Exit code of the command `amberfield` with these arguments, of which the first is its name.
#[pyfunction]
fn command(py: Python<'_>, arguments: Vec<std::ffi::OsString>) -> u8 {
    py.detach(|| amberfield_cli::command(arguments))
}
