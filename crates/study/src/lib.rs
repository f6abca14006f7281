//! Error against run time, and what was computed as pictures of the bed and curves.
//!
//! [`sweep`] runs studies. Pictures carry their font with them and need nothing from the machine. The
//! feature `plots` (on by default) holds all of it.
#![forbid(unsafe_code)]

#[cfg(feature = "plots")]
mod colour;
mod error;
#[cfg(feature = "plots")]
mod font;
pub mod peers;
#[cfg(feature = "plots")]
mod picture;
#[cfg(feature = "plots")]
mod plot;
#[cfg(feature = "plots")]
mod raster;
#[cfg(feature = "plots")]
pub mod sweep;
#[cfg(feature = "plots")]
mod ticks;

pub use error::StudyError;
#[cfg(feature = "plots")]
pub use picture::{PictureScene, write_picture};
#[cfg(feature = "plots")]
pub use plot::{Plot, Scale, Series, write_plot};
