//! Errors of the scene crate: each names its place, the value and what to do.

use std::path::PathBuf;

/// Longest part of a value that a message repeats [characters].
const SHOWN_CHARACTERS: usize = 60;

/// Why a scene, or a file that belongs to it, cannot be read or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// A file cannot be read at all.
    #[error("{file}: cannot be read: {reason}")]
    Unreadable {
        /// File, as the user named it.
        file: String,
        /// What the system says, and what to do.
        reason: String,
    },
    /// The text is not TOML.
    #[error("{place}: not valid TOML: {message}")]
    Syntax {
        /// File and line, or the override.
        place: String,
        /// What the parser says.
        message: String,
    },
    /// An override that cannot be applied.
    #[error("{place}: {problem}")]
    Override {
        /// The override.
        place: String,
        /// What to write.
        problem: String,
    },
    /// A key that no scene has.
    #[error("{place}: unknown key {key}{advice}")]
    UnknownKey {
        /// File and line, or the override.
        place: String,
        /// Key path.
        key: String,
        /// The nearest known key.
        advice: String,
    },
    /// A key that must be there is not.
    #[error("{place}: missing key {key}; {advice}")]
    Missing {
        /// File and line of the table that lacks the key.
        place: String,
        /// Key path.
        key: String,
        /// What to write.
        advice: String,
    },
    /// A value that cannot be used.
    #[error("{place}: {key} = {value}: {problem}")]
    Value {
        /// File and line, or the override.
        place: String,
        /// Key path.
        key: String,
        /// The value, shortened.
        value: String,
        /// The limit and what to do.
        problem: String,
    },
    /// A bad line of a particles file or an STL file.
    #[error("{file}:{line}: {problem}")]
    Data {
        /// File.
        file: String,
        /// Line, from 1.
        line: u64,
        /// Column, value and what to do.
        problem: String,
    },
    /// A file that as a whole cannot be used.
    #[error("{file}: {problem}")]
    File {
        /// File.
        file: String,
        /// What is wrong and what to do.
        problem: String,
    },
    /// A generated fill that cannot be reached.
    #[error("{place}: particles.generate: {problem}")]
    Fill {
        /// File and line.
        place: String,
        /// Numbers and what to do.
        problem: String,
    },
    /// An output cannot be written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// Path.
        path: PathBuf,
        /// What the system says.
        reason: String,
    },
    /// A checkpoint cannot be used.
    #[error("{}: {problem}", path.display())]
    Checkpoint {
        /// Path.
        path: PathBuf,
        /// What is wrong and what to do.
        problem: String,
    },
    /// More than one problem.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Several(Vec<SceneError>),
}

impl SceneError {
    /// Error of writing to a path.
    pub(crate) fn unwritable(path: &std::path::Path, reason: impl ToString) -> Self {
        Self::Unwritable { path: path.to_path_buf(), reason: reason.to_string() }
    }

    /// Error in a line of a data file.
    pub(crate) fn data(file: &str, line: u64, problem: impl Into<String>) -> Self {
        Self::Data { file: file.to_owned(), line, problem: problem.into() }
    }

    /// Error of a data file as a whole.
    pub(crate) fn file(file: &str, problem: impl Into<String>) -> Self {
        Self::File { file: file.to_owned(), problem: problem.into() }
    }
}

/// The value with control characters escaped and shortened for a message.
pub(crate) fn shorten(value: &str) -> String {
    let mut shown: String = value
        .chars()
        .take(SHOWN_CHARACTERS)
        .flat_map(|c| if c.is_control() { c.escape_default().collect() } else { vec![c] })
        .collect();
    let length = value.chars().count();
    if length > SHOWN_CHARACTERS {
        shown.push_str(&format!("… ({length} characters)"));
    }
    shown
}

/// Gathers problems so that a user sees them together.
#[derive(Debug, Default)]
pub(crate) struct Problems(Vec<SceneError>);

impl Problems {
    /// The value of a good result; a bad one is kept.
    pub(crate) fn keep<T>(&mut self, result: Result<T, SceneError>) -> Option<T> {
        match result {
            Ok(value) => Some(value),
            Err(SceneError::Several(errors)) => {
                self.0.extend(errors);
                None
            }
            Err(error) => {
                self.0.push(error);
                None
            }
        }
    }

    /// `Ok` when nothing went wrong.
    pub(crate) fn finish(mut self) -> Result<(), SceneError> {
        match self.0.len() {
            0 => Ok(()),
            1 => Err(self.0.remove(0)),
            _ => Err(SceneError::Several(self.0)),
        }
    }
}
