//! The field side of a gas's flow: takes what the grains do to it, answers, hands over and takes in its
//! state.

use crate::field_side::{AmberfieldField, with};
use crate::foreign::{slice, slice_mut};
use crate::status::AmberfieldStatus;
use amberfield_coupling::{CouplingError, FlowReply};
use amberfield_wire::payloads::FlowAnswer;
use amberfield_wire::{Section, WireError};
use std::ffi::{CStr, c_char};

/// The flow at this rank's cell centres. Vectors are three doubles each.
#[repr(C)]
#[derive(Debug)]
pub struct AmberfieldFlow {
    /// Number of this rank's cells.
    pub cells: u64,
    /// Velocity of the gas [m/s].
    pub velocity: *const f64,
    /// Gradient of the pressure without the gas's own weight [Pa/m].
    pub pressure_gradient: *const f64,
    /// Divergence of the viscous stress [N/m^3], or NULL where it is not wanted.
    pub viscous_force: *const f64,
    /// Vorticity [1/s], or NULL where it is not wanted.
    pub vorticity: *const f64,
    /// Iterations, residual, time, steps and Courant number of the solver.
    pub answer: FlowAnswer,
    /// Advice about the case for its mesh, to be shown to the user; NULL for nothing.
    pub advice: *const c_char,
}

/// Copies what the grains do to the gas in this rank's cells: void fraction, drag [kg/(m^3 s)] and source
/// [N/m^3] (three doubles each). The gas feels source - drag * velocity.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; the arrays have room for `cells` entries, this
/// rank's cells.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_grains(
    field: *mut AmberfieldField,
    void_fraction: *mut f64,
    drag: *mut f64,
    source: *mut f64,
    cells: u64,
) -> AmberfieldStatus {
    let cells = cells as usize;
    // SAFETY: the caller's promise; three doubles have the layout of an array of three.
    let (void_fraction, drag, source) = unsafe {
        (slice_mut(void_fraction, cells), slice_mut(drag, cells), slice_mut::<[f64; 3]>(source.cast(), cells))
    };
    // SAFETY: the caller's promise.
    unsafe {
        with(field, |side| {
            let grains = side.grains()?;
            check_count(Section::VoidFraction, grains.void_fraction.len(), cells)?;
            void_fraction.copy_from_slice(grains.void_fraction);
            drag.copy_from_slice(grains.drag);
            source.copy_from_slice(grains.source);
            Ok(AmberfieldStatus::Ok)
        })
    }
}

/// Answers the question for the flow at the end of an interval.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; the flow's arrays have the lengths that it
/// says, and its advice is a C string or NULL.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_reply_flow(
    field: *mut AmberfieldField,
    flow: *const AmberfieldFlow,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    let flow = unsafe { &*flow };
    let array = |pointer: *const f64| {
        let count = if pointer.is_null() { 0 } else { flow.cells as usize };
        // SAFETY: the caller's promise.
        unsafe { slice::<[f64; 3]>(pointer.cast(), count) }
    };
    let advice = if flow.advice.is_null() {
        String::new()
    } else {
        // SAFETY: the caller's promise.
        unsafe { CStr::from_ptr(flow.advice) }.to_string_lossy().into_owned()
    };
    let reply = FlowReply {
        velocity: array(flow.velocity),
        pressure_gradient: array(flow.pressure_gradient),
        viscous_force: array(flow.viscous_force),
        vorticity: array(flow.vorticity),
        answer: flow.answer,
        advice: &advice,
    };
    // SAFETY: the caller's promise.
    unsafe { with(field, |side| side.reply_flow(&reply).map(|()| AmberfieldStatus::Ok)) }
}

/// Answers the question for the state of this rank's part of the flow with `count` numbers, whose meaning is
/// the solver's own. After a state was taken in the answer has no number.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `state` has `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_reply_state(
    field: *mut AmberfieldField,
    state: *const f64,
    count: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let state = slice(state, count as usize);
        with(field, |side| side.reply_state(state).map(|()| AmberfieldStatus::Ok))
    }
}

/// Copies the state that this rank is to take in: as many numbers as it once answered with.
///
/// # Safety
/// `field` comes from amberfield_field_open and is not closed; `state` has room for `count` numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn amberfield_field_state(
    field: *mut AmberfieldField,
    state: *mut f64,
    count: u64,
) -> AmberfieldStatus {
    // SAFETY: the caller's promise.
    unsafe {
        let state = slice_mut(state, count as usize);
        with(field, |side| {
            let known = side.flow_state()?;
            check_count(Section::FlowState, known.len(), state.len())?;
            state.copy_from_slice(known);
            Ok(AmberfieldStatus::Ok)
        })
    }
}

fn check_count(section: Section, theirs: usize, ours: usize) -> Result<(), CouplingError> {
    if theirs == ours {
        return Ok(());
    }
    Err(CouplingError::Wire { peer: "DEM process", error: WireError::Count { section, theirs, ours } })
}
