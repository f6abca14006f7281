//! The outline of a mesh, and which of its cells one rank has.

use crate::Element;
use std::mem::{offset_of, size_of};

/// Box and periodic axes of the mesh of all ranks, and where the cells of one rank are among them.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshOutline {
    /// Lower corner of the cells of all ranks [m].
    pub low_m: [f64; 3],
    /// Upper corner of the cells of all ranks [m].
    pub high_m: [f64; 3],
    /// 1 for every axis that cyclic patches join.
    pub periodic: [u64; 3],
    /// Number of cells of lower ranks, which is the number of this rank's first cell.
    pub first_cell: u64,
    /// Number of cells of all ranks.
    pub all_cells: u64,
}

// SAFETY: eleven numbers without padding, see below.
unsafe impl Element for MeshOutline {}

const _: () = {
    assert!(size_of::<MeshOutline>() == 88);
    assert!(offset_of!(MeshOutline, low_m) == 0);
    assert!(offset_of!(MeshOutline, high_m) == 24);
    assert!(offset_of!(MeshOutline, periodic) == 48);
    assert!(offset_of!(MeshOutline, first_cell) == 72);
    assert!(offset_of!(MeshOutline, all_cells) == 80);
};
