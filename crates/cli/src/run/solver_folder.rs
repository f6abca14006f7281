//! Folder in which a scene's field solver works.

use crate::failure::Failure;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// Name of the folder in a run folder, and end of its name beside a result.
pub(crate) const NAME: &str = "solver";

/// Folder in which a scene's field solver works: with its log, the parts of its case, and what it writes.
#[derive(Debug)]
#[cfg_attr(not(feature = "coupling"), expect(dead_code, reason = "without a solver nobody works in it"))]
pub(crate) enum SolverFolder {
    /// One that stays.
    Kept(PathBuf),
    /// One that goes when the command is over.
    Temporary(TempDir),
}

impl SolverFolder {
    /// Folder inside a run folder.
    pub(crate) fn of_run(out: &Path) -> Self {
        Self::Kept(out.join(NAME))
    }

    /// Folder beside a result, named after it.
    pub(crate) fn beside(result: &Path) -> Self {
        let stem = result.file_stem().unwrap_or_default().to_string_lossy();
        Self::Kept(result.with_file_name(format!("{stem}-{NAME}")))
    }

    /// Folder that goes when the command is over.
    pub(crate) fn temporary() -> Result<Self, Failure> {
        let made = tempfile::Builder::new().prefix("amberfield-").tempdir();
        made.map(Self::Temporary)
            .map_err(|error| Failure::bad_input(format!("no folder for temporary files: {error}")))
    }

    /// Path of the folder, which need not be there yet.
    #[cfg(feature = "coupling")]
    pub(crate) fn path(&self) -> &Path {
        match self {
            Self::Kept(path) => path,
            Self::Temporary(folder) => folder.path(),
        }
    }
}
