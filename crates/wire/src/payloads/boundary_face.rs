//! A face on the boundary of a mesh.

use crate::Element;
use std::mem::{offset_of, size_of};

/// Face on the boundary of one rank's cells, and the condition there.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundaryFace {
    /// Centre [m].
    pub centre_m: [f64; 3],
    /// Unit normal out of the mesh.
    pub normal: [f64; 3],
    /// Area [m^2].
    pub area_m2: f64,
    /// Cell of this rank that the face belongs to.
    pub cell: u64,
    /// Patch that the face belongs to, by its place among all patches.
    pub patch: u64,
    /// 1: the potential is prescribed; 0: its outward slope is.
    pub is_conductor: u64,
    /// Prescribed potential [V] or outward slope [V/m].
    pub prescribed: f64,
    /// Mean over the corners of (x - x of the centre)^2 [m^2].
    pub spread_xx_m2: f64,
    /// Mean over the corners of (x - x of the centre)(y - y of the centre) [m^2].
    pub spread_xy_m2: f64,
    /// Mean over the corners of (x - x of the centre)(z - z of the centre) [m^2].
    pub spread_xz_m2: f64,
    /// Mean over the corners of (y - y of the centre)^2 [m^2].
    pub spread_yy_m2: f64,
    /// Mean over the corners of (y - y of the centre)(z - z of the centre) [m^2].
    pub spread_yz_m2: f64,
    /// Mean over the corners of (z - z of the centre)^2 [m^2].
    pub spread_zz_m2: f64,
}

// SAFETY: seventeen numbers without padding, see below.
unsafe impl Element for BoundaryFace {}

const _: () = {
    assert!(size_of::<BoundaryFace>() == 136);
    assert!(offset_of!(BoundaryFace, centre_m) == 0);
    assert!(offset_of!(BoundaryFace, normal) == 24);
    assert!(offset_of!(BoundaryFace, area_m2) == 48);
    assert!(offset_of!(BoundaryFace, cell) == 56);
    assert!(offset_of!(BoundaryFace, patch) == 64);
    assert!(offset_of!(BoundaryFace, is_conductor) == 72);
    assert!(offset_of!(BoundaryFace, prescribed) == 80);
    assert!(offset_of!(BoundaryFace, spread_xx_m2) == 88);
    assert!(offset_of!(BoundaryFace, spread_zz_m2) == 128);
};
