//! The internal grid: nodes at cell centres, transforms that know the faces, and the smooth level on it.

mod assignment;
pub(crate) mod axis;
pub(crate) mod influence;
pub(crate) mod level;
mod nodes;
pub(crate) mod over_ranks;
pub(crate) mod shapes;
pub(crate) mod solve;
pub(crate) mod transform;
pub(crate) mod window;
