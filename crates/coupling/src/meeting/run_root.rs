//! The folder of a run in shared memory, and everything else there that bears the run's name.

use crate::CouplingError;
use amberfield_wire::{PROTOCOL_VERSION, WireError};
use rustix::fs::Mode;
use std::path::{Path, PathBuf};

/// Folder of shared memory.
const SHARED: &str = "/dev/shm";
/// File of a run that waits for a solver which somebody else starts.
const INVITATION: &str = "waiting";
/// File with the version of the protocol that the run's DEM process speaks.
const PROTOCOL: &str = "protocol";

/// The place in shared memory of one run: `/dev/shm/amberfield-<uid>-<run>`, open to its user alone.
///
/// Whoever made it removes it, with everything of the run's name beside it, when it is dropped.
#[derive(Debug)]
pub struct RunRoot {
    name: String,
    run: u64,
    owned: bool,
}

impl RunRoot {
    /// Makes the place of a new run.
    ///
    /// # Errors
    /// No shared memory, or no permission.
    pub fn create() -> Result<Self, CouplingError> {
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
        let mut run = now.as_nanos() as u64 ^ (u64::from(std::process::id()) << 44);
        loop {
            let root = Self { name: name_of(run), run, owned: true };
            match rustix::fs::mkdir(root.path(), Mode::RWXU) {
                Ok(()) => {
                    let version = std::fs::write(root.path().join(PROTOCOL), PROTOCOL_VERSION.to_string());
                    version.map_err(|error| cannot_make(&root, &error))?;
                    return Ok(root);
                }
                Err(rustix::io::Errno::EXIST) => run = run.wrapping_add(1),
                Err(error) => return Err(cannot_make(&root, &error)),
            }
        }
    }

    /// The place of a run that somebody else made, by its name.
    ///
    /// # Errors
    /// A name that is none of a run, a place that is not there.
    pub fn open(name: &str) -> Result<Self, CouplingError> {
        let root = Self { name: name.to_owned(), run: Self::number_of(name)?, owned: false };
        let cannot = |why: &dyn std::fmt::Display| {
            Err(CouplingError::SharedMemory(format!("cannot open run {name}: {why}")))
        };
        if let Err(error) = std::fs::read_dir(root.path()) {
            return cannot(&error);
        }
        // What somebody else made under this name is not the DEM process's.
        match rustix::fs::lstat(root.path()) {
            Ok(place) if place.st_uid == rustix::process::getuid().as_raw() => Ok(root),
            Ok(place) => cannot(&format_args!("it belongs to user {}", place.st_uid)),
            Err(error) => cannot(&error),
        }
    }

    /// Whether this machine has the place of a run, by the run's name, which no other machine has a run of.
    #[must_use]
    pub fn is_here(name: &str) -> bool {
        Self::number_of(name).is_ok() && Path::new(SHARED).join(name).is_dir()
    }

    /// A run's number, from its name.
    ///
    /// # Errors
    /// A name that is none of a run.
    pub(super) fn number_of(name: &str) -> Result<u64, CouplingError> {
        let run = name.rsplit('-').next().and_then(|number| u64::from_str_radix(number, 16).ok());
        let known = name.starts_with("amberfield-") && !name.contains('/');
        match (run, known) {
            (Some(run), true) => Ok(run),
            _ => Err(CouplingError::SharedMemory(format!("'{name}' is not the name of a run"))),
        }
    }

    /// Closes all that bears the run's name to other users: iceoryx2 opens a node's management to everybody.
    ///
    /// # Errors
    /// Files of somebody else under this name.
    pub(crate) fn close(&self) -> Result<(), CouplingError> {
        let files = std::fs::read_dir(SHARED).into_iter().flatten().flatten();
        for file in files.filter(|file| file.file_name().to_string_lossy().starts_with(&self.name)) {
            let path = file.path();
            let known = match rustix::fs::lstat(&path) {
                Ok(known) => known,
                // Another process of the run has removed it.
                Err(rustix::io::Errno::NOENT) => continue,
                Err(error) => return Err(cannot_close(&path, &error)),
            };
            let mode = Mode::from_raw_mode(known.st_mode);
            let own = mode & Mode::RWXU;
            if mode != own {
                match rustix::fs::chmod(&path, own) {
                    Ok(()) | Err(rustix::io::Errno::NOENT) => (),
                    Err(error) => return Err(cannot_close(&path, &error)),
                }
            }
        }
        Ok(())
    }

