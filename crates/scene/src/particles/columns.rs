//! Columns of a file of grains, found by name and in any order.

use super::quantity::Quantity;
use super::row::{NO_NUMBER, Row, about_cell};
use crate::SceneError;
use crate::error::shorten;
use crate::tree::{Range, nearest};
use csv::StringRecord;

/// Columns of a file, with checked access to the values of its rows.
#[derive(Debug)]
pub(super) struct Columns {
    /// File, as the user named it.
    pub(super) file: String,
    /// Columns, in their order.
    list: Vec<Column>,
}

/// Column of a file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Column {
    /// Name in the file.
    pub(super) name: String,
    /// Name of the column that it stands for, in this project's unit; empty where it is not read.
    pub(super) known: &'static str,
    /// Factor from the file's unit to this project's.
    pub(super) factor: f64,
    /// Value in this project's unit for a zero in the file.
    pub(super) offset: f64,
}

impl Column {
    /// Column with a factor.
    pub(super) fn new(name: &str, known: &'static str, factor: f64) -> Self {
        Self { name: name.to_owned(), known, factor, offset: 0.0 }
    }

    /// Column that is not read.
    pub(super) fn unused(name: &str) -> Self {
        Self::new(name, "", 1.0)
    }

    fn named(name: &str) -> Self {
        Quantity::named(name).map_or_else(
            || Self::unused(name),
            |Quantity { name: known, factor }| Self::new(name, known, factor),
        )
    }
}

impl Columns {
    /// Columns that were found otherwise than by a header row.
    pub(super) fn of(file: &str, list: Vec<Column>) -> Self {
        Self { file: file.to_owned(), list }
    }

    /// Checks a header row.
    ///
    /// # Errors
    /// Unknown names, names given twice, and required names that are missing.
    pub(super) fn of_header(
        file: &str,
        (header, line): (&StringRecord, u64),
        known: &[&str],
        required: &[&str],
    ) -> Result<Self, SceneError> {
        let list: Vec<Column> = header.iter().map(|name| Column::named(name.trim())).collect();
        for (index, Column { name, known: meant, .. }) in list.iter().enumerate() {
            if meant.is_empty() {
                let advice = match Quantity::unit_missing(name) {
                    Some(names) => format!("; its unit is missing, write one of {names}"),
                    None => nearest(name, known)
                        .map_or_else(String::new, |near| format!("; the nearest known column is {near}")),
                };
                return Err(SceneError::data(
                    file,
                    line,
                    format!("unknown column \"{}\"{advice}", shorten(name)),
                ));
            }
            if let Some(before) = list[..index].iter().find(|column| column.known == *meant) {
                let problem = if before.name == *name {
                    format!("column {name} is there twice; remove one")
                } else {
                    format!("columns {} and {name} are both {meant}; remove one", before.name)
                };
                return Err(SceneError::data(file, line, problem));
            }
        }
        for name in required {
            if !list.iter().any(|column| column.known == *name) {
                return Err(SceneError::data(
                    file,
                    line,
                    format!("missing column {name}; the header row needs {}", required.join(",")),
                ));
            }
        }
        Ok(Self { file: file.to_owned(), list })
    }

    /// Index of the column with a name.
    pub(super) fn find(&self, name: &str) -> Option<usize> {
        self.list.iter().position(|column| column.known == name)
    }

    /// Names of the columns that are not read.
    pub(super) fn unused(&self) -> Vec<String> {
        self.list.iter().filter(|column| column.known.is_empty()).map(|column| column.name.clone()).collect()
    }

    /// Names of all columns, as the file has them.
    pub(super) fn names(&self) -> String {
        let names: Vec<String> = self.list.iter().map(|column| shorten(&column.name)).collect();
        names.join(", ")
    }

    /// Tells whether a column is in another unit than this project's.
    pub(super) fn is_converted(&self, column: usize) -> bool {
        let Column { factor, offset, .. } = &self.list[column];
        *factor != 1.0 || *offset != 0.0
    }

    /// Error about the value in a row and a column.
    pub(super) fn bad(&self, row: &impl Row, column: usize, problem: &str) -> SceneError {
        row.error(&self.file, about_cell(&self.list[column].name, &row.text(column), problem))
    }

    /// Number in a row and a column, in this project's unit.
    ///
    /// # Errors
    /// Values that are no number or out of range.
    pub(super) fn number(&self, row: &impl Row, column: usize, range: Range) -> Result<f64, SceneError> {
        let number = match row.number(column) {
            Ok(number) => number,
            Err(NO_NUMBER) => return Err(self.bad(row, column, &format!("{NO_NUMBER}; give one {range}"))),
            Err(problem) => return Err(self.bad(row, column, problem)),
        };
        let Column { known, factor, offset, .. } = &self.list[column];
        let mut number = number * factor;
        if *offset != 0.0 {
            number += offset;
        }
        if range.contains(number) {
            Ok(number)
        } else if number.is_finite() {
            let converted = if *factor == 1.0 { String::new() } else { format!(" as {known}") };
            Err(self.bad(row, column, &format!("out of range{converted}; give a number {range}")))
        } else {
            Err(self.bad(row, column, &format!("not finite; give a number {range}")))
        }
    }
}
