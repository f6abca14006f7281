//! The smooth level on the internal grid: spread charge with the window, convolve, gather potential and
//! field.

use super::axis::{AxisSize, GridAxis, TAIL_WIDTHS};
use super::halo::HaloArray;
use super::influence::{Influence, singular_width};
use super::solve::Solver;
use super::window::{HALO, MAX_ORDER, Weights, Window, first_node};
use crate::geometry::images::axis_kinds;
use crate::numerics::processor::{Instructions, Vector, dispatched};
use crate::values::FieldAt;
use amberfield_core::{Axis, Domain};
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Planes of x that one task spreads onto; a window reaches into the next slab at most.
const SLAB: usize = MAX_ORDER;
/// Grains gathered by one task.
const GATHER: usize = 256;

/// Parameters of the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GridParameters {
    /// Largest node spacing [m].
    pub spacing_m: f64,
    /// Order of the window, 4 to 8.
    pub order: usize,
    /// Shape of the window.
    pub window_shape: f64,
    /// The charges' clouds, lengths in m.
    pub cloud: Cloud,
}

/// Calls a method that is compiled for each order of the window with that of this grid.
macro_rules! by_order {
    ($grid:ident.$method:ident($($argument:expr),*)) => {
        match $grid.order {
            4 => $grid.$method::<4>($($argument),*),
            5 => $grid.$method::<5>($($argument),*),
            6 => $grid.$method::<6>($($argument),*),
            7 => $grid.$method::<7>($($argument),*),
            _ => $grid.$method::<8>($($argument),*),
        }
    };
}

/// Field of the clouds around the charges, with the box's own faces.
#[derive(Debug)]
pub(crate) struct GridLevel {
    axes: [GridAxis; 3],
    order: usize,
    window: Window,
    nodes: HaloArray,
    solver: Solver,
    slabs: SlabOrder,
    instructions: Instructions,
}

impl GridLevel {
    /// The clouds' potential and field.
    pub(crate) fn new(domain: &Domain, parameters: GridParameters) -> Self {
        Self::with(domain, parameters, Influence::new)
    }

    /// The clouds' potential and field less those of `wider` clouds, in a periodic domain.
    pub(crate) fn between(domain: &Domain, parameters: GridParameters, wider: Cloud) -> Self {
        Self::with(domain, parameters, |axes, window, cloud| Influence::between(axes, window, cloud, wider))
    }

    /// The clouds' density [C/m³] in place of a potential, in a periodic domain.
    pub(crate) fn density(domain: &Domain, parameters: GridParameters) -> Self {
        Self::with(domain, parameters, Influence::density)
    }

    fn with(
        domain: &Domain,
        parameters: GridParameters,
        influence: impl Fn(&[GridAxis; 3], &Window, Cloud) -> Influence,
    ) -> Self {
        let GridParameters { spacing_m, order, window_shape, cloud } = parameters;
        let sizes = grid_sizes(domain, spacing_m, cloud);
        let axes = Axis::ALL.map(|axis| GridAxis::new(domain, axis, sizes[axis.index()]));
        let window = Window::new(order, window_shape);
        let influence = influence(&axes, &window, cloud);
        let solver = Solver::new(&axes, influence);
        let nodes = HaloArray::new(&axes);
        let instructions = Instructions::detect().for_numbers(order);
        Self { axes, order, window, nodes, solver, slabs: SlabOrder::default(), instructions }
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
        by_order!(self.spread(positions, charges));
        self.nodes.fold(&self.axes);
        self.solver.solve(&self.axes, &mut self.nodes);
        self.nodes.unfold(&self.axes);
    }

    /// E and potential of the clouds (4πε = 1) at the given positions, after [`Self::solve`].
    pub(crate) fn gather(&self, positions: &[Vector3<f64>], field: &mut [FieldAt]) {
        by_order!(self.gather_order(positions, field));
    }

    /// Potential alone (density, of a grid that has one) at the given positions, after [`Self::solve`].
    pub(crate) fn gather_values(&self, positions: &[Vector3<f64>], values: &mut [f64]) {
        by_order!(self.gather_values_of_order(positions, values));
    }

    /// Slabs write their own planes and the beginning of the next slab's: even slabs first, then odd ones, so
    /// that every node adds its charges in an order that does not depend on the number of threads.
    fn spread<const P: usize>(&mut self, positions: &[Vector3<f64>], charges: &[f64]) {
        let (axes, window) = (&self.axes, &self.window);
        self.slabs
            .sort(positions.len(), axes[0].nodes, |i| first_node::<P>(axes[0].to_nodes(positions[i].x)));
        let plane = self.nodes.plane_len();
        let (slabs, instructions, steps) = (&self.slabs, self.instructions, self.nodes.steps());
        for parity in 0..2 {
            let start = (parity * SLAB * plane).min(self.nodes.values.len());
            let chunks = self.nodes.values[start..].par_chunks_mut(2 * SLAB * plane);
            chunks.enumerate().for_each(|(chunk, nodes)| {
                let slab = 2 * chunk + parity;
                let origin = slab * SLAB * plane;
                for &particle in slabs.of(slab) {
                    let particle = particle as usize;
                    let place = node_place(axes, &positions[particle]);
                    spread_one::<P>(instructions, window, place, charges[particle], steps, origin, nodes);
                }
            });
        }
    }

