//! CSV of a field, and the report beside it.

use super::atomic::write_atomically;
use crate::SceneError;
use crate::files::{FIELD, When};
use nalgebra::Vector3;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Columns of a field CSV, all in the order of the scene's particles.
#[derive(Clone, Copy, Debug)]
pub struct FieldColumns<'a> {
    /// Ids of the particles.
    pub id: &'a [u64],
    /// Field E [V/m].
    pub e: &'a [Vector3<f64>],
    /// Potential [V], without the particle's own singular term.
    pub potential: &'a [f64],
    /// Parts of E, where they are asked for.
    pub components: Option<FieldComponents<'a>>,
}

/// Parts of E [V/m]: E = near + middle + far + correction + faces + external.
#[derive(Clone, Copy, Debug)]
pub struct FieldComponents<'a> {
    /// Field of pairs, and of their images, within the cut-off radius.
    pub near: &'a [Vector3<f64>],
    /// Field of the middle grid, only with a field solver.
    pub middle: &'a [Vector3<f64>],
    /// Smooth field of all charges.
    pub far: &'a [Vector3<f64>],
    /// Correction of what near and far count twice.
    pub correction: &'a [Vector3<f64>],
    /// Field of the potentials and normal fields of the faces.
    pub faces: &'a [Vector3<f64>],
    /// External field.
    pub external: &'a [Vector3<f64>],
}

impl<'a> FieldComponents<'a> {
    /// Parts with the names that their columns begin with, in the order of the sum.
    fn named(&self) -> [(&'static str, &'a [Vector3<f64>]); 6] {
        [
            ("near", self.near),
            ("middle", self.middle),
            ("far", self.far),
            ("correction", self.correction),
            ("faces", self.faces),
            ("external", self.external),
        ]
    }
}

/// Writes the columns of [`FIELD`]: number, E and potential, and the components if there are any.
///
/// Numbers have 17 significant digits, so that they are read back bit for bit. Each component adds three
/// columns, in the order of the sum.
///
/// # Errors
/// Errors of the operating system.
pub fn write_field_csv(path: &Path, columns: &FieldColumns<'_>) -> Result<(), SceneError> {
    let components = columns.components.map(|components| components.named());
    write_atomically(path, |writer| {
        let names = FIELD.names(|when| when == When::Always || components.is_some());
        writeln!(writer, "{}", names.collect::<Vec<_>>().join(","))?;
        for (index, id) in columns.id.iter().enumerate() {
            let e = columns.e[index];
            write!(writer, "{id},{:.16e},{:.16e},{:.16e},{:.16e}", e.x, e.y, e.z, columns.potential[index])?;
            for (_, part) in components.iter().flatten() {
                let part = part[index];
                write!(writer, ",{:.16e},{:.16e},{:.16e}", part.x, part.y, part.z)?;
            }
            writeln!(writer)?;
        }
        Ok(())
    })
}

/// Times of one stage over the repetitions [s].
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FieldReportSeconds {
    /// Smallest time [s].
    pub min: f64,
    /// Median time [s].
    pub median: f64,
}

/// Content of the JSON file beside a field CSV.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldReport {
    /// Name of the method.
    pub method: String,
    /// Parameters that were chosen.
    pub parameters: serde_json::Value,
    /// Times by stage, and `total`.
    pub seconds: BTreeMap<String, FieldReportSeconds>,
    /// Mean number of partners within the cut-off radius.
    pub pairs_per_particle: f64,
    /// Cells of the internal grid per axis; null without a grid.
    pub grid_cells: Option<[usize; 3]>,
    /// Relative RMS error by the model; null for methods that promise none.
    pub error_estimated: Option<f64>,
    /// Relative RMS error measured on a sample; null when not measured.
    pub error_measured: Option<f64>,
    /// Number of threads.
    pub threads: usize,
    /// Version of the program.
    pub version: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_the_parts_are_named_after_them() {
        let none = &[][..];
        let parts = FieldComponents {
            near: none,
            middle: none,
            far: none,
            correction: none,
            faces: none,
            external: none,
        };
        let expected = parts
            .named()
            .into_iter()
            .flat_map(|(part, _)| ["x", "y", "z"].map(|x| format!("{part}_e{x}_V_per_m")));
        let found: Vec<&str> = FIELD.names(|when| when == When::Components).collect();
        assert_eq!(found, expected.collect::<Vec<_>>());
    }
}
