//! Border to C: arrays come in, texts go out, no panic crosses it.

use crate::status::AmberfieldStatus;
use std::ffi::CString;
use std::panic::{AssertUnwindSafe, catch_unwind};

const PANIC: &str = "a bug of amberfield: its library panicked";

/// Runs a call; an error or a panic becomes the handle's text.
pub(crate) fn guarded(
    error: &mut CString,
    call: impl FnOnce() -> Result<AmberfieldStatus, String>,
) -> AmberfieldStatus {
    match catch_unwind(AssertUnwindSafe(call)).unwrap_or_else(|_| Err(PANIC.to_owned())) {
        Ok(status) => {
            *error = CString::default();
            status
        }
        Err(text) => {
            *error = CString::new(text.replace('\0', " ")).unwrap_or_default();
            AmberfieldStatus::Failed
        }
    }
}

/// Drops a handle that `Box::into_raw` made; NULL is allowed.
///
/// # Safety
/// Nobody uses it any more.
pub(crate) unsafe fn close<T>(handle: *mut T) {
    if !handle.is_null() {
        // SAFETY: the caller's promise.
        let handle = unsafe { Box::from_raw(handle) };
        let _ = catch_unwind(AssertUnwindSafe(|| drop(handle)));
    }
}

/// An array of C as a slice; with `count` 0 the pointer does not matter.
///
/// # Safety
/// `count` elements lie there.
pub(crate) unsafe fn slice<'a, T>(pointer: *const T, count: usize) -> &'a [T] {
    if count == 0 {
        return &[];
    }
    // SAFETY: the caller's promise.
    unsafe { std::slice::from_raw_parts(pointer, count) }
}

/// An array of C as a slice that may be written; with `count` 0 the pointer does not matter.
///
/// # Safety
/// `count` elements lie there, and nobody else uses them.
pub(crate) unsafe fn slice_mut<'a, T>(pointer: *mut T, count: usize) -> &'a mut [T] {
    if count == 0 {
        return &mut [];
    }
    // SAFETY: the caller's promise.
    unsafe { std::slice::from_raw_parts_mut(pointer, count) }
}
