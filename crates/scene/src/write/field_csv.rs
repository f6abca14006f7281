//! Field CSV and the report beside it.

use super::atomic::write_atomically;
use crate::SceneError;
use nalgebra::Vector3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Columns of a field CSV, all in the order of the input.
#[derive(Clone, Copy, Debug)]
pub struct FieldColumns<'a> {
    /// Ids.
    pub id: &'a [u64],
    /// E [V/m].
    pub e: &'a [Vector3<f64>],
    /// Potential [V] without the grain's own singular term.
    pub potential: &'a [f64],
    /// Parts of E [V/m]: near, middle, far, correction.
    pub components: Option<[&'a [Vector3<f64>]; 4]>,
}

/// Writes `id,ex_V_per_m,ey_V_per_m,ez_V_per_m,potential_V` and the components if there are any, 17 significant
/// digits.
///
/// # Errors
/// What the system says.
pub fn write_field_csv(path: &Path, columns: &FieldColumns<'_>) -> Result<(), SceneError> {
    write_atomically(path, |writer| {
        write!(writer, "id,ex_V_per_m,ey_V_per_m,ez_V_per_m,potential_V")?;
        if columns.components.is_some() {
            for part in ["near", "middle", "far", "correction"] {
                write!(writer, ",{part}_ex_V_per_m,{part}_ey_V_per_m,{part}_ez_V_per_m")?;
            }
        }
        writeln!(writer)?;
        for (index, id) in columns.id.iter().enumerate() {
            let e = columns.e[index];
            write!(writer, "{id},{:.16e},{:.16e},{:.16e},{:.16e}", e.x, e.y, e.z, columns.potential[index])?;
            for part in columns.components.iter().flatten() {
                let part = part[index];
                write!(writer, ",{:.16e},{:.16e},{:.16e}", part.x, part.y, part.z)?;
            }
            writeln!(writer)?;
        }
        Ok(())
    })
}

/// Seconds of one stage over the repetitions.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldReportSeconds {
    /// Least [s].
    pub min: f64,
    /// Median [s].
    pub median: f64,
}

/// What stands in the JSON file beside a field CSV.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldReport {
    /// Method.
    pub method: String,
    /// Every parameter chosen.
    pub parameters: serde_json::Value,
    /// Per stage, and `total`.
    pub seconds: BTreeMap<String, FieldReportSeconds>,
    /// Mean number of partners within the cut-off radius.
    pub pairs_per_particle: f64,
    /// Cells of the internal grid per axis; null without a grid.
    pub grid_cells: Option<[usize; 3]>,
    /// Relative RMS error by the model; null for methods that promise none.
    pub error_estimated: Option<f64>,
    /// Relative RMS error measured on a sample; null when not measured.
    pub error_measured: Option<f64>,
    /// Threads.
    pub threads: usize,
    /// Version of the program.
    pub version: String,
}