    /// Refuses a DEM process of another version, before anything of it is read.
    pub(crate) fn check_version(&self) -> Result<(), WireError> {
        let text = std::fs::read_to_string(self.path().join(PROTOCOL)).unwrap_or_default();
        amberfield_wire::check_version(text.trim().parse().unwrap_or(0))
    }

    /// Says that the run waits for a solver which somebody else starts, or no longer does.
    pub(crate) fn invite(&self, waits: bool) {
        let path = self.path().join(INVITATION);
        // Without it a solver has to be told the name, which the log says.
        let _ = if waits { std::fs::write(path, "") } else { std::fs::remove_file(path) };
    }

    /// Name of the run, for the field process.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the run waits for a solver which somebody else starts.
    pub(super) fn invites(name: &str) -> bool {
        Path::new(SHARED).join(name).join(INVITATION).exists()
    }

    /// The run's number, in every message.
    #[must_use]
    pub fn run(&self) -> u64 {
        self.run
    }

    /// Removes the place when this is dropped: its maker is dead.
    pub(crate) fn inherit(&mut self) {
        self.owned = true;
    }

    pub(crate) fn path(&self) -> PathBuf {
        Path::new(SHARED).join(&self.name)
    }

    /// Beginning of the names of all shared memory of this run.
    pub(crate) fn prefix(&self) -> String {
        format!("{}.", self.name)
    }
}

impl Drop for RunRoot {
    fn drop(&mut self) {
        if self.owned {
            remove(&self.name);
        }
    }
}

fn cannot_make(root: &RunRoot, why: &dyn std::fmt::Display) -> CouplingError {
    CouplingError::SharedMemory(format!("cannot make {}: {why}", root.path().display()))
}

fn name_of(run: u64) -> String {
    format!("amberfield-{}-{run:016x}", rustix::process::getuid().as_raw())
}

/// Removes a run's place and all that bears its name; what is gone already does not matter.
pub(super) fn remove(name: &str) {
    let prefix = format!("{name}.");
    for entry in std::fs::read_dir(SHARED).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
    let _ = std::fs::remove_dir_all(Path::new(SHARED).join(name));
}

/// Refuses to go on where shared memory has no room for so many bytes: to write there would be a signal, not
/// an error.
pub(crate) fn check_room(bytes: usize) -> Result<(), CouplingError> {
    match rustix::fs::statvfs(SHARED) {
        Ok(room) if room.f_blocks > 0 && room.f_bavail * room.f_frsize < bytes as u64 => {
            Err(no_room(bytes, &"full"))
        }
        Ok(_) => Ok(()),
        Err(error) => Err(no_room(bytes, &error)),
    }
}

fn cannot_close(path: &Path, why: &dyn std::fmt::Display) -> CouplingError {
    CouplingError::SharedMemory(format!("cannot close {} to other users: {why}", path.display()))
}

pub(crate) fn no_room(bytes: usize, why: &dyn std::fmt::Display) -> CouplingError {
    CouplingError::SharedMemory(format!(
        "cannot have {bytes} bytes of it ({why}); make {SHARED} larger (containers: --shm-size)"
    ))
}

/// Names of this user's runs, sorted.
pub(super) fn own_runs() -> Vec<String> {
    let mine = format!("amberfield-{}-", rustix::process::getuid().as_raw());
    let entries = std::fs::read_dir(SHARED).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut runs: Vec<String> = names.filter(|name| name.starts_with(&mine) && !name.contains('.')).collect();
    runs.sort();
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_that_somebody_else_made_is_refused() {
        let root = RunRoot::create().unwrap();
        assert!(RunRoot::open(root.name()).is_ok());
        // Only root can make what belongs to somebody else.
        if rustix::process::getuid().is_root() {
            std::os::unix::fs::chown(root.path(), Some(12345), None).unwrap();
            let error = RunRoot::open(root.name()).unwrap_err().to_string();
            assert!(error.contains("it belongs to user 12345"), "{error}");
        }
        assert!(RunRoot::open("amberfield-0-../x-1").is_err());
    }
}
