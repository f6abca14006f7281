//! Errors of the scene crate: each names the place, the value and what to do.

use std::path::PathBuf;

/// Length of the part of a value that a message repeats, at most [characters].
const SHOWN_CHARACTERS: usize = 60;

/// Reason why a scene, or a file that belongs to it, cannot be read or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// File that cannot be read at all.
    #[error("{file}: cannot be read: {reason}")]
    Unreadable {
        /// File, as the user named it.
        file: String,
        /// Reason from the operating system, and what to do.
        reason: String,
    },
    /// Text that is not TOML.
    #[error("{place}: not valid TOML: {message}")]
    Syntax {
        /// File and line, or the override.
        place: String,
        /// Message of the parser.
        message: String,
    },
    /// Override that cannot be applied.
    #[error("{place}: {problem}")]
    Override {
        /// Text of the override.
        place: String,
        /// Advice what to write.
        problem: String,
    },
    /// Key that no scene has.
    #[error("{place}: unknown key {key}{advice}")]
    UnknownKey {
        /// File and line, or the override.
        place: String,
        /// Key path.
        key: String,
        /// Advice: the nearest known key.
        advice: String,
    },
    /// Key that is required but absent.
    #[error("{place}: missing key {key}; {advice}")]
    Missing {
        /// File and line of the table that lacks the key.
        place: String,
        /// Key path.
        key: String,
        /// Advice what to write.
        advice: String,
    },
    /// Value that cannot be used.
    #[error("{place}: {key} = {value}: {problem}")]
    Value {
        /// File and line, or the override.
        place: String,
        /// Key path.
        key: String,
        /// Value, shortened.
        value: String,
        /// Limit that the value breaks, and what to do.
        problem: String,
    },
    /// Bad line of a particles file or an STL file.
    #[error("{file}:{line}: {problem}")]
    Data {
        /// File.
        file: String,
        /// Line number, from 1.
        line: u64,
        /// Column, value and what to do.
        problem: String,
    },
    /// File that cannot be used as a whole.
    #[error("{file}: {problem}")]
    File {
        /// File.
        file: String,
        /// Problem and what to do.
        problem: String,
    },
    /// Case without a mesh, of which a wall is a patch.
    #[error(
        "{}: a wall of the scene is a patch of this case's mesh, and there is no constant/polyMesh yet; make \
         the mesh, with blockMesh for example",
        case.display()
    )]
    NoMesh {
        /// Folder of the case.
        case: PathBuf,
    },
    /// Generated fill that cannot be reached.
    #[error("{place}: particles.generate: {problem}")]
    Fill {
        /// File and line.
        place: String,
        /// Numbers that do not fit together, and what to do.
        problem: String,
    },
    /// Feed whose grains cannot be drawn.
    #[error("{place}: feed \"{name}\": {problem}")]
    Feed {
        /// File and line.
        place: String,
        /// Name of the feed.
        name: String,
        /// Numbers that do not fit together, and what to do.
        problem: String,
    },
    /// Output that cannot be written.
    #[error("{}: cannot be written: {reason}", path.display())]
    Unwritable {
        /// Path.
        path: PathBuf,
        /// Reason from the operating system.
        reason: String,
    },
    /// Checkpoint that cannot be used.
    #[error("{}: {problem}", path.display())]
    Checkpoint {
        /// Path.
        path: PathBuf,
        /// Problem and what to do.
        problem: String,
    },
    /// Several problems, shown together.
    #[error("{}", .0.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))]
    Several(Vec<SceneError>),
}

impl SceneError {
    /// Error about writing to a path.
    pub(crate) fn unwritable(path: &std::path::Path, reason: impl ToString) -> Self {
        Self::Unwritable { path: path.to_path_buf(), reason: reason.to_string() }
    }

    /// Error about a line of a data file.
    pub(crate) fn data(file: &str, line: u64, problem: impl Into<String>) -> Self {
        Self::Data { file: file.to_owned(), line, problem: problem.into() }
    }

    /// Error about a data file as a whole.
    pub(crate) fn file(file: &str, problem: impl Into<String>) -> Self {
        Self::File { file: file.to_owned(), problem: problem.into() }
    }
}

/// Shortens a value for a message and escapes its control characters.
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

/// Collection of problems, so that a user sees all of them together.
#[derive(Debug, Default)]
pub(crate) struct Problems(Vec<SceneError>);

impl Problems {
    /// Takes the value out of a good result; keeps the error of a bad one.
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

    /// Returns `Ok` when no error was kept, else the error or all errors.
    pub(crate) fn finish(mut self) -> Result<(), SceneError> {
        match self.0.len() {
            0 => Ok(()),
            1 => Err(self.0.remove(0)),
            _ => Err(SceneError::Several(self.0)),
        }
    }
}
