//! The field side: opens the run, sends its mesh, waits for a question, answers.

mod flow;
mod side;

pub use flow::{FlowReply, GrainsInCells};
pub use side::{FieldSide, Question, Reply};
