//! Charges to nodes, and potential and field from nodes, by a window.

use super::axis::GridAxis;
use super::nodes::{Frame, NodeArray};
use super::window::{MAX_ORDER, Weights, Window, first_node};
use crate::numerics::processor::{Instructions, Vector, dispatched};
use crate::values::FieldAt;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Planes of x that one task spreads onto; a window reaches into the next slab at most.
const SLAB: usize = MAX_ORDER;
/// Grains gathered by one task.
const GATHER: usize = 256;

/// Calls a method that is compiled for each order of the window with that of this one.
macro_rules! by_order {
    ($assignment:ident.$method:ident($($argument:expr),*)) => {
        match $assignment.order {
            4 => $assignment.$method::<4>($($argument),*),
            5 => $assignment.$method::<5>($($argument),*),
            6 => $assignment.$method::<6>($($argument),*),
            7 => $assignment.$method::<7>($($argument),*),
            _ => $assignment.$method::<8>($($argument),*),
        }
    };
}

/// A window of some order between charges and nodes.
#[derive(Debug)]
pub(crate) struct Assignment {
    order: usize,
    window: Window,
    slabs: SlabOrder,
    instructions: Instructions,
}

impl Assignment {
    /// Assignment by a window of an order, 4 to 8, and a shape.
    pub(crate) fn new(order: usize, window_shape: f64) -> Self {
        let window = Window::new(order, window_shape);
        let instructions = Instructions::detect().for_numbers(order);
        Self { order, window, slabs: SlabOrder::default(), instructions }
    }

    /// The window.
    pub(crate) fn window(&self) -> &Window {
        &self.window
    }

    /// First and last node that the windows of grains between two coordinates [m] touch along an axis.
    pub(crate) fn touched(&self, axis: &GridAxis, [low, high]: [f64; 2]) -> [isize; 2] {
        let [first, last] = [low, high].map(|at| by_order!(self.first_node(axis, at)));
        [first, last + self.order as isize - 1]
    }

    /// Adds charges at the given positions to the nodes, which hold all that the windows touch and, along z,
    /// [`MAX_ORDER`] nodes from each window's first on.
    pub(crate) fn spread(
        &mut self,
        axes: &[GridAxis; 3],
        positions: &[Vector3<f64>],
        charges: &[f64],
        nodes: &mut NodeArray,
    ) {
        by_order!(self.spread_order(axes, positions, charges, nodes));
    }

    /// E and potential (4πε = 1) of the nodes at the given positions.
    pub(crate) fn gather(
        &self,
        axes: &[GridAxis; 3],
        nodes: &NodeArray,
        positions: &[Vector3<f64>],
        field: &mut [FieldAt],
    ) {
        by_order!(self.gather_order(axes, nodes, positions, field));
    }

    /// Potential alone (density, of nodes that have one) at the given positions.
    pub(crate) fn gather_values(
        &self,
        axes: &[GridAxis; 3],
        nodes: &NodeArray,
        positions: &[Vector3<f64>],
        values: &mut [f64],
    ) {
        by_order!(self.gather_values_of_order(axes, nodes, positions, values));
    }

    /// Memory held [bytes].
    pub(crate) fn memory_bytes(&self) -> usize {
        4 * self.slabs.particle.capacity()
    }

    fn first_node<const P: usize>(&self, axis: &GridAxis, at: f64) -> isize {
        first_node::<P>(axis.to_nodes(at))
    }

    /// Slabs write their own planes and the beginning of the next slab's: even slabs first, then odd ones, so
    /// that every node adds its charges in an order that does not depend on the number of threads.
    fn spread_order<const P: usize>(
        &mut self,
        axes: &[GridAxis; 3],
        positions: &[Vector3<f64>],
        charges: &[f64],
        nodes: &mut NodeArray,
    ) {
        let frame = nodes.frame();
        let plane_of = |i: usize| {
            let first = first_node::<P>(axes[0].to_nodes(positions[i].x));
            (first - frame.first[0]) as usize
        };
        self.slabs.sort(positions.len(), nodes.planes(), plane_of);
        let plane = frame.plane.max(1);
        let (slabs, instructions, window) = (&self.slabs, self.instructions, &self.window);
        for parity in 0..2 {
            let start = (parity * SLAB * plane).min(nodes.values.len());
            let chunks = nodes.values[start..].par_chunks_mut(2 * SLAB * plane);
            chunks.enumerate().for_each(|(chunk, nodes)| {
                let slab = 2 * chunk + parity;
                let origin = slab * SLAB * plane;
                for &particle in slabs.of(slab) {
                    let particle = particle as usize;
                    let place = node_place(axes, &positions[particle]);
                    spread_one::<P>(instructions, window, place, charges[particle], frame, origin, nodes);
                }
            });
        }
    }

