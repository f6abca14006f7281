//! Native half of the Python package `amberfield`: it takes and gives numpy arrays and texts. What users see
//! stands in `python/amberfield`.
#![forbid(unsafe_code)]

mod arrays;
mod command;
mod errors;
mod field;
mod host_log;
mod run;
mod snapshot;
mod threads;

/// Native functions and types of the package.
#[pyo3::pymodule(name = "_native")]
mod native {
    #[pymodule_export]
    use super::command::command;
    #[pymodule_export]
    use super::field::NativeField;
    #[pymodule_export]
    use super::run::run;
    #[pymodule_export]
    use super::snapshot::{outline, read_snapshot, write_snapshot};
}
