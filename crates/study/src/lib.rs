//! Measuring: error against run time, speed and memory, ours and the peers'.
//!
//! [`sweep`] runs the studies of `amberfield study`; the program in `speed` is `cargo xtask bench`.
#![forbid(unsafe_code)]

mod error;
#[cfg(feature = "speed")]
pub mod machine;
pub mod peers;
mod store;
pub mod sweep;
pub mod templates;

pub use error::StudyError;
pub use store::{Store, today};
