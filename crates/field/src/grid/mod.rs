//! The internal grid: nodes at cell centres, transforms that know the faces, and the smooth level on it.

pub(crate) mod bspline;
pub(crate) mod transform;
