//! The two ways in which the programs are compiled.

use std::path::{Path, PathBuf};

/// The way in which a program is compiled, and the places of its parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Profile {
    /// Compilation for users.
    Release,
    /// Compilation of the tests: whatever they need in this form is compiled anyway, so that a run of all
    /// tests compiles everything once.
    Dev,
}

impl Profile {
    /// Folder into which cargo puts programs and libraries.
    pub(crate) fn folder(self, root: &Path) -> PathBuf {
        root.join(match self {
            Self::Release => "target/release",
            Self::Dev => "target/debug",
        })
    }

    /// Folder of `openfoam-solver/` for the programs that are linked to OpenFOAM.
    pub(crate) fn solver_folder(self) -> &'static str {
        match self {
            Self::Release => "build",
            Self::Dev => "build-test",
        }
    }
}
