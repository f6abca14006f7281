//! Pictures of the bed and curves, of what was computed.
//!
//! Drawings carry their font with them and need nothing from the machine; the same input gives the same file.
#![forbid(unsafe_code)]

mod colour;
mod error;
mod font;
mod picture;
mod plot;
mod raster;
mod ticks;

pub use error::DrawError;
pub use picture::{PictureScene, write_picture};
pub use plot::{Plot, Scale, Series, write_plot};
