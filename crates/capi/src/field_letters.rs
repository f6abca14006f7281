//! The field side over several machines: letters of ranks that cannot see the run's memory, and the proxies
//! that stand in it for them. The program carries the letters.

use crate::field_side::{AmberfieldField, with};
use crate::foreign::{close, guarded, slice};
use crate::status::AmberfieldStatus;
use amberfield_coupling::{FieldSide, Proxy, RunRoot};
use amberfield_wire::Letter;
use std::ffi::{CStr, CString, c_char};

/// Message as bytes, which are valid until the next call on the handle that they come from.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct AmberfieldLetter {
    /// The bytes.
    pub bytes: *const u8,
    /// Number of bytes; 0: no message.
    pub count: u64,
}

impl AmberfieldLetter {
    /// The letter that a handle keeps.
    fn of(kept: Option<&Letter>) -> Self {
        match kept {
            Some(letter) => Self { bytes: letter.bytes().as_ptr(), count: letter.bytes().len() as u64 },
            None => Self { bytes: std::ptr::null(), count: 0 },
        }
    }
}

/// Stands in the run's memory for a rank on another machine.
#[derive(Debug)]
pub struct AmberfieldProxy {
    proxy: Option<Proxy>,
    letter: Option<Letter>,
    error: CString,
}

/// Returns 1 if this machine has the memory of a run of this name, else 0.
///
/// # Safety
/// `run` is a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_run_is_here(run: *const c_char) -> u32 {
    // SAFETY: the caller's promise.
    let run = unsafe { CStr::from_ptr(run) }.to_string_lossy();
    u32::from(RunRoot::is_here(&run))
}

/// Returns the name of the run that a handle has open; empty if none is, or the machine is another than the
/// run's. The text is valid as long as the handle.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_run(field: *const AmberfieldField) -> *const c_char {
    // SAFETY: the caller's promise.
    unsafe { &*field }.run.as_ptr()
}

/// Opens one rank of so many on a machine that has not the memory of the run. All calls are as on any other
/// rank, but for two: what amberfield_field_letter gives after a call goes to the rank's proxy, and what the
/// proxy gives is delivered before amberfield_field_wait, which then does not wait. The result is never NULL;
/// amberfield_field_error is empty when it worked.
///
/// # Safety
/// `run` is a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_open_distant(
    run: *const c_char,
    rank: u32,
    ranks: u32,
) -> *mut AmberfieldField {
    // SAFETY: the caller's promise.
    let run = unsafe { CStr::from_ptr(run) }.to_string_lossy();
    AmberfieldField::opened(|| FieldSide::open_distant(&run, rank, ranks))
}

/// Gives the letter that the last call has left for the rank's proxy; none on a rank that needs no proxy.
///
/// # Safety
/// `field` comes from amberfield_field_open_distant and is not closed; `letter` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_letter(
    field: *mut AmberfieldField,
    letter: *mut AmberfieldLetter,
) -> AmberfieldStatus {
    let mut found = None;
    // SAFETY: the caller's promise.
    unsafe {
        let status = with(field, |side| {
            found = side.letter();
            Ok(AmberfieldStatus::Ok)
        });
        (*field).letter = found;
        *letter = AmberfieldLetter::of((*field).letter.as_ref());
        status
    }
}

/// Takes in a letter of the rank's proxy, before amberfield_field_wait.
///
/// # Safety
/// `field` comes from amberfield_field_open_distant and is not closed; `bytes` has `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_deliver(
    field: *mut AmberfieldField,
    bytes: *const u8,
    count: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let bytes = slice(bytes, count as usize);
        with(field, |side| side.deliver(bytes).map(|()| AmberfieldStatus::Ok))
    }
}

/// Opens the proxy of a rank on another machine, on one that has the run's memory. The result is never NULL;
/// amberfield_proxy_error is empty when it worked.
///
/// # Safety
/// `run` is a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_proxy_open(
    run: *const c_char,
    rank: u32,
    ranks: u32,
) -> *mut AmberfieldProxy {
    // SAFETY: the caller's promise.
    let run = unsafe { CStr::from_ptr(run) }.to_string_lossy();
    let mut handle = Box::new(AmberfieldProxy { proxy: None, letter: None, error: CString::default() });
    let AmberfieldProxy { proxy, error, .. } = &mut *handle;
    guarded(error, || {
        *proxy = Some(Proxy::open(&run, rank, ranks).map_err(|error| error.to_string())?);
        Ok(AmberfieldStatus::Ok)
    });
    Box::into_raw(handle)
}

/// Returns the reason why the last call on a proxy failed; empty if it did not. The text is valid until the
/// next call.
///
/// # Safety
/// `proxy` comes from amberfield_proxy_open and is not closed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_proxy_error(proxy: *const AmberfieldProxy) -> *const c_char {
    // SAFETY: the caller's promise.
    unsafe { &*proxy }.error.as_ptr()
}

/// Sends a letter of the rank's to the DEM process.
///
/// # Safety
/// `proxy` comes from amberfield_proxy_open and is not closed; `bytes` has `count` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_proxy_send(
    proxy: *mut AmberfieldProxy,
    bytes: *const u8,
    count: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    let (bytes, AmberfieldProxy { proxy, error, .. }) =
        unsafe { (slice(bytes, count as usize), &mut *proxy) };
    guarded(error, || {
        let proxy = proxy.as_mut().ok_or("the run is not open")?;
        proxy.send(bytes).map_err(|error| error.to_string())?;
        Ok(AmberfieldStatus::Ok)
    })
}

/// Waits for the next question of the DEM process and gives the rank's share of it, for
/// amberfield_field_deliver there; AmberfieldStatus_Over when there will be none.
///
/// # Safety
/// `proxy` comes from amberfield_proxy_open and is not closed; `letter` may be written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_proxy_wait(
    proxy: *mut AmberfieldProxy,
    letter: *mut AmberfieldLetter,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    let AmberfieldProxy { proxy, letter: kept, error } = unsafe { &mut *proxy };
    let status = guarded(error, || {
        *kept = None;
        let proxy = proxy.as_mut().ok_or("the run is not open")?;
        *kept = proxy.wait().map_err(|error| error.to_string())?;
        Ok(if kept.is_some() { AmberfieldStatus::Ok } else { AmberfieldStatus::Over })
    });
    // SAFETY: the caller's promise.
    unsafe { *letter = AmberfieldLetter::of(kept.as_ref()) };
    status
}

/// Closes a proxy. NULL is allowed.
///
/// # Safety
/// `proxy` comes from amberfield_proxy_open and is not closed; the handle is gone afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_proxy_close(proxy: *mut AmberfieldProxy) {
    // SAFETY: the caller's promise.
    unsafe { close(proxy) };
}
