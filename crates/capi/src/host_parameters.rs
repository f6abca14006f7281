//! Parameters of a host's field: how good they are, and their way into the host's own restart files.

use crate::host::{AmberfieldHost, NOT_OPEN, Particles, call};
use crate::status::AmberfieldStatus;
use amberfield_field::Choice;
use serde::{Deserialize, Serialize};
use std::ffi::{CStr, CString, c_char};

/// Parameters as they stand in a text. In TOML all digits of a number survive.
#[derive(Serialize, Deserialize)]
struct Parameters {
    choice: Choice,
}

/// Returns the relative RMS error of E that was measured last, when parameters were chosen or by
/// amberfield_host_recheck; 0 where the sum is exact, and below 0 where none was measured, as with parameters
/// from a restart file or without any charge.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_measured_error(host: *const AmberfieldHost) -> f64 {
    // SAFETY: the caller's promise.
    unsafe { &*host }.measured.unwrap_or(-1.0)
}

/// Measures the error of E on a sample of particles, which have moved since parameters were chosen. Where it
/// has left the tolerance, the next call chooses parameters anew. Those of an OpenFOAM case stay. Particles
/// are as in amberfield_host_field.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed; the arrays have `count` particles.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_recheck(
    host: *mut AmberfieldHost,
    count: u64,
    positions: *const f64,
    charges: *const f64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    let (host, particles) = unsafe { (&mut *host, Particles::new(count, positions, charges)) };
    call(host, |host| host.recheck(particles))
}

/// Returns the parameters in force as text, for amberfield_host_use_parameters of a later run; empty before
/// the first field, and with an OpenFOAM case on all ranks but 0. The text is valid until the next call.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_parameters(host: *mut AmberfieldHost) -> *const c_char {
    // SAFETY: the caller's promise.
    let host = unsafe { &mut *host };
    let written = |choice: &Choice| toml::to_string(&Parameters { choice: choice.clone() }).ok();
    let text = host.field.as_ref().and_then(|field| written(field.choice()));
    host.parameters = CString::new(text.unwrap_or_default()).unwrap_or_default();
    host.parameters.as_ptr()
}

/// Takes the parameters of an earlier run, instead of choosing some at the next call.
///
/// # Safety
/// `host` comes from amberfield_host_open and is not closed; `parameters` is a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_host_use_parameters(
    host: *mut AmberfieldHost,
    parameters: *const c_char,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    let (host, text) = unsafe { (&mut *host, CStr::from_ptr(parameters)) };
    call(host, |host| {
        let scene = host.scene.as_mut().ok_or(NOT_OPEN)?;
        let read = toml::from_str::<Parameters>(&text.to_string_lossy());
        let read = read.map_err(|error| format!("parameters of an earlier run: {}", error.message()))?;
        scene.choice = Some(read.choice);
        host.field = None;
        host.measured = None;
        Ok(())
    })
}
