//! The internal grid: nodes at cell centres, transforms that know the faces, and the smooth level on it.

pub(crate) mod axis;
mod halo;
pub(crate) mod influence;
pub(crate) mod level;
pub(crate) mod shapes;
pub(crate) mod solve;
pub(crate) mod transform;
pub(crate) mod window;
