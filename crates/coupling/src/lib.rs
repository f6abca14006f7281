//! Exchanges with the process that solves for the far field and the flow of a gas: who waits for whom. A
//! stand-in solves for the field in this process.
//!
//! The only code that opens iceoryx2 (`meeting/link.rs`). The DEM side owns the run's folder in shared memory
//! and creates everything in it; the field side opens what it finds.

mod case;
mod dem_side;
mod error;
mod field_side;
mod meeting;
mod mesh;
mod stand_in;

pub use case::{CaseContents, Stop, Workplace, foam_command, lacks_field};
pub use dem_side::{
    Announced, PatientSolver, RemoteFlow, RemoteSolver, SolverSettings, Surroundings, existing, program_name,
    solver_program,
};
pub use error::CouplingError;
pub use field_side::{FieldSide, FlowReply, GrainsInCells, Proxy, Question, Reply};
pub use meeting::{RunRoot, stale_runs};
pub use mesh::{MeshArrays, MeshPart, assemble};
pub use stand_in::BoxSolver;
