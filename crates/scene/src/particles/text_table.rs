//! Table in a text: a header row, then a row for each grain, in one of the usual dialects.
//!
//! Cells are separated by commas, semicolons, tabs or blanks, which the header row tells. Lines that begin
//! with `#` are comments. A decimal comma is read where commas separate no cells.

use super::columns::Columns;
use super::grains::{Gathering, GrainContext};
use super::names::MaterialNames;
use super::row::{DecimalSign, TextRow, line};
use super::snapshot::Snapshot;
use super::words::{Lines, Words, cut_off, other_count};
use crate::SceneError;
use crate::limits::CHARGE;
use csv::{Position, StringRecord};
use std::cell::Cell;
use std::io::BufRead;

/// Columns of a table of grains.
const COLUMNS: [&str; 16] = [
    "id",
    "x_m",
    "y_m",
    "z_m",
    "radius_m",
    "charge_C",
    "vx_m_s",
    "vy_m_s",
    "vz_m_s",
    "wx_rad_s",
    "wy_rad_s",
    "wz_rad_s",
    "density_kg_m3",
    "mass_kg",
    "material",
    "group",
];
/// Columns that the grains of a scene need.
const OF_SCENE: [&str; 5] = ["id", "x_m", "y_m", "z_m", "radius_m"];
/// Columns that a snapshot needs.
const OF_SNAPSHOT: [&str; 3] = ["x_m", "y_m", "z_m"];

/// Sign that begins a comment.
pub(super) const COMMENT: u8 = b'#';

/// Sign between cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Separator {
    /// Comma, semicolon or tab.
    Sign(u8),
    /// Any number of blanks and tabs.
    Blanks,
}

impl Separator {
    /// Separator of a table by the first bytes of its file: that of its header row.
    fn of(head: &[u8]) -> Self {
        let lines = head.split(|byte| matches!(byte, b'\n' | b'\r'));
        let header = lines.map(<[u8]>::trim_ascii).find(|line| !line.is_empty() && line[0] != COMMENT);
        let header = header.unwrap_or_default();
        let signs = [b';', b',', b'\t'];
        match signs.into_iter().find(|sign| header.contains(sign)) {
            Some(b'\t') if header.contains(&b' ') => Self::Blanks,
            Some(sign) => Self::Sign(sign),
            None if header.contains(&b' ') => Self::Blanks,
            None => Self::Sign(b','),
        }
    }

    fn decimal(self) -> DecimalSign {
        if self == Self::Sign(b',') { DecimalSign::Point } else { DecimalSign::Either(Cell::new(None)) }
    }
}

/// Rows of a table, whatever separates its cells.
enum Rows<R> {
    Separated(Box<csv::Reader<R>>),
    Words(Words<R>),
}

impl<R: BufRead> Rows<R> {
    fn new(file: &str, separator: Separator, reader: R) -> Self {
        match separator {
            Separator::Sign(sign) => {
                let mut builder = csv::ReaderBuilder::new();
                builder.flexible(false).has_headers(false).delimiter(sign).comment(Some(COMMENT));
                Self::Separated(Box::new(builder.from_reader(reader)))
            }
            Separator::Blanks => Self::Words(Words::new(Lines::new(file, reader), Some(COMMENT), None)),
        }
    }

    /// Reads a row into a record; `false` at the end of the file.
    fn read(&mut self, file: &str, record: &mut StringRecord) -> Result<bool, SceneError> {
        match self {
            Self::Separated(reader) => {
                let found = reader.read_record(record).map_err(|error| csv_error(file, &error))?;
                // The library counts from where comments before the row begin.
                let last = reader.position().line().saturating_sub(1);
                let mut position = record.position().cloned().unwrap_or_else(Position::new);
                position.set_line(position.line().max(last));
                record.set_position(Some(position));
                Ok(found)
            }
            Self::Words(words) => words.read(record),
        }
    }
}

/// Table of which the header row was read.
struct TextTable<R> {
    rows: Rows<R>,
    decimal: DecimalSign,
    header: StringRecord,
}

