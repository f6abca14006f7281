//! What plots and pictures are drawn on: pixels or SVG.

mod font;
mod raster;
mod svg;

pub(crate) use raster::{Raster, blend};
pub(crate) use svg::Svg;

use crate::colour::Colour;

/// Which point of a text its coordinates give.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A text and how it looks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Text<'a> {
    pub(crate) text: &'a str,
    /// Height of the letters' em [px].
    pub(crate) size: f64,
    pub(crate) anchor: Anchor,
    pub(crate) colour: Colour,
    /// Whether it reads upwards.
    pub(crate) upwards: bool,
}

/// Something to draw on; coordinates in pixels, x to the right, y down.
pub(crate) trait Surface {
    /// A line through the points, of the given width [px].
    fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Colour);
    /// A filled rectangle from its upper left corner.
    fn rectangle(&mut self, corner: [f64; 2], size: [f64; 2], colour: Colour);
    /// A filled disc.
    fn disc(&mut self, centre: [f64; 2], radius: f64, colour: Colour);
    /// A text whose baseline passes through the point.
    fn text(&mut self, at: [f64; 2], text: Text<'_>);
}

/// Width of a text [px].
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    font::width(text, size)
}
