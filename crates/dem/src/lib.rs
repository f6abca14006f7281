//! Moves grains: neighbours, contacts with history, walls, integrator, step, checkpoint state.
//!
//! A scene is a [`Setup`]; [`Simulation::new`] checks it, compiles it into stages and [`Simulation::step`]
//! runs them. Results are bit-identical for any number of threads of the caller's rayon pool.
#![forbid(unsafe_code)]

mod charging;
mod contacts;
mod error;
mod field_stage;
mod gas_stage;
mod motion;
mod setup;
mod simulation;
#[cfg(not(feature = "field"))]
mod without_field;

#[cfg(feature = "field")]
use amberfield_field as field_crate;
#[cfg(not(feature = "field"))]
use without_field as field_crate;

#[cfg(feature = "field")]
use amberfield_gas as gas_crate;
#[cfg(not(feature = "field"))]
use without_field::gas as gas_crate;

pub use charging::{Facet, Ledger};
pub use error::DemError;
pub use field_stage::{Intervals, Limited};
pub use setup::{FieldStageSetup, GasSetup, Setup};
pub use simulation::energy::{ElectricEnergy, Energies};
pub use simulation::guards::Guard;
pub use simulation::state::State;
pub use simulation::{Deepest, Simulation};
