//! Error against run time: [`sweep`] runs studies. The feature `plots` (on by default) holds all of it.
#![forbid(unsafe_code)]

mod error;
pub mod peers;
#[cfg(feature = "plots")]
pub mod sweep;

pub use error::StudyError;
