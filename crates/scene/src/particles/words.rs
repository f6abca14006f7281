//! Lines of a text, and rows whose cells are separated by blanks.

use crate::SceneError;
use csv::{Position, StringRecord};
use std::io::BufRead;

/// Lines of a text, with their numbers.
pub(super) struct Lines<R> {
    /// File, as the user named it.
    file: String,
    reader: R,
    /// Number of the line that was read last, from 1.
    number: u64,
    /// Line that was read last, with its end.
    bytes: Vec<u8>,
}

impl<R: BufRead> Lines<R> {
    pub(super) fn new(file: &str, reader: R) -> Self {
        Self { file: file.to_owned(), reader, number: 0, bytes: Vec::new() }
    }

    /// Lines from one in the middle of a file on.
    pub(super) fn from(file: &str, reader: R, number: u64) -> Self {
        Self { number, ..Self::new(file, reader) }
    }

    /// Reads the next line; `false` at the end of the file.
    pub(super) fn advance(&mut self) -> Result<bool, SceneError> {
        self.bytes.clear();
        let count = self.reader.read_until(b'\n', &mut self.bytes);
        let count = count.map_err(|error| cut_off(&self.file, &error))?;
        self.number += u64::from(count > 0);
        Ok(count > 0)
    }

    /// Line that was read last, with its end.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Text of the line that was read last, without blanks around it.
    ///
    /// # Errors
    /// Bytes that are no text.
    pub(super) fn text(&self) -> Result<&str, SceneError> {
        match std::str::from_utf8(&self.bytes) {
            Ok(text) => Ok(text.trim_ascii()),
            Err(error) => {
                let bad = self.bytes[error.valid_up_to()];
                Err(self.error(format!("byte 0x{bad:02x} is not UTF-8 text; save the file as UTF-8")))
            }
        }
    }

    /// Number of the line that was read last, from 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    /// Error at the line that was read last.
    pub(super) fn error(&self, problem: impl Into<String>) -> SceneError {
        SceneError::data(&self.file, self.number, problem)
    }
}

/// Rows of cells that are separated by blanks; a cell with blanks in it stands in quotes.
pub(super) struct Words<R> {
    lines: Lines<R>,
    /// Sign that begins a comment.
    comment: Option<u8>,
    /// Number of cells in each row; that of the first row where it is not given.
    count: Option<usize>,
}

impl<R: BufRead> Words<R> {
    pub(super) fn new(lines: Lines<R>, comment: Option<u8>, count: Option<usize>) -> Self {
        Self { lines, comment, count }
    }

    /// Reads the next row that is neither empty nor a comment; `false` at the end of the file.
    pub(super) fn read(&mut self, record: &mut StringRecord) -> Result<bool, SceneError> {
        record.clear();
        while self.lines.advance()? {
            let text = self.lines.text()?;
            if text.is_empty() || (self.comment.is_some() && self.comment == text.bytes().next()) {
                continue;
            }
            split(text, record);
            let mut position = Position::new();
            position.set_line(self.lines.number());
            record.set_position(Some(position));
            let expected = *self.count.get_or_insert(record.len());
            if record.len() != expected {
                return Err(self.lines.error(other_count(record.len(), expected)));
            }
            return Ok(true);
        }
        Ok(false)
    }
}

/// Splits a text at blanks outside of quotes.
fn split(text: &str, record: &mut StringRecord) {
    let mut rest = text;
    while !rest.is_empty() {
        let (word, after) = match rest.strip_prefix('"').and_then(|quoted| quoted.split_once('"')) {
            Some(pair) => pair,
            None => rest.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((rest, "")),
        };
        record.push_field(word);
        rest = after.trim_ascii_start();
    }
}

/// Words about a row with another number of cells than there are columns.
pub(super) fn other_count(found: impl std::fmt::Display, expected: impl std::fmt::Display) -> String {
    format!("{found} values in a row of {expected} columns; give one value per column")
}

/// Error of a file that cannot be read on.
pub(super) fn cut_off(file: &str, error: &std::io::Error) -> SceneError {
    SceneError::file(file, format!("cannot be read to its end: {error}; check that it was written whole"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_separate_cells_and_quotes_hold_them_together() {
        let mut record = StringRecord::new();
        split("1 \t\"soda lime\" 2,5 \"\" \"x", &mut record);
        assert_eq!(record.iter().collect::<Vec<_>>(), ["1", "soda lime", "2,5", "", "\"x"]);
    }
}
