//! Draws what was computed: pictures of the bed, curves.
//!
//! [`write_picture`] carries its font with it and needs nothing from the machine. The feature `plots` (on by
//! default) holds it.

#[cfg(feature = "plots")]
mod colour;
mod error;
#[cfg(feature = "plots")]
mod font;
#[cfg(feature = "plots")]
mod picture;
#[cfg(feature = "plots")]
mod plot;
#[cfg(feature = "plots")]
mod raster;
#[cfg(feature = "plots")]
mod ticks;

pub use error::StudyError;
#[cfg(feature = "plots")]
pub use picture::{PictureScene, write_picture};
#[cfg(feature = "plots")]
pub use plot::{Plot, Scale, Series, write_plot};
