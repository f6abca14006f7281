//! The field side: opens the run, sends its mesh, waits for a question, answers.

mod density;
mod flow;
mod potentials;
mod question;
mod side;

pub use flow::{FlowReply, GrainsInCells};
pub use question::Question;
pub use side::{FieldSide, Reply};
