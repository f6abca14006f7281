//! Outcome of the calls of the C library.

/// Outcome of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AmberfieldStatus {
    /// Done.
    Ok = 0,
    /// The run is over: close and leave.
    Over = 1,
    /// Failure: amberfield_field_error or amberfield_host_error says why.
    Failed = 2,
    /// Failure of this rank alone, of those that share a field: others may wait for it. End the program.
    Broken = 3,
}
