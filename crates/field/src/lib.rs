//! The electric field at every particle of a scene.
//!
//! E = near + middle + far + correction + faces + external
//!
//! [`ElectricField::evaluate`] computes the parts; `sum.rs` adds them, and nothing else does. Folders are
//! what is added up (`levels`), how methods combine it (`methods`), how parameters are chosen (`choosing`),
//! where charges and images are (`geometry`), who shares a field (`ranks`), and tools (`numerics`).

mod choosing;
mod electric_field;
mod error;
mod geometry;
mod levels;
mod methods;
mod numerics;
mod plan;
mod ranks;
mod sum;
mod values;

pub use choosing::candidates::Candidate;
pub use choosing::choice::{Choice, Measured};
pub use electric_field::{ConductorValues, ElectricField, GivenField, Statistics};
pub use error::FieldError;
pub use levels::faces::BoundaryField;
pub use levels::far;
pub use methods::cutoff::Cutoff;
pub use methods::direct::Direct;
pub use methods::kolehmainen::Kolehmainen;
pub use methods::method::{FieldMethod, TwoSplittings, UnitPotential};
pub use methods::p3m_parameters::P3mParameters;
pub use ranks::{Parcels, Ranks, ThreadRank};
pub use sum::{Levels, OwnClouds, Part};
pub use values::{Components, FieldAt, FieldValues, Wanted};
