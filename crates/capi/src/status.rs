//! How calls of the C library end.

/// Outcome of a call.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AmberfieldStatus {
    /// Done.
    Ok = 0,
    /// The run is over: close and leave.
    Over = 1,
    /// It failed: amberfield_field_error says why.
    Failed = 2,
}
