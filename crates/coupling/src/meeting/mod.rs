//! The place where both processes meet: a run's folder in shared memory, and the two channels in it.

mod link;
mod living;
mod run_root;

pub(crate) use link::{Link, Message, SideOf};
pub use living::stale_runs;
pub use run_root::RunRoot;
