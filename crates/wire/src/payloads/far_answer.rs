//! The answer of one rank to the question for the far part of the field, arrays apart.

use crate::Element;
use std::mem::{offset_of, size_of};

/// Numbers that a rank answers beside potential and E at its cells.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarAnswer {
    /// Charge in the cells of the rank [C].
    pub charge_c: f64,
    /// Number of charges that lie outside the mesh.
    pub outside: u64,
    /// Iterations of the linear solver.
    pub iterations: u64,
    /// Final residual of the linear solver, relative.
    pub residual: f64,
    /// Time that the linear solver took [s].
    pub seconds: f64,
}

// SAFETY: five numbers without padding, see below.
unsafe impl Element for FarAnswer {}

const _: () = {
    assert!(size_of::<FarAnswer>() == 40);
    assert!(offset_of!(FarAnswer, charge_c) == 0);
    assert!(offset_of!(FarAnswer, outside) == 8);
    assert!(offset_of!(FarAnswer, iterations) == 16);
    assert!(offset_of!(FarAnswer, residual) == 24);
    assert!(offset_of!(FarAnswer, seconds) == 32);
};
