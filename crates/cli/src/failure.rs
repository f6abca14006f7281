//! Why a command ends early, and with which exit code.

use crate::print;
use amberfield_dem::DemError;
use amberfield_field::FieldError;
use amberfield_gas::GasError;
use amberfield_scene::SceneError;

/// Bad input.
const EXIT_INPUT: u8 = 2;
/// A peer that is lost or does not answer.
const EXIT_PEER: u8 = 3;
/// An answer outside its tolerance.
const EXIT_TOLERANCE: u8 = 4;
/// A bug of ours; the code of a panic.
pub(crate) const EXIT_BUG: u8 = 101;

/// An end with an exit code other than 0.
#[derive(Debug)]
pub(crate) struct Failure {
    code: u8,
    message: String,
}

impl Failure {
    /// Bad input: exit code 2.
    pub(crate) fn bad_input(message: impl Into<String>) -> Self {
        Self { code: EXIT_INPUT, message: message.into() }
    }

    /// An answer that cannot be trusted: exit code 4.
    pub(crate) fn outside_tolerance(message: impl Into<String>) -> Self {
        Self { code: EXIT_TOLERANCE, message: message.into() }
    }

    /// A study that cannot be read or written.
    #[cfg(feature = "plots")]
    pub(crate) fn of_study(error: &amberfield_study::StudyError) -> Self {
        Self::bad_input(error.to_string())
    }

    /// A simulation that cannot start.
    pub(crate) fn at_start(error: &DemError) -> Self {
        match error {
            DemError::Field(error) => Self::of_field(error),
            DemError::Gas(GasError::Solver(message)) => Self::of_peer(message),
            error => Self::bad_input(error.to_string()),
        }
    }

    /// A simulation that cannot go on.
    pub(crate) fn while_running(error: &DemError) -> Self {
        match error {
            DemError::Field(error @ FieldError::Solver(_)) => Self::of_field(error),
            DemError::Gas(GasError::Solver(message)) => Self::of_peer(message),
            error => Self::outside_tolerance(error.to_string()),
        }
    }

    /// A field that cannot be computed.
    pub(crate) fn of_field(error: &FieldError) -> Self {
        match error {
            FieldError::Tolerance { .. } => Self::outside_tolerance(error.to_string()),
            FieldError::Solver(message) => Self::of_peer(message),
            error => Self::bad_input(error.to_string()),
        }
    }

    /// A process that is lost.
    fn of_peer(message: &str) -> Self {
        Self { code: EXIT_PEER, message: message.to_owned() }
    }

    /// The same failure, with more to say.
    pub(crate) fn with(mut self, more: &str) -> Self {
        self.message += more;
        self
    }

    /// The message.
    pub(crate) fn message(&self) -> &str {
        &self.message
    }

    /// Prints the message, one line each where there are several.
    pub(crate) fn report(&self) {
        for line in self.message.lines() {
            print::error(format_args!("{line}"));
        }
    }

    /// The exit code.
    pub(crate) fn code(&self) -> u8 {
        self.code
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        Self::bad_input(error.to_string())
    }
}
