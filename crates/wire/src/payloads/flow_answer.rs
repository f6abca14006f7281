//! The answer of one rank to the question for the flow of a gas, arrays apart.

use crate::Element;
use std::mem::{offset_of, size_of};

/// Numbers that a rank answers beside the flow at its cells.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlowAnswer {
    /// Iterations of the linear solver for the pressure.
    pub iterations: u64,
    /// Error of continuity: RMS over the cells of d(void fraction)/dt + div(void fraction * velocity),
    /// times the interval.
    pub residual: f64,
    /// Time that the solver took [s].
    pub seconds: f64,
    /// Steps of the flow in the interval.
    pub steps: u64,
    /// Largest Courant number of a step.
    pub courant: f64,
}

// SAFETY: five numbers without padding, see below.
unsafe impl Element for FlowAnswer {}

const _: () = {
    assert!(size_of::<FlowAnswer>() == 40);
    assert!(offset_of!(FlowAnswer, iterations) == 0);
    assert!(offset_of!(FlowAnswer, residual) == 8);
    assert!(offset_of!(FlowAnswer, seconds) == 16);
    assert!(offset_of!(FlowAnswer, steps) == 24);
    assert!(offset_of!(FlowAnswer, courant) == 32);
};
