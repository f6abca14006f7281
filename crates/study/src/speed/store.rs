//! The report's folder: dated rows, plots, the page.

use anyhow::{Context as _, Result};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::path::PathBuf;

/// Reads and writes the report's files.
#[derive(Debug)]
pub(crate) struct Store {
    folder: PathBuf,
    date: String,
}

impl Store {
    pub(crate) fn new(folder: PathBuf) -> Result<Self> {
        for part in ["data", "pictures"] {
            let path = folder.join(part);
            std::fs::create_dir_all(&path).with_context(|| format!("cannot make {}", path.display()))?;
        }
        Ok(Self { folder, date: time::OffsetDateTime::now_utc().date().to_string() })
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a section's rows under today's date.
    pub(crate) fn save<R: Serialize>(&self, section: &str, rows: &[R]) -> Result<()> {
        let path = self.path(&format!("data/{}-{section}.csv", self.date));
        let mut writer =
            csv::Writer::from_path(&path).with_context(|| format!("cannot write {}", path.display()))?;
        for row in rows {
            writer.serialize(row)?;
        }
        Ok(writer.flush()?)
    }

    /// The newest rows of a section and their date; none where it was never measured.
    pub(crate) fn newest<R: DeserializeOwned>(&self, section: &str) -> Result<Option<(String, Vec<R>)>> {
        let ending = format!("-{section}.csv");
        let mut dates = Vec::new();
        for entry in std::fs::read_dir(self.path("data"))? {
            let name = entry?.file_name().to_string_lossy().into_owned();
            dates.extend(name.strip_suffix(&ending).map(str::to_owned));
        }
        let Some(date) = dates.into_iter().max() else { return Ok(None) };
        let path = self.path(&format!("data/{date}{ending}"));
        let mut reader = csv::Reader::from_path(&path)?;
        let rows: Result<Vec<R>, _> = reader.deserialize().collect();
        Ok(Some((
            date,
            rows.with_context(|| format!("{} has other columns; measure again", path.display()))?,
        )))
    }
}
