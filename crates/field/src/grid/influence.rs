//! The influence function: what a coefficient of node charge contributes to the same coefficient of node
//! potential.
//!
//! G(k) = 4π Π_a n_a(k_a) / Σ_a b_a(k_a),  n_a = Σ_m W²(k_m) e^{−k_m²σ²/2} / (Σ_m W²)²,
//! b_a = Σ_m k_m² W² / Σ_m W²,  k_m = k + 2πm/h,  W(k) = (sin(kh/2)/(kh/2))^p.
//!
//! It minimises the RMS error of a field gathered with the gradient of the assignment spline of order p
//! (Hockney & Eastwood, *Computer Simulation Using Particles*, 1988, ch. 8; Ballenegger, Cerdà & Holm,
//! J. Chem. Theory Comput. 8, 936, 2012) for the reference 4π e^{−k²σ²/2}/k². Because k²·reference is a product
//! over the axes, so is the numerator: three short tables are enough.
//!
//! Open axes need a kernel of finite reach R. A wide Gaussian of width Σ carries the singularity at k = 0:
//! Π n(σ) becomes Π n(σ) + (T(k) − 1) Π n(Σ), with T the transform of the truncated Green's function over that
//! of the whole one (Vico, Greengard & Ferrando, J. Comput. Phys. 323, 191, 2016):
//! T − 1 = −cos(kR) in free space; −e^{−k∥R}[cos κR − (κ/k∥) sin κR] between two closed axes, and
//! −cos κR − κR sin κR for k∥ = 0.

use super::axis::{GridAxis, TAIL_WIDTHS, smooth_even};
use nalgebra::Vector3;
use rustdct::DctPlanner;
use std::f64::consts::PI;

/// Aliases summed on either side; the terms left out are below 1e-9 of the sum at order 4.
const ALIASES: i32 = 4;
/// Width of the singular part's Gaussian in node spacings: its spectrum is e^{−32} at the zone's edge.
const SINGULAR_WIDTH: f64 = 2.55;

/// One axis' tables, by wave index.
#[derive(Clone, Debug)]
struct AxisTables {
    /// n_a(σ).
    smooth: Vec<f64>,
    /// n_a(Σ), only for open boxes.
    singular: Vec<f64>,
    /// b_a [1/m²].
    squared: Vec<f64>,
}

impl AxisTables {
    /// Tables at wave numbers `phases/spacing`, phases in [0, π].
    fn new(spacing: f64, order: usize, widths: [f64; 2], phases: impl Iterator<Item = f64>) -> Self {
        let (mut smooth, mut singular, mut squared) = (Vec::new(), Vec::new(), Vec::new());
        for phase in phases {
            let (mut a, mut b, mut n) = (0.0, 0.0, [0.0; 2]);
            for m in -ALIASES..=ALIASES {
                let km = phase + 2.0 * PI * f64::from(m);
                // At k = 0 the principal alias alone is not zero, exactly: rounding must not fill the rest.
                let sinc = match (phase == 0.0, m == 0) {
                    (true, true) => 1.0,
                    (true, false) => 0.0,
                    _ => (0.5 * km).sin() / (0.5 * km),
                };
                let window = sinc.powi(2 * order as i32);
                let wave_squared = (km / spacing).powi(2);
                a += window;
                b += wave_squared * window;
                for (sum, width) in n.iter_mut().zip(widths) {
                    *sum += window * (-0.5 * wave_squared * width * width).exp();
                }
            }
            smooth.push(n[0] / (a * a));
            singular.push(n[1] / (a * a));
            squared.push(b / a);
        }
        Self { smooth, singular, squared }
    }
}

/// Width Σ of the Gaussian that carries the singular part of a truncated kernel [m].
pub(crate) fn singular_width(spacings: [f64; 3], sigma: f64) -> f64 {
    let widest = spacings.into_iter().fold(0.0, f64::max);
    (SINGULAR_WIDTH * widest).max(sigma)
}

/// The influence function of a grid, with the transforms' scale and the cell volume divided out.
#[derive(Debug)]
pub(crate) enum Influence {
    /// All axes closed: evaluated from the tables of the three axes.
    Product { smooth: [Vec<f64>; 3], squared: [Vec<f64>; 3], factor: f64 },
    /// Open axes: tabulated over wave indices, z fastest.
    Table { dimensions: [usize; 3], first: [usize; 3], values: Vec<f64> },
}

