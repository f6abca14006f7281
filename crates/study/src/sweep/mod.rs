//! Error against run time: methods and parameters swept over problems, each answer checked against the
//! truth before it is timed.
//!
//! A problem is a scene with overrides, a method is more overrides: any point of a study is a scene that
//! everyone can run. What computes fields is given from outside, see [`Laboratory`].

mod comparison;
mod description;
mod extremes;
mod extremes_page;
mod front;
mod laboratory;
mod motion;
mod motion_page;
mod page;
mod points;
mod row;

pub use description::{Ends, Extreme, Goal, GroundedBox, Method, Motion, Problem, Study, Sweep, Truth};
pub use extremes::{EnergyRow, ExtremeRow, run_extremes};
pub use laboratory::{Endured, Evaluation, Exact, Laboratory, Look, Moved, Peer, Provenance};
pub use motion::{MotionRow, run_motions};
pub use page::{Results, write_report};
pub use points::run;
pub use row::Row;
