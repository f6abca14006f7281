//! The electric field at every particle of a scene.
//!
//! E = near + far + boundary + external (+ correction), see [`ElectricField::evaluate`].

mod boundary_field;
mod candidates;
mod charges;
mod chebyshev;
mod cutoff;
mod direct;
mod electric_field;
mod error;
mod error_model;
pub mod far;
mod grid;
mod image_cells;
mod images;
mod inputs;
mod kolehmainen;
mod method;
mod near;
mod outside;
mod p3m;
mod plan;
mod processor;
mod scratch;
mod shapes;
mod stopwatch;
mod tuning;
mod values;

pub use boundary_field::BoundaryField;
pub use candidates::Candidate;
pub use cutoff::Cutoff;
pub use direct::Direct;
pub use electric_field::{Choice, ElectricField, Measured, Statistics};
pub use error::FieldError;
pub use kolehmainen::Kolehmainen;
pub use method::FieldMethod;
pub use p3m::P3mParameters;
pub use values::{Components, FieldValues, Wanted};
