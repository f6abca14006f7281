//! Tables of values over time: a header row with names of columns, then a row for each time.

use crate::SceneError;
use crate::limits::COORDINATE;
use crate::source::decode;
use crate::tree::Range;

/// Table of values over time, whose first column is the time.
pub(super) struct TimeTable<const COLUMNS: usize> {
    /// Names of the columns.
    pub(super) columns: [&'static str; COLUMNS],
    /// Whether columns of values may be absent, and are 0 then.
    pub(super) may_lack: bool,
    /// Range of the values; that of times is fixed.
    pub(super) values: Range,
    /// Things that the table is of, for messages.
    pub(super) of: &'static str,
}

impl<const COLUMNS: usize> TimeTable<COLUMNS> {
    /// Reads the rows of a file, in order of their times.
    pub(super) fn read(&self, file: &str, bytes: &[u8]) -> Result<Vec<[f64; COLUMNS]>, SceneError> {
        let text = decode(file, bytes)?;
        let lines = (1..).zip(text.lines()).map(|(number, line)| (number, line.trim()));
        let mut lines = lines.filter(|(_, line)| !line.is_empty() && !line.starts_with('#'));
        let Some((number, header)) = lines.next() else {
            let problem = format!("has no header row; begin with {}", self.columns.join(","));
            return Err(SceneError::file(file, problem));
        };
        let places = self.places(header).map_err(|problem| SceneError::data(file, number, problem))?;
        let mut rows: Vec<[f64; COLUMNS]> = Vec::new();
        for (number, line) in lines {
            let row = self.row(line, &places).map_err(|problem| SceneError::data(file, number, problem))?;
            if let Some(before) = rows.last().filter(|before| row[0] <= before[0]) {
                let problem = format!(
                    "t_s = {} follows t_s = {}; times must rise from row to row: sort the rows, remove what \
                     is twice",
                    row[0], before[0]
                );
                return Err(SceneError::data(file, number, problem));
            }
            rows.push(row);
        }
        if rows.len() < 2 {
            let problem =
                format!("has {} row(s) below its header; {} needs two at least", rows.len(), self.of);
            return Err(SceneError::file(file, problem));
        }
        Ok(rows)
    }

    /// Columns to which the cells of a row belong.
    fn places(&self, header: &str) -> Result<Vec<usize>, String> {
        let names: Vec<&str> = cells(header).collect();
        let known = |name: &&str| self.columns.iter().position(|column| column == name);
        if let Some(unknown) = names.iter().find(|name| known(name).is_none()) {
            let unknown = crate::error::shorten(unknown);
            return Err(format!("unknown column \"{unknown}\"; columns are {}", self.columns.join(", ")));
        }
        let places: Vec<usize> = names.iter().filter_map(known).collect();
        let twice = (1..places.len()).any(|k| places[..k].contains(&places[k]));
        let enough = if self.may_lack { places.len() > 1 } else { places.len() == COLUMNS };
        if !twice && enough && places.contains(&0) {
            return Ok(places);
        }
        let values = self.columns[1..].join(", ");
        Err(if self.may_lack {
            format!(
                "the header row needs t_s and some of {values}, each once; a column that is not there is 0"
            )
        } else {
            format!("the header row needs t_s and {values}, each once")
        })
    }

    /// Values of a row whose cells belong to some of the columns.
    fn row(&self, line: &str, places: &[usize]) -> Result<[f64; COLUMNS], String> {
        let found: Vec<&str> = cells(line).collect();
        if found.len() != places.len() {
            let (count, asked) = (found.len(), places.len());
            return Err(format!("{count} cells where the header has {asked}; give one for each column"));
        }
        let mut numbers = [0.0; COLUMNS];
        for (cell, place) in found.into_iter().zip(places) {
            let range = if *place == 0 { COORDINATE } else { self.values };
            let number = cell.parse::<f64>().ok().filter(|number| range.contains(*number));
            numbers[*place] = number.ok_or_else(|| {
                let (column, cell) = (self.columns[*place], crate::error::shorten(cell));
                format!("{column} = \"{cell}\": give a number {range}")
            })?;
        }
        Ok(numbers)
    }
}

/// Cells of a line, between commas, semicolons, or blanks.
fn cells(line: &str) -> impl Iterator<Item = &str> {
    let sign = [',', ';'].into_iter().find(|sign| line.contains(*sign));
    let mut parts: Vec<&str> = match sign {
        Some(sign) => line.split(sign).map(str::trim).collect(),
        None => line.split_whitespace().collect(),
    };
    // A sign at the end of a line begins no cell.
    if parts.last().is_some_and(|last| last.is_empty()) {
        parts.pop();
    }
    parts.into_iter()
}
