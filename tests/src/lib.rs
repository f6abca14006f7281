//! Running the `amberfield` binary in a folder of its own.

pub mod any_bytes;
mod bench;
mod foam_box;
pub mod foam_case;

pub use bench::{Answer, Bench, Table};
pub use foam_box::{DEADLINE, FoamBox};
