//! Commands of amberfield, for its binary and for programs that host them.
#![forbid(unsafe_code)]

mod arguments;
mod command;
mod commands;
mod failure;
pub mod interrupt;
mod limits;
mod logging;
mod machine;
mod plan_text;
mod print;
mod progress;
mod run;
mod terminal;

pub use crate::command::command;
pub use crate::failure::Failure;
pub use crate::logging::Log;
pub use crate::run::{Observer, Outcome, RunRequest, parameters, simulate};
