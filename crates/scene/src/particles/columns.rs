//! Columns of a particles CSV, found by name and in any order.

use crate::SceneError;
use crate::error::shorten;
use crate::tree::{Range, nearest};
use csv::StringRecord;

/// Header of a CSV file, with checked access to the values of its rows.
pub(super) struct CsvColumns<'f> {
    /// File, as the user named it.
    file: &'f str,
    /// Names of the columns, in their order.
    header: Vec<String>,
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
        let header: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        for (index, name) in header.iter().enumerate() {
            if !known.contains(&name.as_str()) {
                let advice = nearest(name, known)
                    .map_or_else(String::new, |near| format!("; the nearest known column is {near}"));
                return Err(SceneError::data(
                    file,
                    1,
                    format!("unknown column \"{}\"{advice}", shorten(name)),
                ));
            }
            if header[..index].contains(name) {
                return Err(SceneError::data(file, 1, format!("column {name} is there twice; remove one")));
            }
        }
        for name in required {
            if !header.iter().any(|column| column == name) {
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
        self.header.iter().position(|column| column == name)
    }

    /// Name of the column with an index.
    pub(super) fn name(&self, column: usize) -> &str {
        &self.header[column]
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
        if range.contains(number) {
            Ok(number)
        } else if number.is_finite() {
            Err(self.bad(record, column, &format!("out of range; give a number {range}")))
        } else {
            Err(self.bad(record, column, &format!("not finite; give a number {range}")))
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
