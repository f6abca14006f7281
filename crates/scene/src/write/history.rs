//! File `history.csv`: one row per interval, with only the columns of the scene's plan.

use crate::SceneError;
use crate::write::atomic::write_text;
use std::borrow::Cow;
use std::fmt::Write as _;
use std::fs::{File, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Value in a row.
#[derive(Clone, Debug, PartialEq)]
pub enum HistoryValue {
    /// Count.
    Count(u64),
    /// Quantity, written with 17 significant digits.
    Number(f64),
    /// Name.
    Text(String),
}

/// Open history; a row is given to the operating system as soon as it is appended.
#[derive(Debug)]
pub struct HistoryFile {
    path: PathBuf,
    file: File,
    columns: usize,
    /// Step of the last row.
    last: Option<u64>,
}

impl HistoryFile {
    /// Creates a history with a header, whose first column is `step`.
    ///
    /// # Errors
    /// Errors of the operating system.
    pub fn create(path: &Path, columns: &[String]) -> Result<Self, SceneError> {
        write_text(path, &format!("{}\n", columns.join(",")))?;
        Self::open(path, columns.len(), None)
    }

    /// Opens the history of a run that is continued.
    ///
    /// Only rows up to `step` for which `is_due` holds are kept.
    ///
    /// # Errors
    /// Errors of the operating system, and a history with other columns.
    pub fn resume(
        path: &Path,
        columns: &[String],
        step: u64,
        is_due: impl Fn(u64) -> bool,
    ) -> Result<Self, SceneError> {
        let text = std::fs::read_to_string(path).map_err(|error| SceneError::unwritable(path, error))?;
        let mut lines = text.split_inclusive('\n');
        let header = columns.join(",");
        if lines.next().map(str::trim_end) != Some(&header) {
            return Err(SceneError::unwritable(
                path,
                format!("its columns are not {header}; start a new run with --out"),
            ));
        }
        let (mut kept, mut last) = (format!("{header}\n"), None);
        // A last line without its end was torn when the earlier run was stopped.
        for line in lines.filter(|line| line.ends_with('\n')) {
            let row: Option<u64> = line.split(',').next().and_then(|first| first.parse().ok());
            if row.is_some_and(|row| row <= step && is_due(row)) {
                kept.push_str(line);
                last = row;
            }
        }
        write_text(path, &kept)?;
        Self::open(path, columns.len(), last)
    }

    /// Step of the last row; `None` without rows.
    #[must_use]
    pub fn last_step(&self) -> Option<u64> {
        self.last
    }

    fn open(path: &Path, columns: usize, last: Option<u64>) -> Result<Self, SceneError> {
        let file = OpenOptions::new()
            .append(true)
            .open(path)
            .map_err(|error| SceneError::unwritable(path, error))?;
        Ok(Self { path: path.to_path_buf(), file, columns, last })
    }

    /// Appends a row.
    ///
    /// # Errors
    /// Errors of the operating system.
    ///
    /// # Panics
    /// When the row has another number of cells than the header.
    pub fn append(&mut self, row: &[HistoryValue]) -> Result<(), SceneError> {
        assert_eq!(row.len(), self.columns, "a row has one cell per column");
        if let Some(HistoryValue::Count(step)) = row.first() {
            self.last = Some(*step);
        }
        let mut line = String::with_capacity(25 * row.len());
        for (index, cell) in row.iter().enumerate() {
            let comma = if index == 0 { "" } else { "," };
            // Writing to a String cannot fail.
            let _ = match cell {
                HistoryValue::Count(count) => write!(line, "{comma}{count}"),
                HistoryValue::Number(number) => write!(line, "{comma}{number:.16e}"),
                HistoryValue::Text(text) => write!(line, "{comma}{}", quoted(text)),
            };
        }
        line.push('\n');
        self.file.write_all(line.as_bytes()).map_err(|error| SceneError::unwritable(&self.path, error))
    }
}

/// Text as a cell of a table: in quotes where it would part cells or rows (RFC 4180).
fn quoted(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"', '\r', '\n']) {
        // A row is a line, so that a torn one is known.
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"").replace(['\r', '\n'], " ")))
    } else {
        Cow::Borrowed(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_not_part_cells() {
        assert_eq!((quoted("left bin"), quoted("a,\"b\"\n")), ("left bin".into(), "\"a,\"\"b\"\" \"".into()));
    }

    #[test]
    fn rows_after_the_checkpoint_and_torn_rows_are_removed() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("history.csv");
        let columns = ["step".to_owned(), "time_s".to_owned()];
        let mut history = HistoryFile::create(&path, &columns).unwrap();
        for step in 0..5 {
            history.append(&[HistoryValue::Count(step), HistoryValue::Number(0.5)]).unwrap();
        }
        let mut text = std::fs::read_to_string(&path).unwrap();
        text.push_str("1,0.");
        std::fs::write(&path, text).unwrap();
        let mut history = HistoryFile::resume(&path, &columns, 2, |_| true).unwrap();
        assert_eq!(history.last_step(), Some(2));
        history.append(&[HistoryValue::Count(3), HistoryValue::Number(1.0)]).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let steps: Vec<&str> = text.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
        assert_eq!(steps, ["0", "1", "2", "3"]);
        drop(HistoryFile::resume(&path, &columns, 9, |row| row % 2 == 0).unwrap());
        assert_eq!(std::fs::read_to_string(&path).unwrap().lines().count(), 3);
        assert!(HistoryFile::resume(&path, &["step".to_owned()], 2, |_| true).is_err());
    }
}
