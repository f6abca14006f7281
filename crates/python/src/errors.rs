//! Exceptions: failures of the program as Python's.

use amberfield_cli::Failure;
use amberfield_scene::SceneError;
use pyo3::prelude::*;

/// Exit code of bad input.
const BAD_INPUT: u8 = 2;

/// Exception of a failure, of the class that stands for its exit code.
pub(crate) fn of_failure(py: Python<'_>, failure: &Failure) -> PyErr {
    exception(py, failure.code(), failure.message())
}

/// Exception of a scene that cannot be read.
pub(crate) fn of_scene(py: Python<'_>, error: &SceneError) -> PyErr {
    exception(py, BAD_INPUT, &error.to_string())
}

/// Exception of input that is bad.
pub(crate) fn bad_input(py: Python<'_>, message: &str) -> PyErr {
    exception(py, BAD_INPUT, message)
}

/// Exception with the code and the text that the command line would end with.
fn exception(py: Python<'_>, code: u8, message: &str) -> PyErr {
    let made = py
        .import("amberfield._errors")
        .and_then(|module| module.getattr("of_code"))
        .and_then(|of_code| of_code.call1((code, message)));
    match made {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}
