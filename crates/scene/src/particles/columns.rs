//! Columns of a particles CSV: by name, in any order.

use crate::SceneError;
use crate::error::shorten;
use crate::tree::{Range, nearest};
use csv::StringRecord;

/// A data file that is read by columns.
pub(super) struct Columns<'f> {
    file: &'f str,
    header: Vec<String>,
}

impl<'f> Columns<'f> {
    /// The header row.
    ///
    /// # Errors
    /// Names that are not known or given twice, required names that are missing.
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

    /// Index of a column.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column == name)
    }

    /// Name of a column.
    pub(super) fn name(&self, column: usize) -> &str {
        &self.header[column]
    }

    /// Error about a value of a row.
    pub(super) fn bad(&self, record: &StringRecord, column: usize, problem: &str) -> SceneError {
        let value = shorten(record.get(column).unwrap_or_default());
        SceneError::data(self.file, line(record), format!("{} = \"{value}\": {problem}", self.name(column)))
    }

    /// The number in a column.
    ///
    /// # Errors
    /// No number, a number out of range.
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

/// Error of the csv crate in our words.
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
