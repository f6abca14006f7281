//! Runs methods, checks the answer, then records the time; reports, plots and pictures.
//!
//! [`write_picture`] draws the bed; [`Plot`] draws curves. Both carry their font with them and need nothing from
//! the machine. The feature `plots` (on by default) holds them.

#[cfg(feature = "plots")]
mod canvas;
#[cfg(feature = "plots")]
mod colour;
mod error;
#[cfg(feature = "plots")]
mod picture;
#[cfg(feature = "plots")]
mod plot;
#[cfg(feature = "plots")]
mod ticks;

pub use error::StudyError;
#[cfg(feature = "plots")]
pub use picture::{PictureScene, write_picture};
#[cfg(feature = "plots")]
pub use plot::{AxisScale, Marks, Plot, PlotAxis, Series};
