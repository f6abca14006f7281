//! Folder of a report: rows with the date of their measurement, pictures, pages.

use crate::StudyError;
use amberfield_scene::files::FileTable;
use amberfield_scene::{read_table, write_rows, write_table};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;

/// Characters of a date, as 2026-01-31.
const DATE: usize = 10;

/// Day of today in UTC, as 2026-01-31.
#[must_use]
pub fn today() -> String {
    time::OffsetDateTime::now_utc().date().to_string()
}

/// Reads and writes the files of a report.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
    date: String,
}

impl Store {
    /// Opens the folder of a report and makes what is missing of it.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn new(folder: PathBuf) -> Result<Self, StudyError> {
        for part in ["data", "pictures"] {
            let path = folder.join(part);
            std::fs::create_dir_all(&path).map_err(|source| StudyError::Write { path, source })?;
        }
        Ok(Self { folder, date: today() })
    }

    /// Path of a file of the report.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes rows as `data/DATE-NAME.csv`, with the date of the day on which the store was opened.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save<R: Serialize>(&self, name: &str, rows: &[R]) -> Result<(), StudyError> {
        Ok(write_table(&self.path(&format!("data/{}-{name}.csv", self.date)), rows)?)
    }

    /// Writes rows of a file of the table of files, as [`Self::save`] does.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn save_as<R: Serialize>(&self, name: &str, file: &FileTable, rows: &[R]) -> Result<(), StudyError> {
        Ok(write_rows(&self.path(&format!("data/{}-{name}.csv", self.date)), file, rows)?)
    }

    /// Reads the newest rows of a name with their date; `None` where there are none.
    ///
    /// # Errors
    /// A folder or file that cannot be read, rows with other columns.
    pub fn newest<R: DeserializeOwned>(&self, name: &str) -> Result<Option<(String, Vec<R>)>, StudyError> {
        let ending = format!("-{name}.csv");
        let path = self.path("data");
        let entries = std::fs::read_dir(&path).map_err(|source| StudyError::Read { path, source })?;
        let date_of = |file: String| Some(file.strip_suffix(&ending)?.to_owned());
        let newest = entries
            .filter_map(|entry| date_of(entry.ok()?.file_name().to_string_lossy().into_owned()))
            .filter(|date| date.len() == DATE)
            .max();
        let Some(date) = newest else { return Ok(None) };
        let rows = read_table(&self.path(&format!("data/{date}{ending}")))?;
        Ok(Some((date, rows)))
    }
}
