//! Arrays of numpy and those of the crates, without copies where their layouts agree.

use crate::errors;
use amberfield_core::Vector3;
use numpy::{IntoPyArray as _, PyArray2, PyReadonlyArray1, PyReadonlyArray2, ndarray::Array2};
use pyo3::prelude::*;

/// Rows of a C-contiguous array of shape (n, 3), in place.
pub(crate) fn rows<'a>(
    py: Python<'_>,
    name: &str,
    array: &'a PyReadonlyArray2<'_, f64>,
) -> PyResult<&'a [Vector3<f64>]> {
    let shape = array.as_array().dim();
    if shape.1 != 3 {
        let message = format!("{name}: its shape is {shape:?}; give an array of shape (n, 3)");
        return Err(errors::bad_input(py, &message));
    }
    let flat = array.as_slice().map_err(|error| errors::bad_input(py, &format!("{name}: {error}")))?;
    Ok(bytemuck::cast_slice(flat))
}

/// Numbers of a C-contiguous array of shape (n,), in place.
pub(crate) fn numbers<'a>(
    py: Python<'_>,
    name: &str,
    array: &'a PyReadonlyArray1<'_, f64>,
) -> PyResult<&'a [f64]> {
    array.as_slice().map_err(|error| errors::bad_input(py, &format!("{name}: {error}")))
}

/// Array of shape (n, 3) that takes vectors over without copying them.
pub(crate) fn vectors(py: Python<'_>, vectors: Vec<Vector3<f64>>) -> Bound<'_, PyArray2<f64>> {
    let shape = (vectors.len(), 3);
    let flat: Vec<f64> = bytemuck::allocation::cast_vec(vectors);
    Array2::from_shape_vec(shape, flat).expect("three numbers a row").into_pyarray(py)
}
