//! The grains and how they move: arrays sorted in space, pieces of work, velocity Verlet.

pub(crate) mod chunks;
pub(crate) mod grains;
pub(crate) mod verlet;
