//! The mesh of a field solver as it travels from its ranks to the DEM side.

mod arrays;
mod part;

pub use arrays::MeshArrays;
pub use part::{MeshPart, assemble};
pub(crate) use part::{OwnCells, mesh_header, shapes_of};
