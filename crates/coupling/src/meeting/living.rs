//! Runs of this user, and whether their DEM processes live.

use super::link::{DEM, config_of, is_alive};
use super::run_root::{RunRoot, own_runs, remove};
use crate::CouplingError;
use std::time::{Duration, Instant};

/// Time between two looks for a run that waits.
const POLL: Duration = Duration::from_millis(20);

impl RunRoot {
    /// Opens the one run of this user that waits for a field solver; until the deadline there may be none
    /// yet.
    ///
    /// # Errors
    /// None, or several.
    pub fn open_waiting(deadline: Instant) -> Result<Self, CouplingError> {
        loop {
            let mut waiting = own_runs();
            waiting.retain(|name| Self::invites(name) && dem_is_alive(name));
            match waiting.as_slice() {
                [name] => return Self::open(name),
                [] if Instant::now() < deadline => std::thread::sleep(POLL),
                [] => {
                    return Err(CouplingError::SharedMemory(
                        "no run of this user waits for a field solver; start one whose scene has \
                         solver.start = false, or name it with -run"
                            .into(),
                    ));
                }
                several => {
                    return Err(CouplingError::SharedMemory(format!(
                        "several runs wait for a field solver ({}); name one with -run",
                        several.join(", ")
                    )));
                }
            }
        }
    }
}

/// Names of this user's runs whose DEM process is gone; with `clean` they are removed.
#[must_use]
pub fn stale_runs(clean: bool) -> Vec<String> {
    let mut stale = own_runs();
    stale.retain(|name| !dem_is_alive(name));
    if clean {
        stale.iter().for_each(|name| remove(name));
    }
    stale
}

/// Whether the DEM process of a run lives, by the run's name.
fn dem_is_alive(name: &str) -> bool {
    RunRoot::open(name).and_then(|root| config_of(&root)).is_ok_and(|config| is_alive(&config, DEM))
}