    fn gather_order<const P: usize>(&self, positions: &[Vector3<f64>], field: &mut [FieldAt]) {
        let (nodes, steps) = (&self.nodes.values[..], self.nodes.steps());
        let inverse = self.axes.each_ref().map(|axis| -1.0 / axis.spacing);
        field.par_chunks_mut(GATHER).zip(positions.par_chunks(GATHER)).for_each(|(field, positions)| {
            for (field, position) in field.iter_mut().zip(positions) {
                let place = node_place(&self.axes, position);
                let mut found = [0.0; 4];
                gather_one::<P>(self.instructions, &self.window, place, steps, nodes, &mut found);
                let [slope_x, slope_y, slope_z, potential] = found;
                let e = Vector3::new(slope_x * inverse[0], slope_y * inverse[1], slope_z * inverse[2]);
                *field = FieldAt { e, potential };
            }
        });
    }

    fn gather_values_of_order<const P: usize>(&self, positions: &[Vector3<f64>], values: &mut [f64]) {
        let (nodes, steps) = (&self.nodes.values[..], self.nodes.steps());
        values.par_chunks_mut(GATHER).zip(positions.par_chunks(GATHER)).for_each(|(values, positions)| {
            for (value, position) in values.iter_mut().zip(positions) {
                let place = node_place(&self.axes, position);
                gather_value::<P>(self.instructions, &self.window, place, steps, nodes, value);
            }
        });
    }
}

/// Place of a position in node units.
#[inline(always)]
fn node_place(axes: &[GridAxis; 3], position: &Vector3<f64>) -> [f64; 3] {
    [axes[0].to_nodes(position.x), axes[1].to_nodes(position.y), axes[2].to_nodes(position.z)]
}

/// Index in an array with a halo of the first node that a window touches.
#[inline(always)]
fn corner(weights: &Weights, [plane, row]: [usize; 2]) -> usize {
    let [x, y, z] = weights.first;
    with_halo(x) * plane + with_halo(y) * row + with_halo(z)
}

dispatched! {
    /// Adds a charge at a place (in node units) to the nodes of an array that begins at `origin`.
    fn spread_one<const P: usize>(
        window: &Window, place: [f64; 3], charge: f64, steps: [usize; 2], origin: usize, nodes: &mut [f64],
    ) = spread_charge
}

#[inline(always)]
fn spread_charge<const P: usize, V: Vector<Number = f64>>(
    window: &Window,
    place: [f64; 3],
    charge: f64,
    steps: [usize; 2],
    origin: usize,
    nodes: &mut [f64],
) {
    let weights = window.weights::<P, V>(place);
    let corner = corner(&weights, steps) - origin;
    let [wx, wy, wz] = weights.value;
    let wz = vectors::<V>(&wz);
    for i in 0..P {
        for j in 0..P {
            let row = &mut nodes[corner + i * steps[0] + j * steps[1]..][..MAX_ORDER];
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
        window: &Window, place: [f64; 3], steps: [usize; 2], nodes: &[f64], found: &mut [f64; 4],
    ) = gather_field
}

#[inline(always)]
fn gather_field<const P: usize, V: Vector<Number = f64>>(
    window: &Window,
    place: [f64; 3],
    steps: [usize; 2],
    nodes: &[f64],
    found: &mut [f64; 4],
) {
    let weights = window.weights::<P, V>(place);
    let corner = corner(&weights, steps);
    let ([wx, wy, wz], [dx, dy, dz]) = (weights.value, weights.slope);
    let zero: Row<V> = [V::splat(0.0); MAX_ORDER / 2];
    let count = P.div_ceil(V::LANES);
    // Every node of a row along z in a lane of its own; the lanes are joined at the end.
    let (mut value, mut along_x, mut along_y) = (zero, zero, zero);
    for i in 0..P {
        let (mut flat, mut tilted) = (zero, zero);
        for j in 0..P {
            let row = &nodes[corner + i * steps[0] + j * steps[1]..][..MAX_ORDER];
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
        window: &Window, place: [f64; 3], steps: [usize; 2], nodes: &[f64], found: &mut f64,
    ) = gather_potential
}

#[inline(always)]
fn gather_potential<const P: usize, V: Vector<Number = f64>>(
    window: &Window,
    place: [f64; 3],
    steps: [usize; 2],
    nodes: &[f64],
    found: &mut f64,
) {
    let weights = window.weights::<P, V>(place);
    let corner = corner(&weights, steps);
    let [wx, wy, wz] = weights.value;
    let mut sums: Row<V> = [V::splat(0.0); MAX_ORDER / 2];
    let count = P.div_ceil(V::LANES);
    for i in 0..P {
        for j in 0..P {
            let row = &nodes[corner + i * steps[0] + j * steps[1]..][..MAX_ORDER];
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
pub(crate) fn grid_sizes(domain: &Domain, spacing: f64, cloud: Cloud) -> [AxisSize; 3] {
    let slab = axis_kinds(domain).into_iter().filter(|kind| kind.is_open()).count() == 1;
    let tail = if slab { 2.0 * TAIL_WIDTHS * singular_width([spacing; 3], cloud) } else { 0.0 };
    Axis::ALL.map(|axis| AxisSize::new(domain, axis, spacing, tail))
}

/// Widest node spacing of a grid with nodes at most `spacing` apart [m].
pub(crate) fn widest_spacing(domain: &Domain, spacing: f64) -> f64 {
    Axis::ALL.map(|axis| AxisSize::new(domain, axis, spacing, 0.0).spacing).into_iter().fold(0.0, f64::max)
}
