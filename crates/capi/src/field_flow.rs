//! The field side of a gas's flow: take what the grains do to it, answer, hand over and take in its state.

use crate::field_side::{AmberfieldField, AmberfieldStatus, with};
use crate::foreign::{slice, slice_mut};
use amberfield_coupling::{CouplingError, FlowReply};
use amberfield_wire::payloads::FlowAnswer;
use amberfield_wire::{Section, WireError};

/// The flow at this rank's cell centres. Vectors are three doubles each.
#[repr(C)]
#[derive(Debug)]
pub struct AmberfieldFlow {
    /// This rank's cells.
    pub cells: u64,
    /// Velocity of the gas [m/s].
    pub velocity: *const f64,
    /// Gradient of the pressure without the gas's own weight [Pa/m].
    pub pressure_gradient: *const f64,
    /// Divergence of the viscous stress [N/m^3], or NULL where it is not wanted.
    pub viscous_force: *const f64,
    /// Vorticity [1/s], or NULL where it is not wanted.
    pub vorticity: *const f64,
    /// Iterations, residual and time of the solver.
    pub answer: FlowAnswer,
}

/// Copies what the grains do to the gas in this rank's cells, which feels source - drag * velocity [N/m^3]: void fraction, drag [kg/(m^3 s)], source (three doubles each).
///
/// # Safety
/// As amberfield_field_error; the arrays have room for `cells` entries, this rank's cells.
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

/// Answers an interval of the flow.
///
/// # Safety
/// As amberfield_field_error; the flow's arrays have the lengths that it says.
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
    let reply = FlowReply {
        velocity: array(flow.velocity),
        pressure_gradient: array(flow.pressure_gradient),
        viscous_force: array(flow.viscous_force),
        vorticity: array(flow.vorticity),
        answer: flow.answer,
    };
    // SAFETY: the caller's promise.
    unsafe { with(field, |side| side.reply_flow(&reply).map(|()| AmberfieldStatus::Ok)) }
}

/// Answers a question for the state of this rank's part of the flow: `count` numbers of its own; none after a state was taken in.
///
/// # Safety
/// As amberfield_field_error; `state` has `count` numbers.
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

/// Copies the state that this rank is to take in: as many numbers as it answered once.
///
/// # Safety
/// As amberfield_field_error; `state` has room for `count` numbers.
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
