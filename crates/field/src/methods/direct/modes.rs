//! The smooth part of Ewald's sum, in functions of the box that obey its faces.
//!
//! φ(x) = Σ_abc w_abc ψ_a(x) ψ_b(y) ψ_c(z) Σ_j q_j ψ_a(x_j) ψ_b(y_j) ψ_c(z_j): images come with the
//! functions.

use super::splitting::{AxisBasis, Cut, Splitting};
use crate::numerics::bessel::CutLine;
use crate::values::FieldAt;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Particles whose functions are held at once: their tables stay in the first-level cache.
const BLOCK: usize = 16;
/// Functions of the innermost axis summed side by side.
const LANES: usize = 4;
/// Parts of the particles whose sums are formed apart and added in order, whatever the number of threads.
const PARTS: usize = 16;
/// Least particles in a part.
const LEAST_PART: usize = 64;

/// Functions a, b of the two outer axes and the run of functions of the inner axis that go with them.
#[derive(Clone, Copy, Debug)]
struct Row {
    outer: usize,
    middle: usize,
    offset: usize,
    len: usize,
}

/// All modes up to the largest wave number.
#[derive(Clone, Debug)]
pub(crate) struct Modes {
    /// Axes in the order outer, middle, inner.
    order: [usize; 3],
    bases: [AxisBasis; 3],
    counts: [usize; 3],
    rows: Vec<Row>,
    weights: Vec<f64>,
}

/// Functions and slopes of a block of particles.
struct Tables {
    outer: [Vec<f64>; 2],
    middle: [Vec<f64>; 2],
    inner: [Vec<f64>; 2],
}

impl Modes {
    /// The modes of a splitting.
    pub(crate) fn new(splitting: &Splitting) -> Self {
        let limit = splitting.wave_limit;
        let mut order = [0, 1, 2];
        order.sort_by_key(|&axis| splitting.bases[axis].count(limit));
        let bases = order.map(|axis| splitting.bases[axis]);
        let counts = bases.map(|basis| basis.count(limit));
        let mut modes = Self { order, bases, counts, rows: Vec::new(), weights: Vec::new() };
        let green = modes.green_functions(splitting);
        for outer in 0..counts[0] {
            for middle in 0..counts[1] {
                let rest = limit.powi(2)
                    - bases[0].wave_number(outer).powi(2)
                    - bases[1].wave_number(middle).powi(2);
                let len = if rest < 0.0 { 0 } else { bases[2].count(rest.sqrt()) };
                if len > 0 {
                    let row =
                        Row { outer, middle, offset: modes.weights.len(), len: len.next_multiple_of(LANES) };
                    modes.rows.push(row);
                    for inner in 0..row.len {
                        let functions = [outer, middle, inner];
                        let weight =
                            if inner < len { modes.weight(splitting, functions, &green) } else { 0.0 };
                        modes.weights.push(weight);
                    }
                }
            }
        }
        modes
    }

    /// Weight of a mode: the smoothed Green function's transform over the functions' norms [1/m].
    fn weight(&self, splitting: &Splitting, functions: [usize; 3], green: &[Green]) -> f64 {
        let mut squares = [0.0; 2];
        let mut weight = 4.0 * PI;
        for (basis, function) in self.bases.iter().zip(functions) {
            squares[usize::from(basis.is_open)] += basis.wave_number(function).powi(2);
            weight *= basis.weight(function);
        }
        let total = squares[0] + squares[1];
        let smooth = (-total / (4.0 * splitting.alpha.powi(2))).exp();
        let green = &green[self.closed().map_or(0, |closed| functions[closed])];
        weight * smooth * green.at(squares[0].sqrt(), squares[1].sqrt())
    }

    /// Place in the order of the only closed axis, where two others are open.
    fn closed(&self) -> Option<usize> {
        let closed = self.bases.iter().position(|basis| !basis.is_open);
        closed.filter(|_| self.bases.iter().filter(|basis| basis.is_open).count() == 2)
    }

    /// Green functions: one for each function of the only closed axis, else one.
    fn green_functions(&self, splitting: &Splitting) -> Vec<Green> {
        match (splitting.cut, self.closed()) {
            (Cut::Cylinder { radius, unit }, Some(closed)) => (0..self.counts[closed])
                .map(|function| {
                    Green::Line(CutLine::new(self.bases[closed].wave_number(function), radius, unit))
                })
                .collect(),
            (Cut::Layer(cut), _) => vec![Green::Layer(cut)],
            _ => vec![Green::Whole],
        }
    }

