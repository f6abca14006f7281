//! Parts of a run: its folder, its schedule, its records.

#[cfg(feature = "coupling")]
mod bare_patches;
mod begin;
mod exits;
#[cfg(feature = "coupling")]
mod face_potentials;
mod folder;
mod health;
pub(crate) mod histogram;
mod name;
mod observer;
mod picture;
mod record;
mod schedule;
mod session;
mod setup;
mod simulate;
#[cfg_attr(not(feature = "coupling"), path = "without_solver.rs")]
mod solver;
mod solver_folder;
mod summary;
mod wall_forces;
mod walls;

pub(crate) use begin::begin;
pub(crate) use folder::{is_stale, remove_leftovers};
pub(crate) use name::scene_name;
pub use observer::Observer;
pub(crate) use session::Saved;
pub use setup::parameters;
pub(crate) use setup::{Charges, SolverConnections, charges_of, domain_of, field_of, read_scene, setup_of};
pub use simulate::{Outcome, RunRequest, simulate};
pub(crate) use solver::connect_solver;
pub(crate) use solver_folder::SolverFolder;
