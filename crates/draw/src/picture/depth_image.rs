//! An image that knows how near each of its pixels is.

use crate::colour::Colour;
use crate::raster::{Raster, blend};

/// Unit vector towards the light in the view's axes (right, up, towards the viewer).
pub(super) const LIGHT: [f64; 3] = [-0.408, 0.577, 0.707];

/// Fine pixels with the nearness of what they show.
pub(super) struct DepthImage {
    raster: Raster,
    columns: usize,
    rows: usize,
    nearness: Vec<f32>,
}

/// A corner in pixels with its nearness.
pub(super) type Corner = [f64; 3];

impl DepthImage {
    /// Blank paper, infinitely far.
    pub(super) fn new(width: usize, height: usize) -> Self {
        let raster = Raster::new(width, height);
        let [columns, rows] = raster.fine_size();
        Self { raster, columns, rows, nearness: vec![f32::NEG_INFINITY; columns * rows] }
    }

    /// The pixels.
    pub(super) fn into_raster(self) -> Raster {
        self.raster
    }

    /// A shaded sphere at a projected centre, radius in pixels.
    pub(super) fn sphere(&mut self, centre: Corner, radius: f64, colour: Colour) {
        if !(centre.iter().all(|value| value.is_finite()) && radius > 0.0) {
            return;
        }
        let fineness = self.raster.fineness();
        let (x, y, radius) = (centre[0] * fineness, centre[1] * fineness, (radius * fineness).max(1.0));
        for row in range(y - radius, y + radius, self.rows) {
            for column in range(x - radius, x + radius, self.columns) {
                let right = (column as f64 + 0.5 - x) / radius;
                let up = (y - row as f64 - 0.5) / radius;
                let rest = 1.0 - right * right - up * up;
                if rest < 0.0 {
                    continue;
                }
                let towards = rest.sqrt();
                let index = row * self.columns + column;
                let nearness = (centre[2] * fineness + towards * radius) as f32;
                if nearness > self.nearness[index] {
                    self.nearness[index] = nearness;
                    *self.raster.fine_pixel(index) = shaded(colour, [right, up, towards]);
                }
            }
        }
    }

