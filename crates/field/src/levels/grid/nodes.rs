//! Values at nodes that lie side by side: all nodes of a grid with a halo on every side, so that windows need
//! not know the faces, or those that some grains touch.

use super::axis::GridAxis;
use super::window::HALO;

/// Place of an array among the nodes of a grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    /// First node along each axis.
    pub(crate) first: [isize; 3],
    /// Values from one node to the next along x.
    pub(crate) plane: usize,
    /// Values from one node to the next along y.
    pub(crate) row: usize,
}

/// Values at nodes, z fastest.
#[derive(Debug)]
pub(crate) struct NodeArray {
    first: [isize; 3],
    dimensions: [usize; 3],
    pub(crate) values: Vec<f64>,
}

impl NodeArray {
    /// Array of all nodes, −HALO … n + HALO − 1 along every axis.
    pub(crate) fn with_halo(axes: &[GridAxis; 3]) -> Self {
        let dimensions = axes.each_ref().map(|axis| axis.nodes + 2 * HALO);
        let values = vec![0.0; dimensions.iter().product()];
        Self { first: [-(HALO as isize); 3], dimensions, values }
    }

    /// Array without nodes.
    pub(crate) fn empty() -> Self {
        Self { first: [0; 3], dimensions: [0; 3], values: Vec::new() }
    }

    /// Moves the array to other nodes and makes their values zero; memory is kept.
    pub(crate) fn move_to(&mut self, first: [isize; 3], dimensions: [usize; 3]) {
        (self.first, self.dimensions) = (first, dimensions);
        self.values.clear();
        self.values.resize(dimensions.iter().product(), 0.0);
    }

    /// Number of planes of x.
    pub(crate) fn planes(&self) -> usize {
        self.dimensions[0]
    }

    /// Place of the array among the nodes.
    pub(crate) fn frame(&self) -> Frame {
        let [_, y, z] = self.dimensions;
        Frame { first: self.first, plane: y * z, row: z }
    }

    /// Values of one plane of x.
    pub(crate) fn plane_len(&self) -> usize {
        self.frame().plane
    }

    /// Length of one row along z.
    pub(crate) fn row_len(&self) -> usize {
        self.frame().row
    }

    /// Adds what was spread into the halo to the nodes that it belongs to.
    pub(crate) fn fold(&mut self, axes: &[GridAxis; 3]) {
        for axis in 0..3 {
            self.for_each_ghost(axes, axis, |values, ghost, node, sign| {
                values[node] += sign * values[ghost];
            });
        }
    }

    /// Continues the values of the nodes into the halo.
    pub(crate) fn unfold(&mut self, axes: &[GridAxis; 3]) {
        for axis in (0..3).rev() {
            self.for_each_ghost(axes, axis, |values, ghost, node, sign| {
                values[ghost] = sign * values[node];
            });
        }
    }

    fn for_each_ghost(
        &mut self,
        axes: &[GridAxis; 3],
        axis: usize,
        mut visit: impl FnMut(&mut [f64], usize, usize, f64),
    ) {
        let stride: usize = self.dimensions[axis + 1..].iter().product();
        let length = self.dimensions[axis];
        let blocks: usize = self.dimensions[..axis].iter().product();
        let nodes = axes[axis].nodes;
        for ghost in (0..HALO).chain(HALO + nodes..length) {
            let Some((node, sign)) = axes[axis].fold(ghost as isize - HALO as isize) else { continue };
            for block in 0..blocks {
                let start = block * length * stride;
                for inner in start..start + stride {
                    visit(&mut self.values, inner + ghost * stride, inner + (node + HALO) * stride, sign);
                }
            }
        }
    }
}
