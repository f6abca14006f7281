//! The folder of a run in shared memory, and everything else there that bears the run's name.

use crate::CouplingError;
use rustix::fs::Mode;
use std::path::{Path, PathBuf};

/// Where shared memory lives.
const SHARED: &str = "/dev/shm";

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
                Ok(()) => return Ok(root),
                Err(rustix::io::Errno::EXIST) => run = run.wrapping_add(1),
                Err(error) => {
                    return Err(CouplingError::SharedMemory(format!(
                        "cannot make {}: {error}",
                        root.path().display()
                    )));
                }
            }
        }
    }

    /// The place of a run that somebody else made, by its name.
    ///
    /// # Errors
    /// A name that is none of a run, a place that is not there.
    pub fn open(name: &str) -> Result<Self, CouplingError> {
        let run = name.rsplit('-').next().and_then(|number| u64::from_str_radix(number, 16).ok());
        let known = name.starts_with("amberfield-") && !name.contains('/');
        let (Some(run), true) = (run, known) else {
            return Err(CouplingError::SharedMemory(format!("'{name}' is not the name of a run")));
        };
        let root = Self { name: name.to_owned(), run, owned: false };
        match std::fs::read_dir(root.path()) {
            Ok(_) => Ok(root),
            Err(error) => Err(CouplingError::SharedMemory(format!("cannot open run {name}: {error}"))),
        }
    }

    /// Its name, for the field process.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
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

    /// What every piece of shared memory of this run is named after.
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

fn name_of(run: u64) -> String {
    format!("amberfield-{}-{run:016x}", rustix::process::getuid().as_raw())
}

/// Removes a run's place and all that bears its name; what is gone already does not matter.
fn remove(name: &str) {
    let prefix = format!("{name}.");
    for entry in std::fs::read_dir(SHARED).into_iter().flatten().flatten() {
        if entry.file_name().to_string_lossy().starts_with(&prefix) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
    let _ = std::fs::remove_dir_all(Path::new(SHARED).join(name));
}

/// Names of this user's runs whose DEM process is gone; with `clean` they are removed.
#[must_use]
pub fn stale_runs(clean: bool) -> Vec<String> {
    let mine = format!("amberfield-{}-", rustix::process::getuid().as_raw());
    let mut stale = Vec::new();
    for entry in std::fs::read_dir(SHARED).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        if !name.starts_with(&mine) || name.contains('.') || crate::link::dem_is_alive_in(&name) {
            continue;
        }
        if clean {
            remove(&name);
        }
        stale.push(name);
    }
    stale.sort();
    stale
}
