//! Electric field of charges that Python holds.

use crate::{arrays, errors, host_log, threads};
use amberfield_cli::{Failure, parameters};
use amberfield_core::{Domain, FieldSettings, Method};
use amberfield_field::{ElectricField, FieldError, FieldValues, Wanted};
use amberfield_scene::parse_field_settings;
use numpy::{IntoPyArray as _, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// Field of one scene: settings, and, from the first charges on, the parameters that were chosen for them.
#[pyclass(name = "NativeField", subclass)]
pub(crate) struct NativeField {
    domain: Domain,
    settings: FieldSettings,
    field: Option<ElectricField>,
    /// Number of charges of the last evaluation, and the time that it took.
    last: Option<(usize, Duration)>,
}

#[pymethods]
impl NativeField {
    /// Reads the settings: TOML with `[domain]` and `[electric_field]`.
    #[new]
    fn new(py: Python<'_>, settings: &str) -> PyResult<Self> {
        let (domain, settings) =
            parse_field_settings(settings).map_err(|error| errors::of_scene(py, &error))?;
        // For one snapshot there is no other work that could be done beside a solver's.
        Ok(Self { domain, settings: FieldSettings { overlap: false, ..settings }, field: None, last: None })
    }

    /// Computes the field at charges: a dict of arrays.
    #[pyo3(signature = (positions, charges, potential, components, thread_count))]
    fn evaluate<'py>(
        &mut self,
        py: Python<'py>,
        positions: PyReadonlyArray2<'_, f64>,
        charges: PyReadonlyArray1<'_, f64>,
        potential: bool,
        components: bool,
        thread_count: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let positions = arrays::rows(py, "positions", &positions)?;
        let charges = arrays::numbers(py, "charges", &charges)?;
        check_lengths(py, positions.len(), charges.len())?;
        host_log::log();
        let pool = threads::pool(py, thread_count)?;
        let wanted = Wanted { potential, components };
        let (domain, settings, slot) = (&self.domain, &self.settings, &mut self.field);
        let work = || -> Result<FieldValues, FieldError> {
            let wrapped: Vec<_>;
            // p3m wraps what it is given.
            let is_wrapped_there = slot.is_some() && settings.method == Method::P3m;
            let positions =
                if is_wrapped_there || positions.par_iter().all(|place| domain.wrap(*place) == *place) {
                    positions
                } else {
                    wrapped = positions.par_iter().map(|place| domain.wrap(*place)).collect();
                    &wrapped
                };
            let field = match slot {
                Some(field) => field,
                empty => empty.insert(ElectricField::new(domain, settings, positions, charges)?),
            };
            let mut values = FieldValues::default();
            field.evaluate(positions, charges, wanted, &mut values)?;
            Ok(values)
        };
        let count = charges.len();
        let is_short = self.last.is_some_and(|(most, time)| count <= most && threads::is_short(time));
        let begun = Instant::now();
        let done = if is_short {
            Ok(threads::work_shortly(py, &pool, work))
        } else {
            threads::work(py, &pool, work, |_, _| Ok(()))
        };
        self.last = Some((count, begun.elapsed()));
        host_log::tell(py)?;
        let values = done?.map_err(|error| errors::of_failure(py, &Failure::of_field(&error)))?;
        dict_of(py, values, wanted)
    }

    /// Measures the relative RMS error of E on a sample; `None` for methods that make no promise and for sums
    /// that are exact.
    fn measure_error(
        &mut self,
        py: Python<'_>,
        positions: PyReadonlyArray2<'_, f64>,
        charges: PyReadonlyArray1<'_, f64>,
        thread_count: Option<usize>,
    ) -> PyResult<Option<f64>> {
        let positions = arrays::rows(py, "positions", &positions)?;
        let charges = arrays::numbers(py, "charges", &charges)?;
        check_lengths(py, positions.len(), charges.len())?;
        let Some(field) = &mut self.field else { return Ok(None) };
        let pool = threads::pool(py, thread_count)?;
        let domain = &self.domain;
        let work = || {
            let positions: Vec<_> = positions.par_iter().map(|place| domain.wrap(*place)).collect();
            field.measure_error(&positions, charges)
        };
        let done = threads::work(py, &pool, work, |_, _| Ok(()))?;
        let measured = done.map_err(|error| errors::of_failure(py, &Failure::of_field(&error)))?;
        Ok(measured.map(|measured| measured.relative_rms))
    }

    /// Error that was measured last.
    #[getter]
    fn error_measured(&self) -> Option<f64> {
        self.field.as_ref()?.error_measured().map(|measured| measured.relative_rms)
    }

    /// Error that the model estimates for the parameters.
    #[getter]
    fn error_estimated(&self) -> Option<f64> {
        self.field.as_ref()?.error_estimated()
    }

    /// Tolerance that was asked for, if the method keeps one.
    #[getter]
    fn tolerance(&self) -> Option<f64> {
        (self.settings.method == Method::P3m).then_some(self.settings.tolerance)
    }

    /// Parameters in force, as JSON; `None` before the first charges.
    #[getter]
    fn parameters(&self) -> Option<String> {
        self.field.as_ref().map(|field| parameters(field.choice()).to_string())
    }

    /// Seconds of each stage of the last evaluation.
    #[getter]
    fn seconds(&self) -> Vec<(&'static str, f64)> {
        self.field.as_ref().map_or_else(Vec::new, |field| field.statistics().seconds)
    }
}

/// Refuses charges that are not one for each position.
fn check_lengths(py: Python<'_>, positions: usize, charges: usize) -> PyResult<()> {
    if positions == charges {
        return Ok(());
    }
    let message = format!("charges: there are {charges} for {positions} positions; give one for each");
    Err(errors::bad_input(py, &message))
}

/// Arrays of a field by their names.
fn dict_of(py: Python<'_>, values: FieldValues, wanted: Wanted) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("e", arrays::vectors(py, values.e))?;
    if wanted.potential {
        dict.set_item("potential", values.potential.into_pyarray(py))?;
    }
    if wanted.components {
        let parts = values.components;
        for (name, part) in [
            ("near", parts.near),
            ("middle", parts.middle),
            ("far", parts.far),
            ("correction", parts.correction),
            ("faces", parts.faces),
            ("external", parts.external),
        ] {
            dict.set_item(name, arrays::vectors(py, part))?;
        }
    }
    Ok(dict)
}
