//! Node values with a halo on every side, so that windows need not know the faces.

use super::axis::GridAxis;
use super::window::HALO;

/// Values at nodes −HALO … n + HALO − 1 of every axis, z fastest.
#[derive(Debug)]
pub(crate) struct HaloArray {
    dimensions: [usize; 3],
    pub(crate) values: Vec<f64>,
}

impl HaloArray {
    pub(crate) fn new(axes: &[GridAxis; 3]) -> Self {
        let dimensions = axes.each_ref().map(|axis| axis.nodes + 2 * HALO);
        Self { dimensions, values: vec![0.0; dimensions.iter().product()] }
    }

    /// Values of one plane of x, halo included.
    pub(crate) fn plane_len(&self) -> usize {
        self.dimensions[1] * self.dimensions[2]
    }

    /// Length of one row along z, halo included.
    pub(crate) fn row_len(&self) -> usize {
        self.dimensions[2]
    }

    /// Values from one node to the next along x and along y.
    pub(crate) fn steps(&self) -> [usize; 2] {
        [self.plane_len(), self.row_len()]
    }

    /// Adds what was spread beyond the faces to the nodes that it belongs to.
    pub(crate) fn fold(&mut self, axes: &[GridAxis; 3]) {
        for axis in 0..3 {
            self.for_each_ghost(axes, axis, |values, ghost, node, sign| {
                values[node] += sign * values[ghost];
            });
        }
    }

    /// Continues the values of the nodes beyond the faces.
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
