//! The DEM side: makes the run's place, starts the field process, asks it for the far field and the flow of a
//! gas.

mod announced;
mod far;
mod flow;
mod launch;
mod patient;
mod potentials;
mod remote;
mod settings;
mod shared;
mod surroundings;

pub use announced::Announced;
pub use far::RemoteSolver;
pub use flow::RemoteFlow;
pub use launch::{program_name, solver_program};
pub use patient::PatientSolver;
pub use settings::SolverSettings;
pub use surroundings::{Surroundings, existing};
