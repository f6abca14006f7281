//! The electric field at every particle of a scene.
//!
//! E = near + far + boundary + external (+ correction), see [`ElectricField::evaluate`].

mod electric_field;
mod error;
mod grid;
mod values;

pub use electric_field::{Choice, ElectricField, Measured, Statistics};
pub use error::FieldError;
pub use values::{Components, FieldValues, Wanted};
