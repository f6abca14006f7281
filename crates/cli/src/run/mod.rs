//! Parts of a run: its folder, its schedule, its records.

#[cfg(feature = "coupling")]
mod bare_patches;
mod exits;
mod folder;
mod health;
pub(crate) mod histogram;
mod name;
mod picture;
mod record;
mod schedule;
mod session;
mod setup;
#[cfg_attr(not(feature = "coupling"), path = "without_solver.rs")]
mod solver;
mod solver_folder;
mod summary;
mod wall_forces;

pub(crate) use folder::{Existing, RunFolder, checkpoints, is_stale, remove_leftovers};
pub(crate) use name::scene_name;
pub(crate) use picture::draw;
pub(crate) use record::Clock;
pub(crate) use session::{EarlierPart, Saved, Session};
pub(crate) use setup::{
    CaseContents, Charges, SolverConnections, charges_of, domain_of, field_of, parameters, setup_of,
};
pub(crate) use solver::{case_contents, clear_solver_folder, connect_solver, read_scene};
pub(crate) use solver_folder::SolverFolder;
pub(crate) use summary::Ending;
