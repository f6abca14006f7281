//! The inverse of −∇²_h in the transforms' coefficients.

use super::lattice::green_function;
use super::mesh::MeshAxis;
use crate::levels::grid::transform::{LineTransform, Symmetry};
use nalgebra::Vector3;
use rayon::prelude::*;

/// The inverse of −∇²_h for each combination of coefficients.
#[derive(Debug)]
pub(super) enum Inverse {
    /// Inverse sum of each axis' eigenvalues [1/m²], 0 for the constant mode.
    Closed([Vec<f64>; 3]),
    /// Inverse of the eigenvalues, times what cuts the Green function of the open axis at half its period.
    ///
    /// Along the open axis the coefficient with eigenvalue λ on the others has the Green function g_n = h²
    /// ϱ^|n|/(1/ϱ − ϱ), ϱ + 1/ϱ = 2 + λh², or −|n|h²/2 for λ = 0. Cut at n = R and repeated with period 2R
    /// its transform is (1 − (−1)^w ϱ^R)/Λ, w the wave's order and Λ the sum of all eigenvalues; −(hR)²/2
    /// where Λ = 0.
    Slab { eigenvalues: [Vec<f64>; 3], open: usize, cut: Vec<f64>, constant: f64 },
    /// Transform of the unbounded grid's Green function [m²] by the waves' orders, index [y][z][x].
    Open { values: Vec<f64>, orders: [usize; 3] },
}

impl Inverse {
    pub(super) fn new(axes: &[MeshAxis; 3]) -> Self {
        let eigenvalues = || {
            axes.each_ref()
                .map(|axis| (0..axis.transform.len()).map(|index| axis.eigenvalue(index)).collect())
        };
        let mut open = (0..3).filter(|&axis| axes[axis].period.is_some());
        match (open.next(), open.next()) {
            (None, _) => Self::Closed(eigenvalues()),
            (Some(axis), None) => Self::slab(axes, eigenvalues(), axis),
            _ => Self::open(axes),
        }
    }

    fn slab(axes: &[MeshAxis; 3], eigenvalues: [Vec<f64>; 3], open: usize) -> Self {
        let (h, half) = (axes[open].spacing, half_period(&axes[open]) as f64);
        let [b, c] = beside(open);
        let cut = |lambda: f64| {
            let half_sum = 0.5 * lambda * h * h;
            // −ln ϱ = acosh(1 + λh²/2), without loss for small λ.
            (-half * (half_sum + (half_sum * (half_sum + 2.0)).sqrt()).ln_1p()).exp()
        };
        let cut =
            eigenvalues[b].iter().flat_map(|b| eigenvalues[c].iter().map(move |c| cut(b + c))).collect();
        Self::Slab { eigenvalues, open, cut, constant: -0.5 * (h * half).powi(2) }
    }

    fn open(axes: &[MeshAxis; 3]) -> Self {
        let spacing = Vector3::from_fn(|axis, _| axes[axis].spacing);
        let halves = axes.each_ref().map(half_period);
        let mut kernel = green_function(halves, spacing);
        // One axis after another: Σ over a period of an even function is a cosine sum of its half.
        let orders = halves.map(|half| half + 1);
        let strides = [orders[1] * orders[2], orders[2], 1];
        for axis in 0..3 {
            let (length, stride) = (orders[axis], strides[axis]);
            let transform = LineTransform::new(Symmetry::Periodic, 2 * halves[axis]);
            let mut scratch = transform.scratch();
            let mut line = vec![0.0; 2 * halves[axis]];
            for outer in 0..kernel.len() / (length * stride) {
                for inner in 0..stride {
                    let start = outer * length * stride + inner;
                    for (n, value) in line.iter_mut().enumerate() {
                        *value = kernel[start + n.min(2 * halves[axis] - n) * stride];
                    }
                    transform.forward(&mut line, &mut scratch);
                    for order in 0..length {
                        // Real parts alone, the first of each pair.
                        kernel[start + order * stride] = line[(2 * order).saturating_sub(1)];
                    }
                }
            }
        }
        let mut values = vec![0.0; kernel.len()];
        for (index, value) in values.iter_mut().enumerate() {
            let [y, z, x] =
                [index / (orders[0] * orders[2]), index / orders[0] % orders[2], index % orders[0]];
            *value = kernel[(x * orders[1] + y) * orders[2] + z];
        }
        Self::Open { values, orders }
    }

    /// Right-hand side to potential, coefficients in lines along x, index [y][z][x]; the transforms' scale
    /// included.
    pub(super) fn apply(&self, axes: &[MeshAxis; 3], lines: &mut [f64]) {
        let [nx, _, nz] = axes.each_ref().map(|axis| axis.transform.len());
        let scale = 1.0 / axes.iter().map(|axis| axis.transform.scale()).product::<f64>();
        lines.par_chunks_mut(nx).enumerate().for_each(|(place, line)| {
            let (y, z) = (place / nz, place % nz);
            match self {
                Self::Closed([of_x, of_y, of_z]) => {
                    for (value, of_x) in line.iter_mut().zip(of_x) {
                        let sum = of_x + of_y[y] + of_z[z];
                        *value *= if sum > 0.0 { scale / sum } else { 0.0 };
                    }
                }
                Self::Slab { eigenvalues: [of_x, of_y, of_z], open, cut, constant } => {
                    let [b, c] = beside(*open);
                    for (x, value) in line.iter_mut().enumerate() {
                        let at = [x, y, z];
                        let sum = of_x[x] + of_y[y] + of_z[z];
                        let sign = if axes[*open].order(at[*open]).is_multiple_of(2) { 1.0 } else { -1.0 };
                        let cut = cut[at[b] * axes[c].transform.len() + at[c]];
                        *value *= scale * if sum > 0.0 { (1.0 - sign * cut) / sum } else { *constant };
                    }
                }
                Self::Open { values, orders } => {
                    let row = (axes[1].order(y) * orders[2] + axes[2].order(z)) * orders[0];
                    for (x, value) in line.iter_mut().enumerate() {
                        *value *= scale * values[row + axes[0].order(x)];
                    }
                }
            }
        });
    }

    /// Numbers held.
    pub(super) fn len(&self) -> usize {
        match self {
            Self::Closed(eigenvalues) => eigenvalues.iter().map(Vec::len).sum(),
            Self::Slab { eigenvalues, cut, .. } => {
                eigenvalues.iter().map(Vec::len).sum::<usize>() + cut.len()
            }
            Self::Open { values, .. } => values.len(),
        }
    }
}

/// Returns the two axes beside one.
fn beside(axis: usize) -> [usize; 2] {
    [(axis + 1) % 3, (axis + 2) % 3]
}

fn half_period(axis: &MeshAxis) -> usize {
    axis.period.expect("the axis is open") / 2
}
