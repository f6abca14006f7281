//! The smooth level on the internal grid: spread charge with B-splines, convolve, gather potential and field.

use super::axis::{AxisSize, GridAxis, TAIL_WIDTHS};
use super::bspline::{HALO, MAX_ORDER, weights};
use super::halo::HaloArray;
use super::influence::{Influence, singular_width};
use super::solve::Solver;
use crate::images::axis_kinds;
use amberfield_core::{Axis, Domain};
use nalgebra::Vector3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Planes of x that one task spreads onto; a spline reaches into the next slab at most.
const SLAB: usize = MAX_ORDER;
/// Grains gathered by one task.
const GATHER: usize = 256;

/// What the grid is made of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct GridParameters {
    /// Largest node spacing [m].
    pub spacing_m: f64,
    /// Order of the splines, 4 to 8.
    pub order: usize,
    /// Gaussian width σ of the charges' clouds [m].
    pub sigma_m: f64,
}

/// Field of Gaussian clouds of width σ around the charges, with the box's own faces.
#[derive(Debug)]
pub(crate) struct GridLevel {
    axes: [GridAxis; 3],
    order: usize,
    nodes: HaloArray,
    solver: Solver,
    slabs: SlabOrder,
}

impl GridLevel {
    pub(crate) fn new(domain: &Domain, parameters: GridParameters) -> Self {
        let GridParameters { spacing_m, order, sigma_m } = parameters;
        let sizes = grid_sizes(domain, spacing_m, sigma_m);
        let axes = Axis::ALL.map(|axis| GridAxis::new(domain, axis, sizes[axis.index()]));
        let influence = Influence::new(&axes, order, sigma_m);
        let solver = Solver::new(&axes, influence);
        let nodes = HaloArray::new(&axes);
        Self { axes, order, nodes, solver, slabs: SlabOrder::default() }
    }

    /// Nodes that carry charge, per axis.
    pub(crate) fn cells(&self) -> [usize; 3] {
        self.axes.each_ref().map(|axis| axis.nodes)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        8 * self.nodes.values.len() + self.solver.memory_bytes() + 4 * self.slabs.particle.capacity()
    }

    /// Computes the clouds' potential at the nodes (4πε = 1). Positions lie inside the domain.
    pub(crate) fn solve(&mut self, positions: &[Vector3<f64>], charges: &[f64]) {
        self.nodes.values.fill(0.0);
        match self.order {
            4 => self.spread::<4>(positions, charges),
            5 => self.spread::<5>(positions, charges),
            6 => self.spread::<6>(positions, charges),
            7 => self.spread::<7>(positions, charges),
            _ => self.spread::<8>(positions, charges),
        }
        self.nodes.fold(&self.axes);
        self.solver.solve(&self.axes, &mut self.nodes);
        self.nodes.unfold(&self.axes);
    }

    /// E and potential of the clouds (4πε = 1) at the given positions, after [`Self::solve`].
    pub(crate) fn gather(&self, positions: &[Vector3<f64>], field: &mut [(Vector3<f64>, f64)]) {
        match self.order {
            4 => self.gather_order::<4>(positions, field),
            5 => self.gather_order::<5>(positions, field),
            6 => self.gather_order::<6>(positions, field),
            7 => self.gather_order::<7>(positions, field),
            _ => self.gather_order::<8>(positions, field),
        }
    }

    /// Slabs write their own planes and the beginning of the next slab's: even slabs first, then odd ones, so
    /// that every node adds its charges in an order that does not depend on the number of threads.
    fn spread<const P: usize>(&mut self, positions: &[Vector3<f64>], charges: &[f64]) {
        let axes = &self.axes;
        self.slabs.sort(positions.len(), axes[0].nodes, |i| weights::<P>(axes[0].to_nodes(positions[i].x)).0);
        let (plane, row) = (self.nodes.plane_len(), self.nodes.row_len());
        let slabs = &self.slabs;
        for parity in 0..2 {
            let start = (parity * SLAB * plane).min(self.nodes.values.len());
            let chunks = self.nodes.values[start..].par_chunks_mut(2 * SLAB * plane);
            chunks.enumerate().for_each(|(chunk, nodes)| {
                let slab = 2 * chunk + parity;
                let first_plane = (slab * SLAB) as isize - HALO as isize;
                for &particle in slabs.of(slab) {
                    let particle = particle as usize;
                    let position = positions[particle];
                    let (x, wx, _) = weights::<P>(axes[0].to_nodes(position.x));
                    let (y, wy, _) = weights::<P>(axes[1].to_nodes(position.y));
                    let (z, wz, _) = weights::<P>(axes[2].to_nodes(position.z));
                    let corner = (x - first_plane) as usize * plane + with_halo(y) * row + with_halo(z);
                    for (i, wx) in wx.into_iter().enumerate() {
                        let qx = charges[particle] * wx;
                        for (j, wy) in wy.into_iter().enumerate() {
                            let qxy = qx * wy;
                            let start = corner + i * plane + j * row;
                            let target: &mut [f64; P] =
                                (&mut nodes[start..start + P]).try_into().expect("P nodes");
                            for (node, wz) in target.iter_mut().zip(wz) {
                                *node += qxy * wz;
                            }
                        }
                    }
                }
            });
        }
    }

