//! Sums over pairs and images: Coulomb's in an open box, the short-ranged part of Ewald's in a closed one.

use crate::geometry::image_cells::ImageCells;
use crate::geometry::images::ImageLattice;
use crate::numerics::processor::{Instructions, Vector, dispatched};
use crate::values::FieldAt;
use libm::erfc;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::FRAC_2_SQRT_PI;
use std::ops::Range;

/// Sum over the partners of one particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PairSum {
    /// Field and potential, over Coulomb's constant.
    pub(crate) field: FieldAt,
    /// Number of partners, images included.
    pub(crate) partners: usize,
}

/// Σ q erfc(αr)/r and its field at every particle, over all images within the cells' radius but the
/// particle itself.
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
            PairSum { field: FieldAt { e, potential }, partners }
        })
        .collect()
}

/// Charges and their finitely many images as a structure of arrays, one block for each image.
struct Sources {
    coordinates: [Vec<f64>; 3],
    charge: Vec<f64>,
}

/// Σ q/r and its field at every particle of an open box, over every charge and image but the particle
/// itself. Particles without charge only see.
pub(crate) fn open(lattice: &ImageLattice, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<PairSum> {
    let images: usize = lattice.axes.iter().map(|axis| axis.images.len()).product();
    let count = charges.iter().filter(|charge| **charge != 0.0).count();
    let empty = || vec![0.0; count * images];
    let mut sources = Sources { coordinates: [empty(), empty(), empty()], charge: empty() };
    // The particle itself among the sources, or the place where it would be.
    let mut own = vec![0..0; positions.len()];
    let mut number = 0;
    for (index, (position, &charge)) in positions.iter().zip(charges).enumerate() {
        if charge == 0.0 {
            own[index] = number..number;
            continue;
        }
        own[index] = number..number + 1;
        let mut place = number;
        lattice.for_each_finite(position, |image| {
            for axis in 0..3 {
                sources.coordinates[axis][place] = image.position[axis];
            }
            sources.charge[place] = charge * image.sign;
            place += count;
        });
        number += 1;
    }
    let instructions = Instructions::detect();
    positions
        .par_iter()
        .zip(&own)
        .map(|(at, own)| {
            let below = coulomb(instructions, &sources, 0..own.start, at);
            let above = coulomb(instructions, &sources, own.end..count * images, at);
            let sum: [f64; 4] = std::array::from_fn(|k| below[k] + above[k]);
            let [potential, ex, ey, ez] = sum;
            PairSum {
                field: FieldAt { e: Vector3::new(ex, ey, ez), potential },
                partners: count * images - own.len(),
            }
        })
        .collect()
}

dispatched! {
    /// Potential and field over k_e by a range of the sources.
    fn coulomb(sources: &Sources, range: Range<usize>, at: &Vector3<f64>) -> [f64; 4] = coulomb_in
}

#[inline(always)]
fn coulomb_in<V: Vector<Number = f64>>(
    sources: &Sources,
    range: Range<usize>,
    at: &Vector3<f64>,
) -> [f64; 4] {
    let [x, y, z] = &sources.coordinates;
    let (x, y, z, charge) = (&x[range.clone()], &y[range.clone()], &z[range.clone()], &sources.charge[range]);
    let (px, py, pz) = (V::splat(at.x), V::splat(at.y), V::splat(at.z));
    let zero = V::splat(0.0);
    let (mut total, mut ex, mut ey, mut ez) = (zero, zero, zero, zero);
    let whole = charge.len() / V::LANES * V::LANES;
    for first in (0..whole).step_by(V::LANES) {
        let dx = px.sub(V::load(&x[first..]));
        let dy = py.sub(V::load(&y[first..]));
        let dz = pz.sub(V::load(&z[first..]));
        let inverse = dx.mul_add(dx, dy.mul_add(dy, dz.mul(dz))).inverse_root();
        let potential = V::load(&charge[first..]).mul(inverse);
        let factor = potential.mul(inverse).mul(inverse);
        total = total.add(potential);
        ex = factor.mul_add(dx, ex);
        ey = factor.mul_add(dy, ey);
        ez = factor.mul_add(dz, ez);
    }
    let mut sums = [total.total(), ex.total(), ey.total(), ez.total()];
    for k in whole..charge.len() {
        let d = [at.x - x[k], at.y - y[k], at.z - z[k]];
        let inverse = 1.0 / (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let potential = charge[k] * inverse;
        let factor = potential * inverse * inverse;
        for (sum, value) in sums.iter_mut().zip([potential, factor * d[0], factor * d[1], factor * d[2]]) {
            *sum += value;
        }
    }
    sums
}
