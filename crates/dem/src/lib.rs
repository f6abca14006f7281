//! Moves grains: neighbours, contacts with history, walls, integrator, step, checkpoint state.
//!
//! A scene is a [`Setup`]; [`Simulation::new`] checks it, compiles it into stages and [`Simulation::step`]
//! runs them. Results are bit-identical for any number of threads of the caller's rayon pool.
#![forbid(unsafe_code)]

mod cells;
mod charging;
mod chunks;
mod contact_batch;
mod contact_law;
mod energy;
mod error;
mod field_stage;
mod gas_stage;
mod grains;
mod guards;
mod integrate;
mod material_pairs;
mod mesh_wall;
mod neighbours;
mod pair_forces;
mod setup;
mod simulation;
mod start_checks;
mod state;
mod timing;
mod walls;
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
pub use energy::{ElectricEnergy, Energies};
pub use error::DemError;
pub use field_stage::{Intervals, Limited};
pub use guards::Guard;
pub use setup::{FieldStageSetup, GasSetup, Setup};
pub use simulation::{Deepest, Simulation};
pub use state::State;