    fn gather_order<const P: usize>(&self, positions: &[Vector3<f64>], field: &mut [(Vector3<f64>, f64)]) {
        let (plane, row) = (self.nodes.plane_len(), self.nodes.row_len());
        let inverse = self.axes.each_ref().map(|axis| 1.0 / axis.spacing);
        field.par_chunks_mut(GATHER).zip(positions.par_chunks(GATHER)).for_each(|(field, positions)| {
            for ((e, potential), position) in field.iter_mut().zip(positions) {
                let (x, wx, dx) = weights::<P>(self.axes[0].to_nodes(position.x));
                let (y, wy, dy) = weights::<P>(self.axes[1].to_nodes(position.y));
                let (z, wz, dz) = weights::<P>(self.axes[2].to_nodes(position.z));
                let corner = with_halo(x) * plane + with_halo(y) * row + with_halo(z);
                let (mut value, mut slope) = (0.0, Vector3::zeros());
                for i in 0..P {
                    let (mut flat, mut along_y, mut along_z) = (0.0, 0.0, 0.0);
                    for j in 0..P {
                        let start = corner + i * plane + j * row;
                        let nodes: &[f64; P] =
                            (&self.nodes.values[start..start + P]).try_into().expect("P nodes");
                        let (mut sum, mut rise) = (0.0, 0.0);
                        for k in 0..P {
                            sum += nodes[k] * wz[k];
                            rise += nodes[k] * dz[k];
                        }
                        flat += wy[j] * sum;
                        along_y += dy[j] * sum;
                        along_z += wy[j] * rise;
                    }
                    value += wx[i] * flat;
                    slope += Vector3::new(dx[i] * flat, wx[i] * along_y, wx[i] * along_z);
                }
                *potential = value;
                *e = Vector3::from_fn(|axis, _| -slope[axis] * inverse[axis]);
            }
        });
    }
}

/// Particles in the order in which their slabs of x spread them.
#[derive(Debug, Default)]
struct SlabOrder {
    start: Vec<usize>,
    particle: Vec<u32>,
}

impl SlabOrder {
    /// Stable counting sort by the slab of the first node touched.
    fn sort(&mut self, particles: usize, nodes: usize, first_node: impl Fn(usize) -> isize) {
        let slab_of = |particle| with_halo(first_node(particle)) / SLAB;
        self.start.clear();
        self.start.resize((nodes + 2 * HALO).div_ceil(SLAB) + 2, 0);
        self.particle.resize(particles, 0);
        for particle in 0..particles {
            self.start[slab_of(particle) + 2] += 1;
        }
        for slab in 1..self.start.len() {
            self.start[slab] += self.start[slab - 1];
        }
        for particle in 0..particles {
            let next = &mut self.start[slab_of(particle) + 1];
            self.particle[*next] = particle as u32;
            *next += 1;
        }
    }

    fn of(&self, slab: usize) -> &[u32] {
        match (self.start.get(slab), self.start.get(slab + 1)) {
            (Some(&start), Some(&end)) => &self.particle[start..end],
            _ => &[],
        }
    }
}

/// Index of a node in an array with a halo.
#[inline(always)]
fn with_halo(node: isize) -> usize {
    (node + HALO as isize) as usize
}

/// The three axes of a grid with nodes at most `spacing` apart.
pub(crate) fn grid_sizes(domain: &Domain, spacing: f64, sigma: f64) -> [AxisSize; 3] {
    let slab = axis_kinds(domain).into_iter().filter(|kind| kind.is_open()).count() == 1;
    let tail = if slab { 2.0 * TAIL_WIDTHS * singular_width([spacing; 3], sigma) } else { 0.0 };
    Axis::ALL.map(|axis| AxisSize::new(domain, axis, spacing, tail))
}
