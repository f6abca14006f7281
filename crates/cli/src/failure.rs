//! Failures of commands, with their exit codes.

use crate::print;
use amberfield_dem::{DemError, SceneKey};
use amberfield_field::FieldError;
use amberfield_gas::GasError;
use amberfield_scene::{Scene, SceneError};

/// Exit code of bad input.
const EXIT_INPUT: u8 = 2;
/// Exit code of a peer that is lost or does not answer.
const EXIT_PEER: u8 = 3;
/// Exit code of an answer outside its tolerance.
const EXIT_TOLERANCE: u8 = 4;
/// Exit code of an interrupted program, by the convention of shells.
pub(crate) const EXIT_INTERRUPTED: u8 = 130;
/// Exit code of a bug in amberfield, which is that of a panic.
pub(crate) const EXIT_BUG: u8 = 101;

/// End of a command with a message and an exit code other than 0.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    message: String,
}

impl Failure {
    /// Failure by bad input: exit code 2.
    pub(crate) fn bad_input(message: impl Into<String>) -> Self {
        Self { code: EXIT_INPUT, message: message.into() }
    }

    /// Failure by an answer that cannot be trusted: exit code 4.
    pub(crate) fn outside_tolerance(message: impl Into<String>) -> Self {
        Self { code: EXIT_TOLERANCE, message: message.into() }
    }

    /// End by the user's interrupt: exit code 130.
    #[cfg(feature = "coupling")]
    pub(crate) fn interrupted(what: impl Into<String>) -> Self {
        Self { code: EXIT_INTERRUPTED, message: format!("stopped: {}", what.into()) }
    }

    /// Failure of a study that cannot be read or written.
    #[cfg(feature = "plots")]
    pub(crate) fn of_study(error: &amberfield_study::StudyError) -> Self {
        Self::bad_input(error.to_string())
    }

    /// Failure of a scene's simulation that cannot start; it names the place of the key that is to blame.
    pub(crate) fn of_scene(scene: &Scene, error: &DemError) -> Self {
        let key = match error {
            DemError::Key { key, .. } => Some(*key),
            DemError::Unstable { .. } => Some(SceneKey::of("time", &["step_s"])),
            DemError::GasInterval { .. } => Some(SceneKey::of("gas", &["interval_s"])),
            _ => None,
        };
        let place = key.and_then(|key| scene.cite(key.section, key.number, key.names));
        let failure = Self::at_start(error);
        match place {
            Some(place) => Self { message: format!("{place}: {}", failure.message), ..failure },
            None => failure,
        }
    }

    /// Failure of a simulation that cannot start.
    pub(crate) fn at_start(error: &DemError) -> Self {
        match error {
            DemError::Field(error) => Self::of_field(error),
            DemError::Gas(GasError::Solver(message)) => Self::of_peer(message),
            error => Self::bad_input(error.to_string()),
        }
    }

    /// Failure of a simulation that cannot continue.
    pub(crate) fn while_running(error: &DemError) -> Self {
        match error {
            DemError::Field(error @ (FieldError::Solver(_) | FieldError::Refused(_))) => {
                Self::of_field(error)
            }
            DemError::Gas(GasError::Solver(message)) => Self::of_peer(message),
            DemError::Gas(GasError::Refused(message)) => Self::bad_input(message),
            error => Self::outside_tolerance(error.to_string()),
        }
    }

    /// Failure of a field that cannot be computed.
    #[must_use]
    pub fn of_field(error: &FieldError) -> Self {
        match error {
            FieldError::Tolerance { .. } | FieldError::NotConverged(_) => {
                Self::outside_tolerance(error.to_string())
            }
            FieldError::Solver(message) => Self::of_peer(message),
            error => Self::bad_input(error.to_string()),
        }
    }

    /// Failure by a lost peer: exit code 3.
    fn of_peer(message: &str) -> Self {
        Self { code: EXIT_PEER, message: message.to_owned() }
    }

    /// Adds a text to the message.
    pub(crate) fn with(mut self, more: &str) -> Self {
        self.message += more;
        self
    }

    /// Message of the failure.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.message
    }

    /// Prints the message; each of its lines is an error of its own.
    pub(crate) fn report(&self) {
        for line in self.message.lines() {
            print::error(format_args!("{line}"));
        }
    }

    /// Exit code of the failure.
    #[must_use]
    pub fn code(&self) -> u8 {
        self.code
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::bad_input(error.to_string())
    }
}