impl<R: BufRead> TextTable<R> {
    /// Reads the header row; `head` is what the file begins with.
    fn open(file: &str, head: &[u8], reader: R) -> Result<Self, SceneError> {
        let separator = Separator::of(head);
        let mut rows = Rows::new(file, separator, reader);
        let mut header = StringRecord::new();
        rows.read(file, &mut header)?;
        Ok(Self { rows, decimal: separator.decimal(), header })
    }

    fn columns(&self, file: &str, required: &[&str]) -> Result<Columns, SceneError> {
        Columns::of_header(file, (&self.header, line(&self.header).max(1)), &COLUMNS, required)
    }
}

/// Reads a table of grains, row by row: a file of 10⁷ grains is as large as the grains.
///
/// # Errors
/// Bad header, bad values, duplicate ids, grains outside the domain: with line, column and value.
pub(super) fn read_table(
    file: &str,
    head: &[u8],
    reader: impl BufRead,
    context: &GrainContext<'_>,
) -> Result<Snapshot, SceneError> {
    let mut table = TextTable::open(file, head, reader)?;
    let required = match context.materials {
        MaterialNames::Scene { .. } => &OF_SCENE[..],
        MaterialNames::File { .. } => &OF_SNAPSHOT,
    };
    let columns = table.columns(file, required)?;
    if let (Some(_), Some(mass)) = (columns.find("density_kg_m3"), columns.find("mass_kg")) {
        let name = table.header.get(mass).unwrap_or_default();
        let problem = format!("column {name} is there beside the density; remove one of them");
        return Err(SceneError::data(file, line(&table.header).max(1), problem));
    }
    let mut grains = Gathering::new(columns, context, 1)?;
    let mut record = StringRecord::new();
    while table.rows.read(file, &mut record)? {
        grains.add(&TextRow { record: &record, decimal: &table.decimal })?;
    }
    grains.finish()
}

/// Reads the column `charge_C` [C] of a table for a generator, one row per grain.
///
/// # Errors
/// As [`read_table`]; another number of rows than grains.
pub(super) fn read_charge_column(
    file: &str,
    head: &[u8],
    reader: impl BufRead,
    count: usize,
) -> Result<Vec<f64>, SceneError> {
    let mut table = TextTable::open(file, head, reader)?;
    let columns = table.columns(file, &["charge_C"])?;
    let column = columns.find("charge_C").expect("required columns were checked");
    let mut charges = Vec::new();
    let mut record = StringRecord::new();
    while table.rows.read(file, &mut record)? {
        let row = TextRow { record: &record, decimal: &table.decimal };
        charges.push(columns.number(&row, column, CHARGE)?);
        if charges.len() > count {
            return Err(SceneError::data(
                file,
                line(&record),
                format!("more rows than the {count} grains of the generator; remove some"),
            ));
        }
    }
    if charges.len() < count {
        return Err(SceneError::file(
            file,
            format!("{} rows for {count} grains of the generator; give one charge per grain", charges.len()),
        ));
    }
    Ok(charges)
}

/// Translates an error of the csv library into one of this crate.
fn csv_error(file: &str, error: &csv::Error) -> SceneError {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { pos, expected_len, len } => {
            SceneError::data(file, pos.as_ref().map_or(0, Position::line), other_count(len, expected_len))
        }
        csv::ErrorKind::Io(error) => cut_off(file, error),
        _ => SceneError::data(file, error.position().map_or(0, Position::line), error.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_row_tells_the_separator() {
        for (head, separator) in [
            ("id,x_m\n1;2 3\t4", Separator::Sign(b',')),
            ("\n# a, b\r\n \nid; x_m\n", Separator::Sign(b';')),
            ("id\tx_m\r\n", Separator::Sign(b'\t')),
            ("  id  x_m\n", Separator::Blanks),
            ("id \t x_m\n", Separator::Blanks),
            ("charge_C\n1,2\n", Separator::Sign(b',')),
            ("", Separator::Sign(b',')),
        ] {
            assert_eq!(Separator::of(head.as_bytes()), separator, "{head:?}");
        }
    }
}
