//! Node charges to node potentials: forward transforms, influence function, inverse transforms.
//!
//! Planes of x are transformed along z and y; what they become is transformed along x, line by line.
//! [`Planes`] and [`Lines`] may hold all of them or a share.

use super::axis::GridAxis;
use super::influence::Influence;
use super::nodes::NodeArray;
use super::transform::LineScratch;
use super::window::HALO;
use crate::numerics::scratch::PerThread;
use rayon::prelude::*;
use std::ops::Range;

/// Lines that are gathered from strided memory at a time: a cache line of doubles.
pub(crate) const TILE: usize = 8;

/// Convolution of node charges with the influence function, all in one process.
#[derive(Debug)]
pub(crate) struct Solver {
    planes: Planes,
    lines: Lines,
}

impl Solver {
    pub(crate) fn new(axes: &[GridAxis; 3], influence: Influence) -> Self {
        let coefficients = 0..axes[1].transform.len();
        Self { planes: Planes::new(axes, axes[0].nodes), lines: Lines::new(axes, coefficients, influence) }
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.planes.memory_bytes() + self.lines.memory_bytes()
    }

    /// Replaces node charges by node potentials.
    pub(crate) fn solve(&mut self, axes: &[GridAxis; 3], nodes: &mut NodeArray) {
        let (plane, row) = (nodes.plane_len(), nodes.row_len());
        let row_of = |y: usize| (y + HALO) * row + HALO..(y + HALO) * row + HALO + axes[2].nodes;
        let sources = &nodes.values[HALO * plane..];
        self.planes.forward(axes, |x, rows| {
            let source = &sources[x * plane..][..plane];
            for y in 0..axes[1].nodes {
                rows.at(y).copy_from_slice(&source[row_of(y)]);
            }
        });
        self.lines.convolve(axes, &self.planes.values);
        self.planes.inverse(axes, |x, values| self.lines.write_plane(axes[0].offset + x, values));
        let targets = nodes.values[HALO * plane..].par_chunks_mut(plane);
        targets.take(axes[0].nodes).enumerate().for_each(|(x, target)| {
            for y in 0..axes[1].nodes {
                target[row_of(y)].copy_from_slice(self.planes.row(axes, x, y));
            }
        });
    }
}

/// Planes of x that carry charge, each `[y][z]`, padded.
#[derive(Debug)]
pub(crate) struct Planes {
    /// Padded lengths along y and z.
    lengths: [usize; 2],
    pub(crate) values: Vec<f64>,
    scratch: PerThread<Scratch>,
}

#[derive(Debug, Clone)]
struct Scratch {
    lines: [LineScratch; 2],
    tile: Vec<f64>,
}

/// Rows of one plane that carry charge.
pub(crate) struct Rows<'a> {
    plane: &'a mut [f64],
    axes: &'a [GridAxis; 3],
}

impl Rows<'_> {
    /// Nodes of a row along z, by the number of its node along y.
    pub(crate) fn at(&mut self, y: usize) -> &mut [f64] {
        &mut self.plane[row_in_plane(self.axes, y)]
    }
}

/// Place in a padded plane of the nodes of a row along z.
fn row_in_plane(axes: &[GridAxis; 3], y: usize) -> Range<usize> {
    let start = (y + axes[1].offset) * axes[2].transform.len() + axes[2].offset;
    start..start + axes[2].nodes
}

impl Planes {
    /// Room for so many planes.
    pub(crate) fn new(axes: &[GridAxis; 3], count: usize) -> Self {
        let lengths = [1, 2].map(|axis: usize| axes[axis].transform.len());
        let scratch = Scratch {
            lines: [1, 2].map(|axis: usize| axes[axis].transform.scratch()),
            tile: vec![0.0; TILE * lengths[0]],
        };
        let values = vec![0.0; count * lengths[0] * lengths[1]];
        Self { lengths, values, scratch: PerThread::new(|| scratch.clone()) }
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        8 * self.values.len()
    }

    /// Nodes of a row along z of a plane.
    pub(crate) fn row(&self, axes: &[GridAxis; 3], plane: usize, y: usize) -> &[f64] {
        let [ly, lz] = self.lengths;
        &self.values[plane * ly * lz..][row_in_plane(axes, y)]
    }