    /// Σ_j q_j ψ_abc(x_j) times the weight, for every mode.
    pub(crate) fn amplitudes(&self, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<f64> {
        let part = positions.len().div_ceil(PARTS).max(LEAST_PART);
        let sums: Vec<Vec<f64>> = positions
            .par_chunks(part)
            .zip(charges.par_chunks(part))
            .map(|(positions, charges)| self.spread(positions, charges))
            .collect();
        let mut amplitudes = vec![0.0; self.weights.len()];
        for sum in &sums {
            for (total, value) in amplitudes.iter_mut().zip(sum) {
                *total += value;
            }
        }
        for (amplitude, weight) in amplitudes.iter_mut().zip(&self.weights) {
            *amplitude *= weight;
        }
        amplitudes
    }

    fn spread(&self, positions: &[Vector3<f64>], charges: &[f64]) -> Vec<f64> {
        let mut sums = vec![0.0; self.weights.len()];
        let mut tables = self.tables();
        let stride = self.inner_stride();
        for (positions, charges) in positions.chunks(BLOCK).zip(charges.chunks(BLOCK)) {
            self.fill(positions, &mut tables);
            for row in &self.rows {
                let sum = &mut sums[row.offset..row.offset + row.len];
                let outer = &tables.outer[0][row.outer * BLOCK..];
                let middle = &tables.middle[0][row.middle * BLOCK..];
                let factor = |j: usize| charges.get(j).map_or(0.0, |charge| charge * outer[j] * middle[j]);
                for first in (0..positions.len()).step_by(4) {
                    let factors = [0, 1, 2, 3].map(|lane| factor(first + lane));
                    let [a, b, c, d] =
                        [0, 1, 2, 3].map(|lane| &tables.inner[0][(first + lane) * stride..][..row.len]);
                    for (k, total) in sum.iter_mut().enumerate() {
                        *total +=
                            (factors[0] * a[k] + factors[1] * b[k]) + (factors[2] * c[k] + factors[3] * d[k]);
                    }
                }
            }
        }
        sums
    }

    /// Field and potential over Coulomb's constant at every position.
    pub(crate) fn gather(&self, amplitudes: &[f64], positions: &[Vector3<f64>]) -> Vec<FieldAt> {
        positions.par_chunks(BLOCK).map(|block| self.gather_block(amplitudes, block)).flatten_iter().collect()
    }

    fn gather_block(&self, amplitudes: &[f64], positions: &[Vector3<f64>]) -> Vec<FieldAt> {
        let mut tables = self.tables();
        self.fill(positions, &mut tables);
        let stride = self.inner_stride();
        let mut out = vec![FieldAt::default(); positions.len()];
        for row in &self.rows {
            let amplitude = &amplitudes[row.offset..row.offset + row.len];
            let [outer, middle] = [row.outer * BLOCK, row.middle * BLOCK];
            for (j, FieldAt { e, potential }) in out.iter_mut().enumerate() {
                let value = dot(amplitude, &tables.inner[0][j * stride..]);
                let slope = dot(amplitude, &tables.inner[1][j * stride..]);
                let [a, da] = [0, 1].map(|kind| tables.outer[kind][outer + j]);
                let [b, db] = [0, 1].map(|kind| tables.middle[kind][middle + j]);
                *potential += a * b * value;
                e[self.order[0]] -= da * b * value;
                e[self.order[1]] -= a * db * value;
                e[self.order[2]] -= a * b * slope;
            }
        }
        out
    }

    fn inner_stride(&self) -> usize {
        self.counts[2].next_multiple_of(LANES)
    }

    fn tables(&self) -> Tables {
        let zeros = |len: usize| [vec![0.0; len], vec![0.0; len]];
        Tables {
            outer: zeros(self.counts[0] * BLOCK),
            middle: zeros(self.counts[1] * BLOCK),
            inner: zeros(self.inner_stride() * BLOCK),
        }
    }

    fn fill(&self, positions: &[Vector3<f64>], tables: &mut Tables) {
        let stride = self.inner_stride();
        for (j, position) in positions.iter().enumerate() {
            let at = self.order.map(|axis| position[axis]);
            for (axis, table) in [&mut tables.outer, &mut tables.middle].into_iter().enumerate() {
                let [values, slopes] = table;
                let count = self.counts[axis];
                if count > 0 {
                    self.bases[axis].fill(at[axis], count, BLOCK, &mut values[j..], &mut slopes[j..]);
                }
            }
            let [values, slopes] = &mut tables.inner;
            let start = j * stride;
            self.bases[2].fill(at[2], self.counts[2], 1, &mut values[start..], &mut slopes[start..]);
        }
    }

    /// Number of modes.
    pub(crate) fn len(&self) -> usize {
        self.weights.len()
    }
}

/// Sum of products over the first slice's length, a multiple of [`LANES`].
fn dot(amplitude: &[f64], values: &[f64]) -> f64 {
    let mut lanes = [0.0; LANES];
    for (a, b) in amplitude.chunks_exact(LANES).zip(values.chunks_exact(LANES)) {
        for lane in 0..LANES {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

/// Green function of −∇², cut where an axis is open.
enum Green {
    /// All axes are closed.
    Whole,
    /// Cut at this distance along the open axis [m].
    Layer(f64),
    /// Cut at a cylinder about the only closed axis.
    Line(CutLine),
}

impl Green {
    /// Transform at wave number `k` along the closed axes and `kappa` along the open ones [m²]. The constant
    /// mode of a closed box, whose potential is free, is zero. Along one open axis it is the transform of
    /// e^{−k|z|}/(2k), or −|z|/2 for k = 0.
    fn at(&self, k: f64, kappa: f64) -> f64 {
        let total = k * k + kappa * kappa;
        let cut = match self {
            Self::Whole => return if total > 0.0 { 1.0 / total } else { 0.0 },
            Self::Line(line) if total > 0.0 => return (1.0 + line.change(line.waves(kappa))) / total,
            Self::Line(line) => return line.at_origin(),
            Self::Layer(cut) => *cut,
        };
        let (sine, cosine) = (kappa * cut).sin_cos();
        if k > 0.0 {
            (1.0 - (-k * cut).exp() * (cosine - kappa / k * sine)) / total
        } else if kappa > 0.0 {
            -(cut * sine / kappa + (cosine - 1.0) / total)
        } else {
            -0.5 * cut * cut
        }
    }
}
