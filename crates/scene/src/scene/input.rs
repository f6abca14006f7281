//! Scene as a user gives it: a file, or a text that a program made.

use super::description::{Purpose, Scene};
use super::read::parse;
use crate::SceneError;
use crate::source::read_text;
use crate::tree::Origin;
use std::path::{Path, PathBuf};

/// Scene as a user gives it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SceneInput {
    /// Scene file.
    File(PathBuf),
    /// TOML that a program made of what its user gave: its messages name keys, but no lines.
    Text {
        /// Text of the scene.
        text: String,
        /// Folder of the files that it names.
        folder: PathBuf,
    },
}

impl SceneInput {
    /// Reads the scene, applies `KEY=VALUE` overrides and reads the files that it names. The mesh in the
    /// folder `mesh` counts where the scene's case has none of its own.
    ///
    /// # Errors
    /// All problems of the scene and its files that can be found independently of each other.
    pub fn read(
        &self,
        overrides: &[String],
        purpose: Purpose,
        mesh: Option<&Path>,
    ) -> Result<Scene, SceneError> {
        match self {
            Self::File(path) => {
                let folder = path.parent().unwrap_or(Path::new(""));
                let origin = Origin::File(path.display().to_string().into());
                let mut scene = parse(&read_text(path)?, &origin, folder, overrides, (purpose, mesh))?;
                scene.title = path
                    .file_stem()
                    .map_or_else(|| "scene".to_owned(), |stem| stem.to_string_lossy().into_owned());
                Ok(scene)
            }
            Self::Text { text, folder } => parse(text, &Origin::Program, folder, overrides, (purpose, mesh)),
        }
    }

    /// Path of the file; `None` where there is none.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Text { .. } => None,
        }
    }
}