    fn gather_order<const P: usize>(
        &self,
        axes: &[GridAxis; 3],
        nodes: &NodeArray,
        positions: &[Vector3<f64>],
        field: &mut [FieldAt],
    ) {
        let (nodes, frame) = (&nodes.values[..], nodes.frame());
        let inverse = axes.each_ref().map(|axis| -1.0 / axis.spacing);
        field.par_chunks_mut(GATHER).zip(positions.par_chunks(GATHER)).for_each(|(field, positions)| {
            for (field, position) in field.iter_mut().zip(positions) {
                let place = node_place(axes, position);
                let mut found = [0.0; 4];
                gather_one::<P>(self.instructions, &self.window, place, frame, nodes, &mut found);
                let [slope_x, slope_y, slope_z, potential] = found;
                let e = Vector3::new(slope_x * inverse[0], slope_y * inverse[1], slope_z * inverse[2]);
                *field = FieldAt { e, potential };
            }
        });
    }

    fn gather_values_of_order<const P: usize>(
        &self,
        axes: &[GridAxis; 3],
        nodes: &NodeArray,
        positions: &[Vector3<f64>],
        values: &mut [f64],
    ) {
        let (nodes, frame) = (&nodes.values[..], nodes.frame());
        values.par_chunks_mut(GATHER).zip(positions.par_chunks(GATHER)).for_each(|(values, positions)| {
            for (value, position) in values.iter_mut().zip(positions) {
                let place = node_place(axes, position);
                gather_value::<P>(self.instructions, &self.window, place, frame, nodes, value);
            }
        });
    }
}

/// Place of a position in node units.
#[inline(always)]
fn node_place(axes: &[GridAxis; 3], position: &Vector3<f64>) -> [f64; 3] {
    [axes[0].to_nodes(position.x), axes[1].to_nodes(position.y), axes[2].to_nodes(position.z)]
}

/// Index in an array of the first node that a window touches.
#[inline(always)]
fn corner(weights: &Weights, frame: Frame) -> usize {
    let [x, y, z] = [0, 1, 2].map(|axis| (weights.first[axis] - frame.first[axis]) as usize);
    x * frame.plane + y * frame.row + z
}

dispatched! {
    /// Adds a charge at a place (in node units) to the nodes of an array that begins at `origin`.
    fn spread_one<const P: usize>(
        window: &Window, place: [f64; 3], charge: f64, frame: Frame, origin: usize, nodes: &mut [f64],
    ) = spread_charge
}

#[inline(always)]
fn spread_charge<const P: usize, V: Vector<Number = f64>>(
    window: &Window,
    place: [f64; 3],
    charge: f64,
    frame: Frame,
    origin: usize,
    nodes: &mut [f64],
) {
    let weights = window.weights::<P, V>(place);
    let corner = corner(&weights, frame) - origin;
    let [wx, wy, wz] = weights.value;
    let wz = vectors::<V>(&wz);
    for i in 0..P {
        for j in 0..P {
            let row = &mut nodes[corner + i * frame.plane + j * frame.row..][..MAX_ORDER];
            let weight = V::splat(charge * wx[i] * wy[j]);
            for v in 0..P.div_ceil(V::LANES) {
                let part = &mut row[v * V::LANES..];
                weight.mul_add(wz[v], V::load(part)).write(part);
            }
        }
    }
}

/// Vectors of at most [`MAX_ORDER`] numbers.
type Row<V> = [V; MAX_ORDER / 2];

/// Numbers in vectors. Rows of nodes are read and written in whole vectors too: the halo has room for what
/// lies beyond an order's last node.
#[inline(always)]
fn vectors<V: Vector<Number = f64>>(numbers: &[f64; MAX_ORDER]) -> Row<V> {
    let mut row = [V::splat(0.0); MAX_ORDER / 2];
    for (v, vector) in row.iter_mut().enumerate().take(MAX_ORDER / V::LANES) {
        *vector = V::load(&numbers[v * V::LANES..]);
    }
    row
}

