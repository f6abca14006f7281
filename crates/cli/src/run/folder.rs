//! Run folder.

use super::{exits, histogram, wall_forces};
use crate::failure::Failure;
use crate::machine;
use amberfield_scene::checkpoints;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

/// Files and folders that a run may write.
const OUTPUTS: [&str; 17] = [
    "scene.toml",
    "log.jsonl",
    "history.csv",
    wall_forces::FILE,
    exits::FILES[0],
    exits::FILES[1],
    "particles",
    "particles.pvd",
    "walls",
    "walls.pvd",
    histogram::FILE,
    histogram::PLOTS[0],
    histogram::PLOTS[1],
    "checkpoints",
    "tuning.json",
    "summary.json",
    "picture.png",
];
/// File with the id of the process that writes to the folder.
const LOCK: &str = "run.lock";

/// Treatment of results that exist already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Existing {
    /// Refuse the folder.
    Refuse,
    /// Remove the results.
    Overwrite,
    /// Continue the results.
    Resume,
}

/// Run folder to which this process writes.
#[derive(Debug)]
pub(crate) struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// Refuses a folder that cannot be used, before any work is done.
    pub(crate) fn check(path: &Path, existing: Existing, scene: Option<&Path>) -> Result<(), Failure> {
        let refuse = |problem: String| Err(Failure::bad_input(format!("{}: {problem}", path.display())));
        if path.exists() && !path.is_dir() {
            return refuse("not a folder; name another one with --out".to_owned());
        }
        if let Some(process) = owner(path).filter(|process| machine::is_alive(*process)) {
            return refuse(format!(
                "process {process} writes to this run folder; wait for it or name another with --out"
            ));
        }
        let found = OUTPUTS.iter().find(|name| path.join(name).exists());
        match (existing, found) {
            (Existing::Refuse, Some(name)) => refuse(format!(
                "the run folder exists ({name} is there); name another with --out, \
                 continue it with --resume CHECKPOINT, or replace it with --overwrite"
            )),
            (Existing::Overwrite, _)
                if scene.is_some_and(|scene| is_same(&path.join("scene.toml"), scene)) =>
            {
                refuse(
                    "--overwrite would remove the scene file itself; name another folder with --out"
                        .to_owned(),
                )
            }
            (Existing::Resume, None) => {
                refuse("there is no run to continue; name its folder with --out".to_owned())
            }
            _ => Ok(()),
        }
    }

    /// Refuses to replace the run from whose checkpoint a scene begins.
    pub(crate) fn spare(path: &Path, existing: Existing, checkpoint: &Path) -> Result<(), Failure> {
        let is_inside = match (path.canonicalize(), checkpoint.canonicalize()) {
            (Ok(folder), Ok(checkpoint)) => checkpoint.starts_with(folder),
            _ => false,
        };
        if existing == Existing::Overwrite && is_inside {
            return Err(Failure::bad_input(format!(
                "{}: --overwrite would remove the checkpoint {} with which the scene begins; name another \
                 folder with --out",
                path.display(),
                checkpoint.display()
            )));
        }
        Ok(())
    }

    /// Opens the folder: creates it, removes old results if asked to, and marks it as in use.
    pub(crate) fn open(path: &Path, existing: Existing) -> Result<Self, Failure> {
        let failed = |error: std::io::Error| {
            Failure::bad_input(format!("{}: cannot be used as run folder: {error}", path.display()))
        };
        if existing == Existing::Overwrite {
            for name in OUTPUTS {
                let old = path.join(name);
                let removed = if old.is_dir() { fs::remove_dir_all(&old) } else { fs::remove_file(&old) };
                removed
                    .or_else(
                        |error| {
                            if error.kind() == std::io::ErrorKind::NotFound { Ok(()) } else { Err(error) }
                        },
                    )
                    .map_err(failed)?;
            }
        }
        fs::create_dir_all(path.join("particles")).map_err(failed)?;
        fs::create_dir_all(path.join("checkpoints")).map_err(failed)?;
        // Files that are left belong to a process that is gone, since `check` has refused a folder in use.
        remove_leftovers(path).map_err(failed)?;
        let mut file = fs::File::create_new(path.join(LOCK)).map_err(failed)?;
        write!(file, "{}", std::process::id()).map_err(failed)?;
        Ok(Self { path: path.to_path_buf() })
    }

    /// Makes a folder inside the run folder.
    pub(crate) fn make(&self, name: &str) -> Result<(), Failure> {
        let path = self.path.join(name);
        fs::create_dir_all(&path).map_err(|error| Failure::bad_input(format!("{}: {error}", path.display())))
    }

    /// Path of the newest checkpoint, if there is one.
    pub(crate) fn newest_checkpoint(&self) -> Option<PathBuf> {
        checkpoints(&self.file("checkpoints")).pop()
    }

    /// Path of a file in the run folder.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Path of the run folder.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for RunFolder {
    fn drop(&mut self) {
        let _ = fs::remove_file(self.path.join(LOCK));
    }
}

/// Id of the process that writes to a run folder.
fn owner(folder: &Path) -> Option<i32> {
    fs::read_to_string(folder.join(LOCK)).ok()?.trim().parse().ok()
}

/// Tells whether two paths name the same file.
fn is_same(one: &Path, other: &Path) -> bool {
    matches!((one.canonicalize(), other.canonicalize()), (Ok(one), Ok(other)) if one == other)
}

/// Tells whether the process that wrote to a run folder is gone without having removed its mark.
pub(crate) fn is_stale(folder: &Path) -> bool {
    folder.join(LOCK).is_file() && owner(folder).is_none_or(|process| !machine::is_alive(process))
}

/// Removes the files that a process which is gone left in its run folder: its mark and half-written files.
///
/// Results stay. Returns the number of removed files.
pub(crate) fn remove_leftovers(folder: &Path) -> std::io::Result<usize> {
    let mut removed = 0;
    for place in ["", "particles", "walls", "checkpoints"].map(|name| folder.join(name)) {
        let Ok(entries) = fs::read_dir(place) else { continue };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let name = name.to_string_lossy();
            if name == LOCK || (name.starts_with(".amberfield-") && name.ends_with(".part")) {
                fs::remove_file(entry.path())?;
                removed += 1;
            }
        }
    }
    Ok(removed)
}
