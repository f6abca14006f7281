//! Pixels, drawn several times finer than they are written so that every edge is smooth.

use crate::DrawError;
use crate::colour::{Colour, PAPER};
use crate::font;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

/// Fine pixels per pixel and direction.
const FINENESS: usize = 3;

/// Point of a text that its coordinates give.
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
}

/// An image of a given size in pixels; coordinates in pixels, x to the right, y down.
pub(crate) struct Raster {
    width: usize,
    height: usize,
    fine: Vec<Colour>,
}

impl Raster {
    /// Blank paper of the given size [px].
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self { width, height, fine: vec![PAPER; width * height * FINENESS * FINENESS] }
    }

    /// Columns and rows of the fine pixels.
    pub(crate) fn fine_size(&self) -> [usize; 2] {
        [self.width * FINENESS, self.height * FINENESS]
    }

    /// Fine pixels per pixel.
    pub(crate) fn fineness(&self) -> f64 {
        FINENESS as f64
    }

    /// A fine pixel, by its number in reading order.
    pub(crate) fn fine_pixel(&mut self, index: usize) -> &mut Colour {
        &mut self.fine[index]
    }

    /// The image in reading order, three bytes a pixel: each the mean of its fine pixels.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        let columns = self.width * FINENESS;
        let mut bytes = Vec::with_capacity(self.width * self.height * 3);
        for row in 0..self.height {
            for column in 0..self.width {
                for channel in 0..3 {
                    let mut sum = 0_usize;
                    for fine_row in 0..FINENESS {
                        let start = (row * FINENESS + fine_row) * columns + column * FINENESS;
                        sum += self.fine[start..start + FINENESS]
                            .iter()
                            .map(|pixel| usize::from(pixel[channel]))
                            .sum::<usize>();
                    }
                    let count = FINENESS * FINENESS;
                    bytes.push(((sum + count / 2) / count) as u8);
                }
            }
        }
        bytes
    }

    /// Writes a PNG file.
    pub(crate) fn write_png(&self, path: &Path) -> Result<(), DrawError> {
        write_png(path, (self.width as u32, self.height as u32), &self.bytes())
    }

    /// A line through the points, of the given width [px].
    pub(crate) fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Colour) {
        let fineness = self.fineness();
        let half = 0.5 * width * fineness;
        for pair in points.windows(2) {
            let [a, b] = [pair[0], pair[1]].map(|point| point.map(|value| value * fineness));
            let along = [b[0] - a[0], b[1] - a[1]];
            let length_squared = along[0] * along[0] + along[1] * along[1];
            let low = [a[0].min(b[0]) - half, a[1].min(b[1]) - half];
            let high = [a[0].max(b[0]) + half, a[1].max(b[1]) + half];
            self.fill(low, high, colour, |x, y| {
                let from = [x - a[0], y - a[1]];
                let part = if length_squared > 0.0 {
                    ((from[0] * along[0] + from[1] * along[1]) / length_squared).clamp(0.0, 1.0)
                } else {
                    0.0
                };
                let off = [from[0] - part * along[0], from[1] - part * along[1]];
                off[0] * off[0] + off[1] * off[1] <= half * half
            });
        }
    }

    /// A filled rectangle from its upper left corner.
    pub(crate) fn rectangle(&mut self, corner: [f64; 2], size: [f64; 2], colour: Colour) {
        let fineness = self.fineness();
        let low = corner.map(|value| (value * fineness).round());
        let high = [0, 1].map(|axis| ((corner[axis] + size[axis]) * fineness).round());
        self.fill(low, high, colour, |_, _| true);
    }

    /// A text whose baseline passes through the point.
    pub(crate) fn text(&mut self, at: [f64; 2], text: Text<'_>) {
        let fineness = self.fineness();
        let size = text.size * fineness;
        let shift = match text.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * font::width(text.text, size),
            Anchor::End => -font::width(text.text, size),
        };
        let origin = at.map(|value| (value * fineness).round());
        font::rasterise(text.text, size, |x, y, coverage| {
            self.mix(origin[0] + (x + shift).round(), origin[1] + y, text.colour, coverage);
        });
    }

    /// Mixes a colour into the fine pixel at fine coordinates; outside the image nothing happens.
    fn mix(&mut self, x: f64, y: f64, colour: Colour, weight: f64) {
        let [columns, rows] = self.fine_size();
        if x >= 0.0 && y >= 0.0 && (x as usize) < columns && (y as usize) < rows {
            blend(&mut self.fine[y as usize * columns + x as usize], colour, weight);
        }
    }

    /// Calls `inside(x, y)` with the centres of the fine pixels of a box and colours those where it holds.
    fn fill(&mut self, low: [f64; 2], high: [f64; 2], colour: Colour, inside: impl Fn(f64, f64) -> bool) {
        let [columns, rows] = self.fine_size();
        let range = |low: f64, high: f64, end: usize| {
            let first = low.floor().clamp(0.0, end as f64) as usize;
            first..(high.ceil().clamp(first as f64, end as f64) as usize)
        };
        for row in range(low[1], high[1], rows) {
            for column in range(low[0], high[0], columns) {
                if inside(column as f64 + 0.5, row as f64 + 0.5) {
                    self.fine[row * columns + column] = colour;
                }
            }
        }
    }
}

/// Mixes a colour into a pixel: weight 0 leaves it, 1 replaces it.
pub(crate) fn blend(pixel: &mut Colour, colour: Colour, weight: f64) {
    for (old, new) in pixel.iter_mut().zip(colour) {
        *old = (f64::from(*old) + (f64::from(new) - f64::from(*old)) * weight.clamp(0.0, 1.0)).round() as u8;
    }
}

/// Writes rows of red, green and blue as a PNG file.
pub(crate) fn write_png(path: &Path, (width, height): (u32, u32), bytes: &[u8]) -> Result<(), DrawError> {
    let failed = |source| DrawError::Write { path: path.to_owned(), source };
    let file = BufWriter::new(File::create(path).map_err(failed)?);
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let mut writer = encoder.write_header().map_err(|error| failed(error.into()))?;
    writer.write_image_data(bytes).map_err(|error| failed(error.into()))?;
    writer.finish().map_err(|error| failed(error.into()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangle_fills_whole_pixels() {
        let mut raster = Raster::new(4, 3);
        raster.rectangle([1.0, 1.0], [2.0, 1.0], [0, 0, 0]);
        let bytes = raster.bytes();
        let dark: Vec<usize> = (0..12).filter(|index| bytes[index * 3] == 0).collect();
        assert_eq!(dark, [5, 6]);
    }

    #[test]
    fn nothing_is_drawn_outside() {
        let mut raster = Raster::new(5, 5);
        raster.rectangle([-50.0, 2.0], [3.0, 3.0], [0; 3]);
        raster.line(&[[-10.0, -10.0], [-5.0, -3.0]], 2.0, [0; 3]);
        raster.text([400.0, 1.0], Text { text: "out", size: 12.0, anchor: Anchor::Start, colour: [0; 3] });
        assert!(raster.bytes().iter().all(|byte| *byte == 255));
    }
}
