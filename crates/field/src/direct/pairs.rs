//! Sums over pairs and images: Coulomb's in an open box, the short-ranged part of Ewald's in a closed one.

use crate::image_cells::ImageCells;
use crate::images::ImageLattice;
use libm::erfc;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::FRAC_2_SQRT_PI;
use std::ops::Range;

/// Terms summed side by side.
const LANES: usize = 4;

/// Potential and field over k_e, and the number of partners.
pub(crate) type PairSum = (f64, Vector3<f64>, usize);

/// Σ q erfc(αr)/r and its field at every particle, over all images within the cells' radius but the particle itself.
pub(crate) fn short_ranged(cells: &ImageCells<()>, positions: &[Vector3<f64>], alpha: f64) -> Vec<PairSum> {
    let gaussian = alpha * FRAC_2_SQRT_PI;
    positions
        .par_iter()
        .enumerate()
        .map(|(index, at)| {
            let (mut potential, mut e, mut partners) = (0.0, Vector3::zeros(), 0);
            cells.for_each_partner(index, at, |k, d, square| {
                let distance = square.sqrt();
                let u = alpha * distance;
                let inverse = 1.0 / distance;
                let value = cells.charge[k] * erfc(u) * inverse;
                potential += value;
                e += d * ((value + cells.charge[k] * gaussian * (-u * u).exp()) * inverse * inverse);
                partners += 1;
            });
            (potential, e, partners)
        })
        .collect()
}

/// Charges and their finitely many images as a structure of arrays, one block for each image.
struct Sources {
    coordinates: [Vec<f64>; 3],
    charge: Vec<f64>,
}

/// Σ q/r and its field at every particle of an open box, over every charge and image but the particle itself.
pub(crate) fn open(lattice: &ImageLattice, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<PairSum> {
    let count = positions.len();
    let images: usize = lattice.axes.iter().map(|axis| axis.images.len()).product();
    let empty = || vec![0.0; count * images];
    let mut sources = Sources { coordinates: [empty(), empty(), empty()], charge: empty() };
    for (index, (position, charge)) in positions.iter().zip(charges).enumerate() {
        let mut place = index;
        lattice.for_each_finite(position, |image| {
            for axis in 0..3 {
                sources.coordinates[axis][place] = image.position[axis];
            }
            sources.charge[place] = charge * image.sign;
            place += count;
        });
    }
    positions
        .par_iter()
        .enumerate()
        .map(|(index, at)| {
            let below = coulomb(&sources, 0..index, at);
            let above = coulomb(&sources, index + 1..count * images, at);
            let sum: [f64; 4] = std::array::from_fn(|k| below[k] + above[k]);
            (sum[0], Vector3::new(sum[1], sum[2], sum[3]), count * images - 1)
        })
        .collect()
}

/// Potential and field over k_e by a range of the sources.
fn coulomb(sources: &Sources, range: Range<usize>, at: &Vector3<f64>) -> [f64; 4] {
    let [x, y, z] = [0, 1, 2].map(|axis| &sources.coordinates[axis][range.clone()]);
    let charge = &sources.charge[range];
    let term = |k: usize| {
        let d = [at.x - x[k], at.y - y[k], at.z - z[k]];
        let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        let inverse = 1.0 / square.sqrt();
        let potential = charge[k] * inverse;
        let factor = potential * inverse * inverse;
        [potential, factor * d[0], factor * d[1], factor * d[2]]
    };
    let mut lanes = [[0.0; LANES]; 4];
    let whole = charge.len() / LANES * LANES;
    for first in (0..whole).step_by(LANES) {
        for lane in 0..LANES {
            let value = term(first + lane);
            for (sum, value) in lanes.iter_mut().zip(value) {
                sum[lane] += value;
            }
        }
    }
    let mut total = lanes.map(|sum| (sum[0] + sum[1]) + (sum[2] + sum[3]));
    for k in whole..charge.len() {
        for (sum, value) in total.iter_mut().zip(term(k)) {
            *sum += value;
        }
    }
    total
}
