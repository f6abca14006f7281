//! Errors of the study crate.

use std::path::PathBuf;

/// Reason why a study cannot be run or its page cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StudyError {
    /// A file cannot be written.
    #[error("cannot write {}: {source}; check that the folder exists and is writable", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A study cannot be read.
    #[error("cannot read {}: {source}; check its name", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// A file that is no study.
    #[error("{}: {reason}", path.display())]
    Description {
        /// The file.
        path: PathBuf,
        /// Reason in words.
        reason: String,
    },
    /// A table cannot be read or written.
    #[error(transparent)]
    Table(#[from] amberfield_scene::SceneError),
    /// A plot cannot be drawn.
    #[error(transparent)]
    Draw(#[from] amberfield_draw::DrawError),
}
