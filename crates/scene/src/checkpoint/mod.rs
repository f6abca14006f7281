//! Checkpoints: files with a run's state, and with its grains for other scenes.

mod grains;
mod layout;

pub use grains::SavedGrains;
pub(crate) use layout::{Parts, decode, encode};

use std::path::{Path, PathBuf};

/// Paths of the checkpoints in a folder, oldest first.
#[must_use]
pub fn checkpoints(folder: &Path) -> Vec<PathBuf> {
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|file| file.path());
    let mut files: Vec<_> =
        files.filter(|path| path.extension().is_some_and(|kind| kind == "amber")).collect();
    // Their names count steps with leading zeros.
    files.sort();
    files
}
