//! Moves grains: neighbours, contacts with history, walls, integrator, step, checkpoint state.
//!
//! A scene is a [`Setup`]; [`Simulation::new`] checks it, compiles it into stages and [`Simulation::step`]
//! runs them. Results are bit-identical for any number of threads of the caller's rayon pool.
#![forbid(unsafe_code)]

mod books;
mod charging;
mod contacts;
mod error;
mod feeding;
mod field_stage;
mod gas_stage;
mod motion;
mod outlets;
mod setup;
mod simulation;
mod wall_cover;

pub use books::Tally;
pub use charging::{ChargedSpot, Ledger};
pub use contacts::walls::WallLoad;
pub use error::{DemError, SceneKey};
pub use feeding::{Brought, FeedAccount};
pub use field_stage::{Intervals, Limited};
pub use setup::{FieldStageSetup, GasSetup, Setup};
pub use simulation::books::Book;
pub use simulation::earlier::Earlier;
pub use simulation::energy::{ElectricEnergy, Energies};
pub use simulation::exits::{Exit, Left, WayOut};
pub use simulation::guards::{Guard, StepRestitution};
pub use simulation::outlook::Outlook;
pub use simulation::state::State;
pub use simulation::{Deepest, Simulation};
pub use wall_cover::WallCover;
