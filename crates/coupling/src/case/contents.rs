//! Contents of a case: a fingerprint of every file from which a solver's answer follows.

use super::dictionary::{content, included};
use super::start_time::times_up_to_start;
use super::unusable;
use crate::CouplingError;
use amberfield_core::Fingerprint;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Folder of the mesh in a case.
pub(super) const MESH: &str = "constant/polyMesh";
/// Recipe of a mesh.
pub(super) const RECIPE: &str = "system/blockMeshDict";
/// Files of a mesh that change no field: sets, and what snappyHexMesh leaves.
const NO_MESH: [&str; 4] = ["sets", "pointLevel", "cellLevel", "level0Edge"];
/// Dictionaries in `system` from which an answer follows.
const SYSTEM: [&str; 3] = ["fvSchemes", "fvSolution", "fvOptions"];

/// Fingerprints of the files of a case, by their paths in it; those outside by their own.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct CaseContents(BTreeMap<String, u64>);

impl CaseContents {
    /// Contents from which the solver's answers follow: mesh or its recipe, fields from which it starts,
    /// `constant`, schemes, and what they include.
    ///
    /// # Errors
    /// A case without fields to start from, a file that cannot be read.
    pub fn of_physics(case: &Path) -> Result<Self, CouplingError> {
        let mut contents = Self::of_fields_and_mesh(case)?;
        for name in SYSTEM {
            contents.add_if_there(case, &case.join("system").join(name))?;
        }
        contents.add_folder(case, &case.join("constant"), &["polyMesh", "triSurface"])?;
        Ok(contents)
    }

    /// Contents of which the parts of a case are made: the mesh or its recipe, and the fields from which the
    /// solver starts, with what they include.
    pub(super) fn of_fields_and_mesh(case: &Path) -> Result<Self, CouplingError> {
        let mut contents = Self::default();
        if has_mesh(case) {
            contents.add_folder(case, &case.join(MESH), &NO_MESH)?;
        } else {
            contents.add_if_there(case, &case.join(RECIPE))?;
        }
        for time in times_up_to_start(case)? {
            contents.add_folder(case, &case.join(time.name), &["uniform"])?;
        }
        Ok(contents)
    }

    /// Contents of one file, with what it includes; none where it is not there.
    pub(super) fn of_file(case: &Path, file: &str) -> Result<Self, CouplingError> {
        let mut contents = Self::default();
        contents.add_if_there(case, &case.join(file))?;
        Ok(contents)
    }

    /// One fingerprint of all.
    pub(super) fn fingerprint(&self) -> u64 {
        let mut all = Fingerprint::new();
        for (name, print) in &self.0 {
            all.add(name.as_bytes());
            all.add(&print.to_le_bytes());
        }
        all.value()
    }

    /// Files that differ from earlier contents, with what became of them.
    #[must_use]
    pub fn changes_since(&self, earlier: &Self) -> Vec<String> {
        let now = self.0.iter().filter_map(|(name, print)| match earlier.0.get(name) {
            None => Some(format!("{name} (new)")),
            Some(before) if before != print => Some(format!("{name} (changed)")),
            Some(_) => None,
        });
        let gone = earlier.0.keys().filter(|name| !self.0.contains_key(*name));
        now.chain(gone.map(|name| format!("{name} (gone)"))).collect()
    }

    /// Adds the files of a folder, and of those in it, but for some names.
    fn add_folder(&mut self, case: &Path, folder: &Path, but: &[&str]) -> Result<(), CouplingError> {
        let Ok(entries) = std::fs::read_dir(folder) else { return Ok(()) };
        let mut entries: Vec<_> = entries.flatten().collect();
        // Of a plain file and a compressed one the plain one counts, as it does for OpenFOAM.
        entries.sort_by_key(std::fs::DirEntry::file_name);
        for entry in entries {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            let path = entry.path();
            if but.contains(&&*name) || name.ends_with('~') || name.starts_with('.') {
                continue;
            }
            if path.is_dir() {
                self.add_folder(case, &path, but)?;
            } else {
                self.add_if_there(case, &path)?;
            }
        }
        Ok(())
    }

    /// Adds a file, if it is there, and what it includes. A compressed file counts as what is in it.
    fn add_if_there(&mut self, case: &Path, path: &Path) -> Result<(), CouplingError> {
        let mut next = vec![path.to_path_buf()];
        while let Some(path) = next.pop() {
            let Some(path) = existing(&path) else { continue };
            let shown = path.strip_prefix(case).unwrap_or(&path).to_string_lossy().into_owned();
            let name = shown.strip_suffix(".gz").unwrap_or(&shown).to_owned();
            if self.0.contains_key(&name) {
                continue;
            }
            let bytes = content(&path).map_err(|error| unusable(&path, error))?;
            let mut print = Fingerprint::new();
            print.add(&bytes);
            self.0.insert(name, print.value());
            next.extend(included(case, &path, &bytes));
        }
        Ok(())
    }
}

/// Whether a case has a mesh, compressed or not.
pub(super) fn has_mesh(case: &Path) -> bool {
    existing(&case.join(MESH).join("points")).is_some()
}

/// Path of a file that is there, compressed or not; where both are, OpenFOAM reads the plain one.
fn existing(path: &Path) -> Option<PathBuf> {
    let mut compressed = path.as_os_str().to_owned();
    compressed.push(".gz");
    [path.to_path_buf(), compressed.into()].into_iter().find(|path| path.is_file())
}
