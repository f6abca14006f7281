//! The field side: opens the run, sends its mesh, waits for a question, answers.

mod density;
mod flow;
mod potentials;
mod proxy;
mod question;
mod share;
mod side;

pub use flow::{FlowReply, GrainsInCells};
pub use proxy::Proxy;
pub use question::Question;
pub use side::{FieldSide, Reply};
