//! Levels that are added up: every level gives one part of E at the particles.

mod copies;
pub(crate) mod external;
pub(crate) mod faces;
pub mod far;
pub(crate) mod grid;
pub(crate) mod near;
pub(crate) mod surfaces;
mod walls;
