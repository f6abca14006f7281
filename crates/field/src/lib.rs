//! The electric field at every particle of a scene.
//!
//! E = near + far + boundary + external (+ correction), see [`ElectricField::evaluate`].

mod choosing;
mod electric_field;
mod error;
mod geometry;
mod levels;
mod methods;
mod numerics;
mod plan;
mod values;

pub use choosing::candidates::Candidate;
pub use choosing::choice::{Choice, Measured};
pub use electric_field::{ElectricField, Statistics};
pub use error::FieldError;
pub use levels::faces::BoundaryField;
pub use levels::far;
pub use methods::cutoff::Cutoff;
pub use methods::direct::Direct;
pub use methods::kolehmainen::Kolehmainen;
pub use methods::method::FieldMethod;
pub use methods::p3m::P3mParameters;
pub use values::{Components, FieldValues, Wanted};
