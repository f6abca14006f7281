//! Folder in which a run's solver works: links to the user's case, and what is made of it.

use super::alias::Alias;
use super::contents::has_mesh;
use super::mesh::provide_mesh;
use super::parts::provide_parts;
use super::start_time::{TimeFolder, times, times_up_to_start};
use super::tools::Stop;
use super::unusable;
use crate::CouplingError;
use std::fs::{self, File, TryLockError};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// File that the process has locked that works in a folder.
const LOCK: &str = "lock";
/// Beginnings of names in a case that a run has for itself.
const OWN: [&str; 7] =
    ["processor", "log.", "postProcessing", "dynamicCode", "constant", LOCK, "decomposeParDict.amberfield"];

/// Folder in which a run's solver works. One process has it at a time.
#[derive(Debug)]
pub struct Workplace {
    /// The user's case.
    case: PathBuf,
    folder: PathBuf,
    alias: Alias,
    /// Name of the time from which the solver starts.
    start: Vec<TimeFolder>,
    _lock: File,
}

impl Workplace {
    /// Opens a folder for a case, makes it if it is not there, and links it to the case.
    ///
    /// # Errors
    /// A case that cannot be opened or has no fields to start from, a folder that cannot be written or in
    /// which another process works.
    pub fn open(case: &Path, folder: &Path) -> Result<Self, CouplingError> {
        let case =
            case.canonicalize().map_err(|error| unusable(case, format!("cannot be opened: {error}")))?;
        let start = times_up_to_start(&case)?;
        let cannot = |error| unusable(folder, format!("cannot be used for the field solver: {error}"));
        fs::create_dir_all(folder).map_err(cannot)?;
        let folder = folder.canonicalize().map_err(cannot)?;
        let lock = lock(&folder)?;
        let alias = Alias::of(&folder).map_err(cannot)?;
        let place = Self { case, folder, alias, start, _lock: lock };
        place.link().map_err(|error| unusable(&place.folder, format!("cannot link to the case: {error}")))?;
        Ok(place)
    }

    /// Removes all from a folder, for a new run.
    ///
    /// # Errors
    /// A folder in which another process works, or whose files cannot be removed.
    pub fn clear(folder: &Path) -> Result<(), CouplingError> {
        if !folder.is_dir() {
            return Ok(());
        }
        let _lock = lock(folder)?;
        fs::remove_dir_all(folder).map_err(|error| unusable(folder, format!("cannot be removed: {error}")))
    }

    /// The user's case.
    pub(super) fn case(&self) -> &Path {
        &self.case
    }

    /// The folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Path by which OpenFOAM's programs know the folder.
    pub(crate) fn path(&self) -> &Path {
        self.alias.path()
    }

    /// Folder in which the solver runs: the folder, unless OpenFOAM cannot have its name.
    pub(crate) fn folder_to_run_in(&self) -> &Path {
        self.alias.folder_to_run_in()
    }

    /// Log of a program.
    #[must_use]
    pub fn log(&self, program: &str) -> PathBuf {
        let name = Path::new(program).file_name().unwrap_or(program.as_ref());
        let mut log = std::ffi::OsString::from("log.");
        log.push(name);
        self.folder.join(log)
    }

    /// Times of the case up to the one from which the solver starts, which comes last.
    pub(super) fn times(&self) -> &[TimeFolder] {
        &self.start
    }

    /// Name of the time from which the solver starts.
    pub(crate) fn start_time(&self) -> &str {
        self.start.last().map_or("0", |time| &time.name)
    }

    /// Makes the mesh of a case that has only a recipe for it, where that is due.
    ///
    /// # Errors
    /// A case without mesh and recipe, a recipe that blockMesh refuses, a user who stops.
    pub fn provide_mesh(&self, stop: Stop) -> Result<(), CouplingError> {
        provide_mesh(self, stop)
    }

    /// Cuts the case into parts for so many ranks, where that is due. Returns our dictionary if the parts are
    /// by it; the solver has to be told, since it looks into one.
    pub(crate) fn provide_parts(&self, ranks: u32, stop: Stop) -> Result<Option<PathBuf>, CouplingError> {
        provide_parts(self, ranks, stop)
    }

    /// Whether a mark has a fingerprint.
    pub(super) fn has_mark(&self, name: &str, print: u64) -> bool {
        fs::read_to_string(self.folder.join(name)).is_ok_and(|known| known == format!("{print:016x}"))
    }

    /// Takes a mark away before what it marks is changed.
    pub(super) fn remove_mark(&self, name: &str) {
        let _ = fs::remove_file(self.folder.join(name));
    }

    /// Links to the case: its folders of times up to the start, and all that a solver may read.
    fn link(&self) -> std::io::Result<()> {
        remove_links(&self.folder)?;
        let constant = self.folder.join("constant");
        if has_mesh(&self.case) {
            if constant.is_dir() {
                fs::remove_dir_all(&constant)?;
            }
            symlink(self.case.join("constant"), &constant)?;
        } else {
            fs::create_dir_all(&constant)?;
            remove_links(&constant)?;
            link_entries(&self.case.join("constant"), &constant, |name| name != "polyMesh")?;
        }
        let times = times(&self.case).unwrap_or_default();
        let is_later = |name: &str| {
            let is = |time: &TimeFolder| time.name == name;
            times.iter().any(is) && !self.start.iter().any(is)
        };
        link_entries(&self.case, &self.folder, |name| {
            let holds_us = self.folder.starts_with(self.case.join(name));
            !holds_us && !is_later(name) && !OWN.iter().any(|own| name.starts_with(own))
        })
    }
}

/// Locks a folder for this process.
fn lock(folder: &Path) -> Result<File, CouplingError> {
    let cannot = |error| unusable(folder, format!("cannot be used for the field solver: {error}"));
    let lock = File::create(folder.join(LOCK)).map_err(cannot)?;
    match lock.try_lock() {
        Ok(()) => Ok(lock),
        Err(TryLockError::WouldBlock) => Err(unusable(
            folder,
            "another run's field solver works there; wait for it or name another with --out",
        )),
        Err(TryLockError::Error(error)) => Err(cannot(error)),
    }
}

/// Writes a mark once all that it marks is there.
pub(super) fn write_mark(place: &Workplace, name: &str, print: u64) -> Result<(), CouplingError> {
    let path = place.folder.join(name);
    let part = path.with_extension("part");
    let written = fs::write(&part, format!("{print:016x}")).and_then(|()| fs::rename(&part, &path));
    written.map_err(|error| unusable(&path, format!("cannot be written: {error}")))
}

/// Links to the entries of a folder that are wanted and whose names are free.
fn link_entries(from: &Path, to: &Path, is_wanted: impl Fn(&str) -> bool) -> std::io::Result<()> {
    let Ok(entries) = fs::read_dir(from) else { return Ok(()) };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let link = to.join(&name);
        if is_wanted(&name.to_string_lossy()) && link.symlink_metadata().is_err() {
            symlink(entry.path(), link)?;
        }
    }
    Ok(())
}

/// Removes the links in a folder, and nothing else.
fn remove_links(folder: &Path) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)?.flatten() {
        if entry.file_type()?.is_symlink() {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
}
