//! Parameters of a host's field: how good they are, and their way into the host's own restart files.

use crate::foreign::{guarded, slice};
use crate::host_side::{AmberfieldHost, NOT_OPEN};
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
    let field = unsafe { &*host }.field.as_ref();
    let measured = field.map(|field| (field.choice(), field.error_measured()));
    match measured {
        Some((_, Some(measured))) => measured.relative_rms,
        Some((Choice::AllPairs | Choice::Direct, None)) => 0.0,
        _ => -1.0,
    }
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
    let count = count as usize;
    // SAFETY: the caller's promise; three doubles have the layout of an array of three.
    let (places, charges) = unsafe { (slice::<[f64; 3]>(positions.cast(), count), slice(charges, count)) };
    // SAFETY: the caller's promise.
    let host = unsafe { &mut *host };
    let mut error = std::mem::take(&mut host.error);
    let status = guarded(&mut error, || host.recheck(places, charges).map(|()| AmberfieldStatus::Ok));
    host.error = error;
    status
}

/// Returns the parameters in force as text, for amberfield_host_use_parameters of a later run; empty before
/// the first field. The text is valid until the next call.
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
    let AmberfieldHost { scene, field, error, .. } = host;
    guarded(error, || {
        let scene = scene.as_mut().ok_or(NOT_OPEN)?;
        let read = toml::from_str::<Parameters>(&text.to_string_lossy());
        let read = read.map_err(|error| format!("parameters of an earlier run: {}", error.message()))?;
        scene.choice = Some(read.choice);
        *field = None;
        Ok(AmberfieldStatus::Ok)
    })
}
