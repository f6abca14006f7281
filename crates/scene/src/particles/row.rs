//! Row of a file of grains, whatever the file's form.

use crate::SceneError;
use crate::error::shorten;
use csv::StringRecord;
use std::borrow::Cow;
use std::cell::Cell;

/// Words about a cell that holds no number.
pub(super) const NO_NUMBER: &str = "not a number";

/// Row of cells, which are found by the index of their column.
pub(super) trait Row {
    /// Number in a cell, in the file's unit.
    ///
    /// # Errors
    /// Words for what the cell holds instead.
    fn number(&self, column: usize) -> Result<f64, &'static str>;

    /// Text of a cell, without blanks around it.
    fn text(&self, column: usize) -> Cow<'_, str>;

    /// Error at this row of a file.
    fn error(&self, file: &str, problem: String) -> SceneError {
        refuse(file, self.place(), problem)
    }

    /// Place in the file.
    fn place(&self) -> RowPlace;
}

/// Place of a row in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RowPlace {
    /// Line of a text, from 1.
    Line(u64),
    /// Index of a point of a VTK file, from 0.
    Point(u64),
}

impl RowPlace {
    /// Place of the same kind with another number.
    pub(super) fn at(self, number: u64) -> Self {
        match self {
            Self::Line(_) => Self::Line(number),
            Self::Point(_) => Self::Point(number),
        }
    }

    /// Number of the line or the point.
    pub(super) fn number(self) -> u64 {
        match self {
            Self::Line(number) | Self::Point(number) => number,
        }
    }

    /// Name in a message.
    pub(super) fn named(self) -> String {
        match self {
            Self::Line(line) => format!("line {line}"),
            Self::Point(point) => format!("point {point}"),
        }
    }
}

/// Error at a place of a file.
pub(super) fn refuse(file: &str, place: RowPlace, problem: String) -> SceneError {
    match place {
        RowPlace::Line(line) => SceneError::data(file, line, problem),
        RowPlace::Point(_) => SceneError::file(file, format!("{}: {problem}", place.named())),
    }
}

/// Sign between a number's whole and its decimals, as far as the file has shown it.
#[derive(Debug)]
pub(super) enum DecimalSign {
    /// Point, since a comma separates columns.
    Point,
    /// Point or comma: that of the first number that has one.
    Either(Cell<Option<char>>),
}

impl DecimalSign {
    /// Number of a cell.
    fn number(&self, text: &str) -> Result<f64, &'static str> {
        let Self::Either(shown) = self else { return text.parse().map_err(|_| NO_NUMBER) };
        let sign = text.chars().find(|c| matches!(c, '.' | ','));
        if let Some(sign) = sign
            && shown.replace(shown.get().or(Some(sign))).is_some_and(|before| before != sign)
        {
            return Err("some decimals of the file follow a point, others a comma; write all alike");
        }
        match sign {
            Some(',') => text.replacen(',', ".", 1).parse().map_err(|_| NO_NUMBER),
            _ => text.parse().map_err(|_| NO_NUMBER),
        }
    }
}

/// Row of a text.
pub(super) struct TextRow<'a> {
    /// Cells and place.
    pub(super) record: &'a StringRecord,
    /// Sign between whole and decimals.
    pub(super) decimal: &'a DecimalSign,
}

impl Row for TextRow<'_> {
    fn number(&self, column: usize) -> Result<f64, &'static str> {
        self.decimal.number(self.cell(column))
    }

    fn text(&self, column: usize) -> Cow<'_, str> {
        Cow::Borrowed(self.cell(column))
    }

    fn place(&self) -> RowPlace {
        RowPlace::Line(line(self.record))
    }
}

impl TextRow<'_> {
    fn cell(&self, column: usize) -> &str {
        self.record.get(column).unwrap_or_default().trim()
    }
}

/// Line on which a record starts, from 1.
pub(super) fn line(record: &StringRecord) -> u64 {
    record.position().map_or(0, csv::Position::line)
}

/// Words about a cell that cannot be used.
pub(super) fn about_cell(name: &str, text: &str, problem: &str) -> String {
    format!("{name} = \"{}\": {problem}", shorten(text))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commas_are_decimal_where_no_number_has_a_point() {
        let either = DecimalSign::Either(Cell::new(None));
        assert_eq!(either.number("1"), Ok(1.0));
        assert_eq!(either.number("-1,5e-3"), Ok(-1.5e-3));
        assert_eq!(either.number("2,5"), Ok(2.5));
        assert!(either.number("2.5").unwrap_err().contains("others a comma"));
        assert_eq!(DecimalSign::Either(Cell::new(None)).number("1.000,5"), Err("not a number"));
        assert_eq!(DecimalSign::Either(Cell::new(None)).number("1,000,5"), Err("not a number"));
        assert_eq!(DecimalSign::Point.number("1,5"), Err("not a number"));
    }
}