impl Influence {
    /// Influence function of Gaussian width `sigma` [m] for splines of the given order.
    pub(crate) fn new(axes: &[GridAxis; 3], order: usize, sigma: f64) -> Self {
        let scale: f64 = axes.iter().map(|axis| axis.transform.scale() * axis.spacing).product();
        let factor = 4.0 * PI / scale;
        let open = axes.iter().filter(|axis| axis.open).count();
        if open == 0 {
            let tables = axes.each_ref().map(|axis| own_tables(axis, order, [sigma; 2]));
            let smooth = tables.each_ref().map(|table| table.smooth.clone());
            return Self::Product { smooth, squared: tables.map(|table| table.squared), factor };
        }
        let wide = singular_width(axes.each_ref().map(|axis| axis.spacing), sigma);
        if open == 3 {
            return free_space_table(axes, order, [sigma, wide]);
        }
        let dimensions = axes.each_ref().map(|axis| axis.transform.wave_count());
        let tables = axes.each_ref().map(|axis| own_tables(axis, order, [sigma, wide]));
        let mut values = Vec::with_capacity(dimensions.iter().product());
        let open_axis = axes.iter().position(|axis| axis.open).expect("one axis is open");
        let radius = axes[open_axis].reach() + TAIL_WIDTHS * wide;
        let waves = axes.each_ref().map(wave_numbers);
        for x in 0..dimensions[0] {
            for y in 0..dimensions[1] {
                for z in 0..dimensions[2] {
                    let wave = Vector3::new(waves[0][x], waves[1][y], waves[2][z]);
                    let truncation = slab_truncation(wave, open_axis, radius);
                    let at_origin = 0.5 * (wide * wide - sigma * sigma) - 0.5 * radius * radius;
                    values.push(factor * kernel(&tables, [x, y, z], truncation, at_origin));
                }
            }
        }
        Self::Table { dimensions, first: [0; 3], values }
    }

    /// Bytes held.
    pub(crate) fn memory_bytes(&self) -> usize {
        8 * match self {
            Self::Product { smooth, squared, .. } => smooth.iter().chain(squared).map(Vec::len).sum(),
            Self::Table { values, .. } => values.len(),
        }
    }

    /// Multiplies a line of coefficients along x, at wave indices `y` and `z`.
    pub(crate) fn apply(&self, axes: &[GridAxis; 3], line: &mut [f64], y: usize, z: usize) {
        let wave_x = |coefficient| axes[0].transform.wave_index(coefficient);
        match self {
            Self::Product { smooth, squared, factor } => {
                let (across, offset) = (factor * smooth[1][y] * smooth[2][z], squared[1][y] + squared[2][z]);
                for (coefficient, value) in line.iter_mut().enumerate() {
                    let x = wave_x(coefficient);
                    let denominator = squared[0][x] + offset;
                    *value *= if denominator == 0.0 { 0.0 } else { across * smooth[0][x] / denominator };
                }
            }
            Self::Table { dimensions, first, values } => {
                let at = |x| ((x + first[0]) * dimensions[1] + y + first[1]) * dimensions[2] + z + first[2];
                for (coefficient, value) in line.iter_mut().enumerate() {
                    *value *= values[at(wave_x(coefficient))];
                }
            }
        }
    }
}

fn own_tables(axis: &GridAxis, order: usize, widths: [f64; 2]) -> AxisTables {
    let transform = &axis.transform;
    let phases = (0..transform.wave_count()).map(|index| transform.wave_number(index));
    AxisTables::new(axis.spacing, order, widths, phases)
}

fn wave_numbers(axis: &GridAxis) -> Vec<f64> {
    (0..axis.transform.wave_count()).map(|index| axis.transform.wave_number(index) / axis.spacing).collect()
}

/// [Π n(σ) + truncation · Π n(Σ)]/Σ b, or its limit where the denominator vanishes.
fn kernel(tables: &[AxisTables; 3], at: [usize; 3], truncation: f64, at_origin: f64) -> f64 {
    let denominator: f64 = (0..3).map(|axis| tables[axis].squared[at[axis]]).sum();
    if denominator == 0.0 {
        return at_origin;
    }
    let smooth: f64 = (0..3).map(|axis| tables[axis].smooth[at[axis]]).product();
    let singular: f64 = (0..3).map(|axis| tables[axis].singular[at[axis]]).product();
    (smooth + truncation * singular) / denominator
}

