//! Running the `amberfield` binary in a folder of its own.

mod bench;

pub use bench::{Answer, Bench, Table};
