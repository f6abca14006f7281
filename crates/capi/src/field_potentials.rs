//! The field side of potentials that change with time.

use crate::field_side::{AmberfieldField, with};
use crate::foreign::{slice, slice_mut};
use crate::status::AmberfieldStatus;
use amberfield_coupling::CouplingError;
use amberfield_wire::{Section, WireError};

/// Copies the times [s] at which the potentials of the patches that change are asked for: as many as the
/// request says.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `times` has room for `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_times(
    field: *mut AmberfieldField,
    times: *mut f64,
    count: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let times = slice_mut(times, count as usize);
        with(field, |side| {
            let asked = side.times()?;
            if asked.len() != times.len() {
                let error =
                    WireError::Count { section: Section::Times, theirs: asked.len(), ours: times.len() };
                return Err(CouplingError::Wire { peer: "DEM process", error });
            }
            times.copy_from_slice(asked);
            Ok(AmberfieldStatus::Ok)
        })
    }
}

/// Answers the question for the potentials [V] of the patches that change with `count` numbers: patch by
/// patch in the order in which the mesh names them, all times of each. One that is not known is no number.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `potentials` has `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_reply_potentials(
    field: *mut AmberfieldField,
    potentials: *const f64,
    count: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let potentials = slice(potentials, count as usize);
        with(field, |side| side.reply_potentials(potentials).map(|()| AmberfieldStatus::Ok))
    }
}