/// T(k) − 1 for a kernel cut at |z| = R along the open axis.
fn slab_truncation(wave: Vector3<f64>, open_axis: usize, radius: f64) -> f64 {
    let across = wave[open_axis];
    let along = (wave.norm_squared() - across * across).max(0.0).sqrt();
    let phase = across * radius;
    if along == 0.0 {
        -phase.cos() - phase * phase.sin()
    } else {
        -(-along * radius).exp() * (phase.cos() - across / along * phase.sin())
    }
}

/// Kernel of a box without closed axes: cut at a sphere on a grid wide enough for it, then cropped in real
/// space to the displacements that occur.
fn free_space_table(axes: &[GridAxis; 3], order: usize, widths: [f64; 2]) -> Influence {
    let [sigma, wide] = widths;
    let reach = Vector3::from_fn(|axis, _| axes[axis].reach());
    let radius = reach.norm() + TAIL_WIDTHS * wide;
    let half = axes.each_ref().map(|axis| axis.half_period());
    let wide_half: [usize; 3] = std::array::from_fn(|axis| {
        let period = reach[axis] + radius + TAIL_WIDTHS * wide;
        smooth_even((0.5 * period / axes[axis].spacing).ceil() as usize).max(half[axis])
    });
    let phase = |axis: usize, index: usize| PI * index as f64 / wide_half[axis] as f64;
    let tables: [AxisTables; 3] = std::array::from_fn(|axis| {
        let phases = (0..=wide_half[axis]).map(|index| phase(axis, index));
        AxisTables::new(axes[axis].spacing, order, widths, phases)
    });
    let mut dimensions = wide_half.map(|half| half + 1);
    let mut values = Vec::with_capacity(dimensions.iter().product());
    let at_origin = 0.5 * (wide * wide - sigma * sigma) + 0.5 * radius * radius;
    for x in 0..dimensions[0] {
        for y in 0..dimensions[1] {
            for z in 0..dimensions[2] {
                let at = [x, y, z];
                let wave = Vector3::from_fn(|axis, _| phase(axis, at[axis]) / axes[axis].spacing);
                let truncation = -(wave.norm() * radius).cos();
                values.push(kernel(&tables, at, truncation, at_origin));
            }
        }
    }
    let volume: f64 = axes.iter().map(|axis| axis.spacing).product();
    for axis in 0..3 {
        values = crop_axis(&values, &mut dimensions, axis, half[axis]);
        let normalised = axes[axis].transform.scale();
        for value in &mut values {
            *value /= normalised;
        }
    }
    for value in &mut values {
        *value *= 4.0 * PI / volume;
    }
    // Odd lines have no constant coefficient: their first wave is the second of the even kernel.
    let first = axes.each_ref().map(|axis| usize::from(axis.transform.wave_number(0) > 0.0));
    Influence::Table { dimensions, first, values }
}

/// Real-space kernel along one axis, kept up to displacement `keep` nodes, transformed again.
fn crop_axis(values: &[f64], dimensions: &mut [usize; 3], axis: usize, keep: usize) -> Vec<f64> {
    let mut planner = DctPlanner::new();
    let (whole, kept) = (dimensions[axis], keep + 1);
    let (to_space, to_waves) = (planner.plan_dct1(whole), planner.plan_dct1(kept));
    let stride: usize = dimensions[axis + 1..].iter().product();
    let blocks: usize = dimensions[..axis].iter().product();
    let mut cropped = vec![0.0; blocks * kept * stride];
    let mut line = vec![0.0; whole];
    // Both transforms halve their end terms: a full even sum is twice each, over the period 2(whole − 1).
    let scale = 4.0 / (2.0 * (whole - 1) as f64);
    for block in 0..blocks {
        for inner in 0..stride {
            for (index, value) in line.iter_mut().enumerate() {
                *value = values[(block * whole + index) * stride + inner];
            }
            to_space.process_dct1(&mut line);
            to_waves.process_dct1(&mut line[..kept]);
            for (index, value) in line[..kept].iter().enumerate() {
                cropped[(block * kept + index) * stride + inner] = value * scale;
            }
        }
    }
    dimensions[axis] = kept;
    cropped
}
