//! The DEM side: makes the run's place, starts the field process, asks it for the far field and the flow of a gas.

mod flow;
mod launch;
mod patient;
mod remote;
mod solver;

pub use flow::RemoteFlow;
pub use launch::{foam_command, program_name, solver_program};
pub use patient::PatientSolver;
pub use solver::{Announced, RemoteSolver, SolverSettings};