dispatched! {
    /// Slopes along x, y and z (per node spacing) and potential at a place (in node units).
    fn gather_one<const P: usize>(
        window: &Window, place: [f64; 3], frame: Frame, nodes: &[f64], found: &mut [f64; 4],
    ) = gather_field
}

#[inline(always)]
fn gather_field<const P: usize, V: Vector<Number = f64>>(
    window: &Window,
    place: [f64; 3],
    frame: Frame,
    nodes: &[f64],
    found: &mut [f64; 4],
) {
    let weights = window.weights::<P, V>(place);
    let corner = corner(&weights, frame);
    let ([wx, wy, wz], [dx, dy, dz]) = (weights.value, weights.slope);
    let zero: Row<V> = [V::splat(0.0); MAX_ORDER / 2];
    let count = P.div_ceil(V::LANES);
    // Every node of a row along z in a lane of its own; the lanes are joined at the end.
    let (mut value, mut along_x, mut along_y) = (zero, zero, zero);
    for i in 0..P {
        let (mut flat, mut tilted) = (zero, zero);
        for j in 0..P {
            let row = &nodes[corner + i * frame.plane + j * frame.row..][..MAX_ORDER];
            let (weight, slope) = (V::splat(wy[j]), V::splat(dy[j]));
            for v in 0..count {
                let part = V::load(&row[v * V::LANES..]);
                flat[v] = weight.mul_add(part, flat[v]);
                tilted[v] = slope.mul_add(part, tilted[v]);
            }
        }
        let (weight, slope) = (V::splat(wx[i]), V::splat(dx[i]));
        for v in 0..count {
            value[v] = weight.mul_add(flat[v], value[v]);
            along_x[v] = slope.mul_add(flat[v], along_x[v]);
            along_y[v] = weight.mul_add(tilted[v], along_y[v]);
        }
    }
    let (wz, dz) = (vectors::<V>(&wz), vectors::<V>(&dz));
    *found = [
        joined(&along_x, &wz, count),
        joined(&along_y, &wz, count),
        joined(&value, &dz, count),
        joined(&value, &wz, count),
    ];
}

dispatched! {
    /// Potential at a place (in node units).
    fn gather_value<const P: usize>(
        window: &Window, place: [f64; 3], frame: Frame, nodes: &[f64], found: &mut f64,
    ) = gather_potential
}

#[inline(always)]
fn gather_potential<const P: usize, V: Vector<Number = f64>>(
    window: &Window,
    place: [f64; 3],
    frame: Frame,
    nodes: &[f64],
    found: &mut f64,
) {
    let weights = window.weights::<P, V>(place);
    let corner = corner(&weights, frame);
    let [wx, wy, wz] = weights.value;
    let mut sums: Row<V> = [V::splat(0.0); MAX_ORDER / 2];
    let count = P.div_ceil(V::LANES);
    for i in 0..P {
        for j in 0..P {
            let row = &nodes[corner + i * frame.plane + j * frame.row..][..MAX_ORDER];
            let weight = V::splat(wx[i] * wy[j]);
            for v in 0..count {
                sums[v] = weight.mul_add(V::load(&row[v * V::LANES..]), sums[v]);
            }
        }
    }
    *found = joined(&sums, &vectors::<V>(&wz), count);
}

/// Sum of the products of the first vectors.
#[inline(always)]
fn joined<V: Vector<Number = f64>>(values: &Row<V>, weights: &Row<V>, count: usize) -> f64 {
    let mut sum = V::splat(0.0);
    for v in 0..count {
        sum = values[v].mul_add(weights[v], sum);
    }
    sum.total()
}

/// Particles in the order in which their slabs of x spread them.
#[derive(Debug, Default)]
struct SlabOrder {
    start: Vec<usize>,
    particle: Vec<u32>,
}

impl SlabOrder {
    /// Stable counting sort by the slab of the first of so many planes that is touched.
    fn sort(&mut self, particles: usize, planes: usize, first_plane: impl Fn(usize) -> usize) {
        let slab_of = |particle| first_plane(particle) / SLAB;
        self.start.clear();
        self.start.resize(planes.div_ceil(SLAB) + 2, 0);
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