    /// Transforms what `load` writes into the rows of every plane, which are zero before.
    pub(crate) fn forward(&mut self, axes: &[GridAxis; 3], load: impl Fn(usize, &mut Rows<'_>) + Sync) {
        let [ly, lz] = self.lengths;
        let scratch = &self.scratch;
        self.values.par_chunks_mut(ly * lz).enumerate().for_each(|(x, plane)| {
            scratch.with(|scratch| {
                plane.fill(0.0);
                load(x, &mut Rows { plane, axes });
                let rows = plane[axes[1].offset * lz..].chunks_exact_mut(lz).take(axes[1].nodes);
                for row in rows {
                    axes[2].transform.forward(row, &mut scratch.lines[1]);
                }
                across_rows(plane, lz, &mut scratch.tile, |line| {
                    axes[1].transform.forward(line, &mut scratch.lines[0]);
                });
            });
        });
    }

    /// Transforms back what `load` writes into every plane; nodes that carry no charge are left undefined.
    pub(crate) fn inverse(&mut self, axes: &[GridAxis; 3], load: impl Fn(usize, &mut [f64]) + Sync) {
        let [ly, lz] = self.lengths;
        let scratch = &self.scratch;
        self.values.par_chunks_mut(ly * lz).enumerate().for_each(|(x, plane)| {
            scratch.with(|scratch| {
                load(x, plane);
                across_rows(plane, lz, &mut scratch.tile, |line| {
                    axes[1].transform.inverse(line, &mut scratch.lines[0]);
                });
                let rows = plane[axes[1].offset * lz..].chunks_exact_mut(lz).take(axes[1].nodes);
                for row in rows {
                    axes[2].transform.inverse(row, &mut scratch.lines[1]);
                }
            });
        });
    }
}

/// Lines along x for some coefficients of y and all of z, `[y][z][x]`, padded.
#[derive(Debug)]
pub(crate) struct Lines {
    influence: Influence,
    /// Coefficients of y.
    coefficients: Range<usize>,
    /// Padded lengths along x and z.
    lengths: [usize; 2],
    values: Vec<f64>,
    scratch: PerThread<LineScratch>,
}

impl Lines {
    /// Room for the lines of some coefficients of y, which the influence function must have.
    pub(crate) fn new(axes: &[GridAxis; 3], coefficients: Range<usize>, influence: Influence) -> Self {
        let lengths = [0, 2].map(|axis: usize| axes[axis].transform.len());
        let values = vec![0.0; lengths[0] * coefficients.len() * lengths[1]];
        let scratch = axes[0].transform.scratch();
        Self { influence, coefficients, lengths, values, scratch: PerThread::new(|| scratch.clone()) }
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        8 * self.values.len() + self.influence.memory_bytes()
    }

    /// Convolves what the planes have become, `[x][y][z]` for these coefficients of y.
    pub(crate) fn convolve(&mut self, axes: &[GridAxis; 3], planes: &[f64]) {
        let [lx, lz] = self.lengths;
        let plane = self.coefficients.len() * lz;
        let (first, influence, scratch) = (self.coefficients.start, &self.influence, &self.scratch);
        let nodes = axes[0].nodes;
        self.values.par_chunks_mut(lx * lz).enumerate().for_each(|(y, lines)| {
            scratch.with(|scratch| {
                let wave_y = axes[1].transform.wave_index(first + y);
                for (z, tile) in lines.chunks_mut(lx * TILE).enumerate() {
                    let z = z * TILE;
                    let width = tile.len() / lx;
                    tile.fill(0.0);
                    for x in 0..nodes {
                        let row = &planes[x * plane + y * lz + z..][..width];
                        for (column, value) in row.iter().enumerate() {
                            tile[column * lx + axes[0].offset + x] = *value;
                        }
                    }
                    for (column, line) in tile.chunks_mut(lx).enumerate() {
                        axes[0].transform.forward(line, scratch);
                        let wave_z = axes[2].transform.wave_index(z + column);
                        influence.apply(axes, line, wave_y, wave_z);
                        axes[0].transform.inverse(line, scratch);
                    }
                }
            });
        });
    }

    /// Writes the values at one place of the padded lines, `[y][z]`.
    pub(crate) fn write_plane(&self, at: usize, plane: &mut [f64]) {
        for (value, line) in plane.iter_mut().zip(self.values.chunks_exact(self.lengths[0])) {
            *value = line[at];
        }
    }
}

/// Applies `transform` to every column of a plane of rows of length `row`, a tile of columns at a time;
/// `tile` holds [`TILE`] columns.
pub(crate) fn across_rows(
    plane: &mut [f64],
    row: usize,
    tile: &mut [f64],
    mut transform: impl FnMut(&mut [f64]),
) {
    let rows = plane.len() / row;
    for start in (0..row).step_by(TILE) {
        let width = TILE.min(row - start);
        for (y, values) in plane.chunks_exact(row).enumerate() {
            for (column, value) in values[start..start + width].iter().enumerate() {
                tile[column * rows + y] = *value;
            }
        }
        for line in tile[..width * rows].chunks_exact_mut(rows) {
            transform(line);
        }
        for (y, values) in plane.chunks_exact_mut(row).enumerate() {
            for (column, value) in values[start..start + width].iter_mut().enumerate() {
                *value = tile[column * rows + y];
            }
        }
    }
}
