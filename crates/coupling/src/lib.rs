//! Who waits for whom: the far field and the flow of a gas in another process, or a stand-in for the field in this one.
//!
//! The only code that opens iceoryx2 (`link.rs`). The DEM side owns the run's folder in shared memory and creates everything in
//! it; the field side opens what it finds.

mod box_solver;
mod dem_side;
mod error;
mod field_flow;
mod field_side;
mod launch;
mod link;
mod mesh_arrays;
mod mesh_message;
mod patient;
mod remote;
mod remote_flow;
mod run_root;

pub use box_solver::BoxSolver;
pub use dem_side::{Announced, RemoteSolver, SolverSettings};
pub use error::CouplingError;
pub use field_flow::{FlowReply, GrainsInCells};
pub use field_side::{FieldSide, Question, Reply};
pub use launch::{foam_command, program_name, solver_program};
pub use mesh_arrays::MeshArrays;
pub use mesh_message::{MeshPart, assemble};
pub use patient::PatientSolver;
pub use remote_flow::RemoteFlow;
pub use run_root::{RunRoot, stale_runs};
