//! The smooth level on the internal grid: spread charge with the window, convolve, gather potential and
//! field.

use super::assignment::Assignment;
use super::axis::{AxisSize, GridAxis, TAIL_WIDTHS};
use super::influence::{Influence, singular_width};
use super::nodes::NodeArray;
use super::solve::Solver;
use super::window::Window;
use crate::geometry::images::axis_kinds;
use crate::values::FieldAt;
use amberfield_core::{Axis, Domain};
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use nalgebra::Vector3;

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

/// Field of the clouds around the charges, with the box's own faces.
#[derive(Debug)]
pub(crate) struct GridLevel {
    axes: [GridAxis; 3],
    assignment: Assignment,
    nodes: NodeArray,
    solver: Solver,
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
        let axes = grid_axes(domain, parameters);
        let assignment = Assignment::new(parameters.order, parameters.window_shape);
        let influence = influence(&axes, assignment.window(), parameters.cloud);
        let solver = Solver::new(&axes, influence);
        let nodes = NodeArray::with_halo(&axes);
        Self { axes, assignment, nodes, solver }
    }

    /// Nodes that carry charge, per axis.
    pub(crate) fn cells(&self) -> [usize; 3] {
        self.axes.each_ref().map(|axis| axis.nodes)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        8 * self.nodes.values.len() + self.solver.memory_bytes() + self.assignment.memory_bytes()
    }

    /// Computes the clouds' potential at the nodes (4πε = 1). Positions lie inside the domain.
    pub(crate) fn solve(&mut self, positions: &[Vector3<f64>], charges: &[f64]) {
        self.nodes.values.fill(0.0);
        self.assignment.spread(&self.axes, positions, charges, &mut self.nodes);
        self.nodes.fold(&self.axes);
        self.solver.solve(&self.axes, &mut self.nodes);
        self.nodes.unfold(&self.axes);
    }

    /// E and potential of the clouds (4πε = 1) at the given positions, after [`Self::solve`].
    pub(crate) fn gather(&self, positions: &[Vector3<f64>], field: &mut [FieldAt]) {
        self.assignment.gather(&self.axes, &self.nodes, positions, field);
    }

    /// Potential alone (density, of a grid that has one) at the given positions, after [`Self::solve`].
    pub(crate) fn gather_values(&self, positions: &[Vector3<f64>], values: &mut [f64]) {
        self.assignment.gather_values(&self.axes, &self.nodes, positions, values);
    }
}

/// The axes of a grid in a domain.
pub(crate) fn grid_axes(domain: &Domain, parameters: GridParameters) -> [GridAxis; 3] {
    let sizes = grid_sizes(domain, parameters.spacing_m, parameters.cloud);
    Axis::ALL.map(|axis| GridAxis::new(domain, axis, sizes[axis.index()]))
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
