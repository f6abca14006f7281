//! Columns of a particles CSV, found by name and in any order.

use super::quantity::Quantity;
use crate::SceneError;
use crate::error::shorten;
use crate::tree::{Range, nearest};
use csv::StringRecord;

/// Header of a CSV file, with checked access to the values of its rows.
pub(super) struct CsvColumns<'f> {
    /// File, as the user named it.
    file: &'f str,
    /// Columns, in their order.
    header: Vec<Column>,
}

/// Column of a file.
struct Column {
    /// Name in the file.
    name: String,
    /// Name of the column that it stands for, in this project's unit.
    known: String,
    /// Factor from the file's unit to this project's.
    factor: f64,
}

impl<'f> CsvColumns<'f> {
    /// Checks a header row.
    ///
    /// # Errors
    /// Unknown names, names given twice, and required names that are missing.
    pub(super) fn new(
        file: &'f str,
        header: &StringRecord,
        known: &[&str],
        required: &[&str],
    ) -> Result<Self, SceneError> {
        let header: Vec<Column> = header.iter().map(|name| Column::new(name.trim())).collect();
        for (index, Column { name, known: meant, .. }) in header.iter().enumerate() {
            if !known.contains(&meant.as_str()) {
                let advice = match Quantity::unit_missing(name) {
                    Some(names) => format!("; its unit is missing, write one of {names}"),
                    None => nearest(name, known)
                        .map_or_else(String::new, |near| format!("; the nearest known column is {near}")),
                };
                return Err(SceneError::data(
                    file,
                    1,
                    format!("unknown column \"{}\"{advice}", shorten(name)),
                ));
            }
            if let Some(before) = header[..index].iter().find(|column| column.known == *meant) {
                let problem = if before.name == *name {
                    format!("column {name} is there twice; remove one")
                } else {
                    format!("columns {} and {name} are both {meant}; remove one", before.name)
                };
                return Err(SceneError::data(file, 1, problem));
            }
        }
        for name in required {
            if !header.iter().any(|column| column.known == *name) {
                return Err(SceneError::data(
                    file,
                    1,
                    format!("missing column {name}; the header row needs {}", required.join(",")),
                ));
            }
        }
        Ok(Self { file, header })
    }

    /// Index of the column with a name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column.known == name)
    }

    /// Name of the column with an index.
    pub(super) fn name(&self, column: usize) -> &str {
        &self.header[column].name
    }

    /// Error about the value in a row and a column.
    pub(super) fn bad(&self, record: &StringRecord, column: usize, problem: &str) -> SceneError {
        let value = shorten(record.get(column).unwrap_or_default());
        SceneError::data(self.file, line(record), format!("{} = \"{value}\": {problem}", self.name(column)))
    }

    /// Number in a row and a column.
    ///
    /// # Errors
    /// Values that are no number or out of range.
    pub(super) fn number(
        &self,
        record: &StringRecord,
        column: usize,
        range: Range,
    ) -> Result<f64, SceneError> {
        let text = record.get(column).unwrap_or_default().trim();
        let Ok(number) = text.parse::<f64>() else {
            return Err(self.bad(record, column, &format!("not a number; give one {range}")));
        };
        let Column { known, factor, .. } = &self.header[column];
        let number = number * factor;
        if range.contains(number) {
            Ok(number)
        } else if number.is_finite() {
            let converted = if *factor == 1.0 { String::new() } else { format!(" as {known}") };
            Err(self.bad(record, column, &format!("out of range{converted}; give a number {range}")))
        } else {
            Err(self.bad(record, column, &format!("not finite; give a number {range}")))
        }
    }
}

impl Column {
    fn new(name: &str) -> Self {
        match Quantity::named(name) {
            Some(Quantity { name: known, factor }) => {
                Self { name: name.to_owned(), known: known.to_owned(), factor }
            }
            None => Self { name: name.to_owned(), known: name.to_owned(), factor: 1.0 },
        }
    }
}

/// Line on which a record starts, from 1.
pub(super) fn line(record: &StringRecord) -> u64 {
    record.position().map_or(0, csv::Position::line)
}

/// Translates an error of the csv library into one of this crate.
pub(super) fn csv_error(file: &str, error: &csv::Error) -> SceneError {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => SceneError::data(
            file,
            pos.as_ref().map_or(0, csv::Position::line),
            format!("{len} values in a row of {expected_len} columns; give one value per column"),
        ),
        _ => SceneError::data(file, error.position().map_or(0, csv::Position::line), error.to_string()),
    }
}