    /// A flat triangle; `weight` below 1 lets through what is behind and then keeps its nearness.
    pub(super) fn triangle(&mut self, corners: [Corner; 3], colour: Colour, weight: f64) {
        let fineness = self.raster.fineness();
        let [a, b, c] = corners.map(|corner| corner.map(|value| value * fineness));
        let cross =
            |p: &Corner, q: &Corner, x: f64, y: f64| (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0]);
        let area = cross(&a, &b, c[0], c[1]);
        if !(area.is_finite() && area != 0.0) {
            return;
        }
        let extent = |axis: usize| {
            let values = [a[axis], b[axis], c[axis]];
            (
                values.iter().copied().fold(f64::INFINITY, f64::min),
                values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            )
        };
        let ((left, right), (top, bottom)) = (extent(0), extent(1));
        for row in range(top, bottom, self.rows) {
            for column in range(left, right, self.columns) {
                let (x, y) = (column as f64 + 0.5, row as f64 + 0.5);
                let parts =
                    [cross(&b, &c, x, y) / area, cross(&c, &a, x, y) / area, cross(&a, &b, x, y) / area];
                if parts.iter().any(|part| *part < 0.0) {
                    continue;
                }
                let nearness = (parts[0] * a[2] + parts[1] * b[2] + parts[2] * c[2]) as f32;
                let index = row * self.columns + column;
                if nearness > self.nearness[index] {
                    blend(self.raster.fine_pixel(index), colour, weight);
                    if weight >= 1.0 {
                        self.nearness[index] = nearness;
                    }
                }
            }
        }
    }

    /// A straight line of the given width [px], hidden by what is nearer.
    pub(super) fn segment(&mut self, from: Corner, to: Corner, width: f64, colour: Colour, weight: f64) {
        let fineness = self.raster.fineness();
        let length = ((to[0] - from[0]).powi(2) + (to[1] - from[1]).powi(2)).sqrt();
        if !(length.is_finite() && length > 0.0) {
            return;
        }
        let half = 0.5 * width;
        let side = [-(to[1] - from[1]) / length * half, (to[0] - from[0]) / length * half];
        // Lifted a little, so that an edge is not hidden by the face that it bounds.
        let shifted = |corner: Corner, sign: f64| {
            [corner[0] + sign * side[0], corner[1] + sign * side[1], corner[2] + 1.0 / fineness]
        };
        let corners = [shifted(from, 1.0), shifted(to, 1.0), shifted(to, -1.0), shifted(from, -1.0)];
        self.triangle([corners[0], corners[1], corners[2]], colour, weight);
        self.triangle([corners[0], corners[2], corners[3]], colour, weight);
    }

    /// Darkens pixels that lie deep between nearer ones within `reach` pixels: light from all around is
    /// blocked.
    pub(super) fn occlude(&mut self, reach: f64, strength: f64) {
        const SAMPLES: usize = 14;
        let reach = (reach * self.raster.fineness()).max(2.0);
        for row in 0..self.rows {
            for column in 0..self.columns {
                let index = row * self.columns + column;
                let own = self.nearness[index];
                if own == f32::NEG_INFINITY {
                    continue;
                }
                let turn = scatter(column, row);
                let mut blocked = 0.0;
                for sample in 0..SAMPLES {
                    let part = (sample as f64 + turn) / SAMPLES as f64;
                    let (sine, cosine) = ((sample as f64 + turn) * 2.399_963_229_728_653).sin_cos();
                    let distance = reach * part.sqrt();
                    let x = column as f64 + distance * cosine;
                    let y = row as f64 + distance * sine;
                    if x < 0.0 || y < 0.0 || x as usize >= self.columns || y as usize >= self.rows {
                        continue;
                    }
                    let above =
                        f64::from(self.nearness[y as usize * self.columns + x as usize] - own) / reach;
                    // A rise above 45 degrees blocks fully; something far in front does not belong here.
                    let rise = ((above - 0.15) / 0.85).clamp(0.0, 1.0);
                    blocked += if above.is_finite() { rise * (3.0 - above).clamp(0.0, 1.0) } else { 0.0 };
                }
                let dark = 1.0 - strength * (blocked / SAMPLES as f64);
                let pixel = self.raster.fine_pixel(index);
                *pixel = pixel.map(|value| (f64::from(value) * dark).round() as u8);
            }
        }
    }
}

/// Whole numbers from floor(low) to ceil(high), within 0 to end.
fn range(low: f64, high: f64, end: usize) -> std::ops::Range<usize> {
    let first = low.floor().clamp(0.0, end as f64) as usize;
    first..(high.ceil().clamp(first as f64, end as f64) as usize)
}

/// A number in [0, 1) that looks random and depends on the place alone.
fn scatter(column: usize, row: usize) -> f64 {
    let mixed = (column as u32).wrapping_mul(0x9E37_79B1) ^ (row as u32).wrapping_mul(0x85EB_CA77);
    let mixed = (mixed ^ mixed >> 15).wrapping_mul(0x2C1B_3C6D);
    f64::from((mixed ^ mixed >> 13) & 0xFFFF) / 65536.0
}

/// The colour of a point of a sphere with the given normal in the view's axes.
fn shaded(colour: Colour, normal: [f64; 3]) -> Colour {
    let facing: f64 = normal.iter().zip(LIGHT).map(|(a, b)| a * b).sum();
    // Wrapped diffuse light keeps the colour readable on the dark side.
    let diffuse = ((facing + 0.35) / 1.35).max(0.0);
    let light = 0.50 + 0.54 * diffuse;
    // Half-way vector between light and viewer.
    let half = [LIGHT[0], LIGHT[1], LIGHT[2] + 1.0];
    let length = half.iter().map(|value| value * value).sum::<f64>().sqrt();
    let gloss = normal.iter().zip(half).map(|(a, b)| a * b).sum::<f64>() / length;
    let shine = 46.0 * gloss.max(0.0).powi(36);
    let rim = 0.80 + 0.20 * (normal[2] * 2.2).min(1.0);
    colour.map(|value| (f64::from(value) * light * rim + shine).clamp(0.0, 255.0).round() as u8)
}
