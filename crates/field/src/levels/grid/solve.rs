//! Node charges to node potentials: forward transforms, influence function, inverse transforms.

use super::axis::GridAxis;
use super::halo::HaloArray;
use super::influence::Influence;
use super::transform::LineScratch;
use super::window::HALO;
use crate::numerics::scratch::PerThread;
use rayon::prelude::*;

/// Lines that are gathered from strided memory at a time: a cache line of doubles.
pub(crate) const TILE: usize = 8;

/// Buffers and plans for the convolution of node charges with the influence function.
#[derive(Debug)]
pub(crate) struct Solver {
    influence: Influence,
    /// Padded lengths.
    lengths: [usize; 3],
    /// Planes of x, each `[y][z]`, only those that carry charge.
    planes: Vec<f64>,
    /// Lines of x, `[y][z][x]`.
    lines: Vec<f64>,
    scratch: PerThread<Scratch>,
}

#[derive(Debug, Clone)]
struct Scratch {
    line: [LineScratch; 3],
    tile: Vec<f64>,
}

impl Solver {
    pub(crate) fn new(axes: &[GridAxis; 3], influence: Influence) -> Self {
        let lengths = axes.each_ref().map(|axis| axis.transform.len());
        let plane = lengths[1] * lengths[2];
        let scratch = Scratch {
            line: axes.each_ref().map(|axis| axis.transform.scratch()),
            tile: vec![0.0; TILE * lengths[1]],
        };
        Self {
            influence,
            lengths,
            planes: vec![0.0; axes[0].nodes * plane],
            lines: vec![0.0; lengths[0] * plane],
            scratch: PerThread::new(|| scratch.clone()),
        }
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        8 * (self.planes.len() + self.lines.len()) + self.influence.memory_bytes()
    }

    /// Replaces node charges by node potentials.
    pub(crate) fn solve(&mut self, axes: &[GridAxis; 3], nodes: &mut HaloArray) {
        let [_, ly, lz] = self.lengths;
        let plane = ly * lz;
        let scratch = &self.scratch;
        let (halo_plane, halo_row) = (nodes.plane_len(), nodes.row_len());
        let row_of = |y: usize| (y + HALO) * halo_row + HALO..(y + HALO) * halo_row + HALO + axes[2].nodes;
        let padded_row_of = |y: usize| (y + axes[1].offset) * lz..(y + axes[1].offset + 1) * lz;
        let charged = axes[2].offset..axes[2].offset + axes[2].nodes;
        let sources = nodes.values[HALO * halo_plane..].par_chunks(halo_plane);
        self.planes.par_chunks_mut(plane).zip(sources).for_each(|(plane, source)| {
            scratch.with(|scratch| {
                plane.fill(0.0);
                for y in 0..axes[1].nodes {
                    let row = &mut plane[padded_row_of(y)];
                    row[charged.clone()].copy_from_slice(&source[row_of(y)]);
                    axes[2].transform.forward(row, &mut scratch.line[2]);
                }
                across_rows(plane, lz, &mut scratch.tile, |line| {
                    axes[1].transform.forward(line, &mut scratch.line[1]);
                });
            });
        });
        self.along_x(axes);
        let scratch = &self.scratch;
        let (lines, lx) = (&self.lines, self.lengths[0]);
        let targets = nodes.values[HALO * halo_plane..].par_chunks_mut(halo_plane);
        self.planes.par_chunks_mut(plane).zip(targets).enumerate().for_each(|(x, (plane, target))| {
            scratch.with(|scratch| {
                let at = x + axes[0].offset;
                for (value, line) in plane.iter_mut().zip(lines.chunks_exact(lx)) {
                    *value = line[at];
                }
                across_rows(plane, lz, &mut scratch.tile, |line| {
                    axes[1].transform.inverse(line, &mut scratch.line[1]);
                });
                for y in 0..axes[1].nodes {
                    let row = &mut plane[padded_row_of(y)];
                    axes[2].transform.inverse(row, &mut scratch.line[2]);
                    target[row_of(y)].copy_from_slice(&row[charged.clone()]);
                }
            });
        });
    }

    fn along_x(&mut self, axes: &[GridAxis; 3]) {
        let [lx, _, lz] = self.lengths;
        let plane = self.lengths[1] * lz;
        let (planes, influence, scratch) = (&self.planes, &self.influence, &self.scratch);
        let nodes = axes[0].nodes;
        self.lines.par_chunks_mut(lx * lz).enumerate().for_each(|(y, lines)| {
            scratch.with(|scratch| {
                let wave_y = axes[1].transform.wave_index(y);
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
                        axes[0].transform.forward(line, &mut scratch.line[0]);
                        let wave_z = axes[2].transform.wave_index(z + column);
                        influence.apply(axes, line, wave_y, wave_z);
                        axes[0].transform.inverse(line, &mut scratch.line[0]);
                    }
                }
            });
        });
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
