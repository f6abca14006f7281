//! The text files of the repository, by path.

use anyhow::{Context, Result};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Paths with forward slashes relative to the root, and the files' text.
pub(super) struct Tree {
    files: BTreeMap<String, String>,
    /// Paths of all files and folders, whatever is in them.
    paths: BTreeSet<String>,
}

/// Endings of the files that the rules look at.
const ENDINGS: [&str; 13] =
    ["rs", "toml", "md", "sh", "yml", "yaml", "py", "c", "h", "cpp", "C", "H", "Dockerfile"];
/// Folders of the root that are made by runs and builds.
const SKIPPED: [&str; 4] = ["target", "build", "runs", ".git"];
/// Beginning of the folders that are made by builds of the field solver.
const SOLVER_BUILDS: &str = "openfoam-solver/build";

impl Tree {
    /// Reads every text file below the root; results of builds and runs are left out.
    pub(super) fn read(root: &Path) -> Result<Self> {
        let mut tree = Self { files: BTreeMap::new(), paths: BTreeSet::new() };
        tree.read_folder(root, "")?;
        Ok(tree)
    }

    fn read_folder(&mut self, root: &Path, folder: &str) -> Result<()> {
        let place = root.join(folder);
        for entry in fs::read_dir(&place).with_context(|| format!("cannot read {}", place.display()))? {
            let entry = entry?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let path = if folder.is_empty() { name.clone() } else { format!("{folder}/{name}") };
            let kind = entry.file_type()?;
            let is_skipped = folder.is_empty() && SKIPPED.contains(&name.as_str())
                || kind.is_dir() && path.starts_with(SOLVER_BUILDS);
            if !is_skipped {
                self.paths.insert(path.clone());
            }
            if kind.is_dir() {
                if !is_skipped {
                    self.read_folder(root, &path)?;
                }
            } else if kind.is_file() && is_text(&path) {
                let text = fs::read_to_string(entry.path())
                    .with_context(|| format!("{path} is not readable as UTF-8 text"))?;
                self.files.insert(path, text);
            }
        }
        Ok(())
    }

    /// A tree for tests.
    #[cfg(test)]
    pub(super) fn made_up(files: &[(&str, &str)]) -> Self {
        let paths = files.iter().flat_map(|(path, _)| {
            let folders = path.match_indices('/').map(|(end, _)| path[..end].to_owned());
            folders.chain([(*path).to_owned()])
        });
        Self {
            files: files.iter().map(|(path, text)| ((*path).to_owned(), (*text).to_owned())).collect(),
            paths: paths.collect(),
        }
    }

    pub(super) fn len(&self) -> usize {
        self.files.len()
    }

    /// Whether a file or folder is there.
    pub(super) fn has(&self, path: &str) -> bool {
        self.paths.contains(path)
    }

    pub(super) fn text(&self, path: &str) -> Option<&str> {
        self.files.get(path).map(String::as_str)
    }

    /// Every file: path and text.
    pub(super) fn files(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files.iter().map(|(path, text)| (path.as_str(), text.as_str()))
    }

    /// Rust files: path and text.
    pub(super) fn rust_files(&self) -> impl Iterator<Item = (&str, &str)> {
        self.files().filter(|(path, _)| path.ends_with(".rs"))
    }
}

fn is_text(path: &str) -> bool {
    path.starts_with(".ci/") || path.rsplit_once('.').is_some_and(|(_, ending)| ENDINGS.contains(&ending))
}
