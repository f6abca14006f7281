//! The place where both processes meet: a run's folder in shared memory, and the two channels in it. Ranks on
//! other machines have letters instead.

mod line;
mod link;
mod living;
mod run_root;

pub(crate) use line::{Line, Mailbox, Place};
pub(crate) use link::{Link, Message, SideOf};
pub use living::stale_runs;
pub use run_root::RunRoot;
