//! The influence function: what a coefficient of node charge contributes to the same coefficient of node
//! potential.
//!
//! G(k) = 4π χ(k)/(k² W²(k)),  W = Π_a W(k_a)
//!
//! with χ the cloud's spectrum and W the window's: spread and gathered by the window, every wave that the
//! grid carries comes out exactly as the cloud's potential 4π χ/k². For a window as tight as this one
//! nothing is gained by trading exactness for fewer aliases (at most 3 % of the error, against Hockney &
//! Eastwood's optimum), and fields that vary slowly are as good as the transforms.
//!
//! Open axes need a kernel of finite reach R. A wide Gaussian of width Σ carries the singularity at k = 0:
//! χ becomes χ + (T − 1) e^{−k²Σ²/2}, with T the transform of the truncated Green's function over that
//! of the whole one (Vico, Greengard & Ferrando, J. Comput. Phys. 323, 191, 2016):
//! T − 1 = −cos(kR) in free space; −e^{−k∥R}[cos κR − (κ/k∥) sin κR] between two closed axes, and
//! −cos κR − κR sin κR for k∥ = 0. Around a single closed axis it is that of `numerics::bessel`.

use super::axis::{GridAxis, TAIL_WIDTHS, smooth_even};
use super::window::Window;
use crate::numerics::bessel::{self, CutLine};
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use nalgebra::Vector3;
use rayon::prelude::*;
use rustdct::DctPlanner;
use std::f64::consts::PI;
use std::ops::Range;

/// Width of the singular part's Gaussian in node spacings: its spectrum is e^{−32} at the zone's edge.
const SINGULAR_WIDTH: f64 = 2.55;

/// Width Σ of the Gaussian that carries the singular part of a truncated kernel [m].
pub(crate) fn singular_width(spacings: [f64; 3], cloud: Cloud) -> f64 {
    let widest = spacings.into_iter().fold(0.0, f64::max);
    (SINGULAR_WIDTH * widest).max(cloud.mean_square().sqrt())
}

/// One axis' tables, by wave index.
#[derive(Clone, Debug)]
struct AxisWaves {
    /// k [1/m].
    wave: Vec<f64>,
    /// 1/W².
    per_window: Vec<f64>,
}

impl AxisWaves {
    /// Tables at wave numbers `phases/spacing`, phases in [0, π].
    fn new(spacing: f64, window: &Window, phases: impl Iterator<Item = f64> + Clone) -> Self {
        Self {
            wave: phases.clone().map(|phase| phase / spacing).collect(),
            per_window: phases.map(|phase| window.transform(phase).powi(-2)).collect(),
        }
    }

    /// Some of the waves.
    fn part(&self, rows: Range<usize>) -> Self {
        Self { wave: self.wave[rows.clone()].to_vec(), per_window: self.per_window[rows].to_vec() }
    }

    fn of(axis: &GridAxis, window: &Window) -> Self {
        let transform = &axis.transform;
        let phases = (0..transform.wave_count()).map(|index| transform.wave_number(index));
        Self::new(axis.spacing, window, phases)
    }
}

/// The influence function of a grid, with the transforms' scale and the cell volume divided out, by wave
/// index; for all waves or for some along y.
#[derive(Debug)]
pub(crate) struct Influence {
    dimensions: [usize; 3],
    /// Place of an axis' wave 0 in the whole table.
    first: [usize; 3],
    /// Rows of the whole table that are held.
    rows: Range<usize>,
    /// `[y][z][x]`.
    values: Vec<f64>,
}

impl Influence {
    /// Influence function of a cloud that a window spreads.
    pub(crate) fn new(axes: &[GridAxis; 3], window: &Window, cloud: Cloud) -> Self {
        Self::part(axes, window, cloud, all(axes))
    }

    /// Influence function of a cloud that a window spreads, for some of the coefficients along y.
    pub(crate) fn part(
        axes: &[GridAxis; 3],
        window: &Window,
        cloud: Cloud,
        coefficients: Range<usize>,
    ) -> Self {
        let wide = singular_width(axes.each_ref().map(|axis| axis.spacing), cloud);
        let mut open = (0..3).filter(|&axis| axes[axis].open);
        match (open.next(), open.next()) {
            (None, _) => {
                Self::closed(axes, window, coefficients, 0.0, |_, wave_squared| cloud.spectrum(wave_squared))
            }
            (Some(_), Some(_)) => cut_in_space(axes, window, cloud, wide, coefficients),
            (Some(open), None) => {
                let radius = axes[open].reach() + TAIL_WIDTHS * wide;
                let at_origin = 0.5 * (wide * wide - cloud.mean_square() - radius * radius);
                Self::closed(axes, window, coefficients, at_origin, |wave, wave_squared| {
                    truncated(cloud, wide, slab_truncation(wave, open, radius), wave_squared)
                })
            }
        }
    }

    /// Influence function of a cloud less a wider one: nothing is left beyond the wider one's end.
    pub(crate) fn between(axes: &[GridAxis; 3], window: &Window, cloud: Cloud, wider: Cloud) -> Self {
        let at_origin = 0.5 * (wider.mean_square() - cloud.mean_square());
        Self::closed(axes, window, all(axes), at_origin, |_, wave_squared| {
            cloud.spectrum(wave_squared) - wider.spectrum(wave_squared)
        })
    }

    /// Influence function that makes of charges the density of their clouds [C/m³] in place of a potential.
    pub(crate) fn density(axes: &[GridAxis; 3], window: &Window, cloud: Cloud) -> Self {
        Self::closed(axes, window, all(axes), 0.25 / PI, |_, wave_squared| {
            0.25 / PI * wave_squared * cloud.spectrum(wave_squared)
        })
    }

    /// Influence function 4π `spectrum`/(k² W²), 4π `at_origin` where k = 0.
    fn closed(
        axes: &[GridAxis; 3],
        window: &Window,
        coefficients: Range<usize>,
        at_origin: f64,
        spectrum: impl Fn(Vector3<f64>, f64) -> f64 + Sync,
    ) -> Self {
        let rows = rows(&axes[1], 0, coefficients);
        let mut waves = axes.each_ref().map(|axis| AxisWaves::of(axis, window));
        waves[1] = waves[1].part(rows.clone());
        let mut values = table(&waves, at_origin, |_, wave, squared| spectrum(wave, squared));
        let scale: f64 = axes.iter().map(|axis| axis.transform.scale() * axis.spacing).product();
        for value in &mut values {
            *value *= 4.0 * PI / scale;
        }
        Self { dimensions: waves.map(|axis| axis.wave.len()), first: [0; 3], rows, values }
    }

    /// Bytes held.
    pub(crate) fn memory_bytes(&self) -> usize {
        8 * self.values.len()
    }

    /// Multiplies a line of coefficients along x, at wave indices `y` and `z`.
    pub(crate) fn apply(&self, axes: &[GridAxis; 3], line: &mut [f64], y: usize, z: usize) {
        let [x_count, _, z_count] = self.dimensions;
        let start =
            ((y + self.first[1] - self.rows.start) * z_count + z + self.first[2]) * x_count + self.first[0];
        let values = &self.values[start..];
        for (coefficient, value) in line.iter_mut().enumerate() {
            *value *= values[axes[0].transform.wave_index(coefficient)];
        }
    }
}

/// All coefficients along y.
fn all(axes: &[GridAxis; 3]) -> Range<usize> {
    0..axes[1].transform.len()
}

/// Rows of a table for some coefficients along y, where wave 0 is row `first`.
fn rows(axis: &GridAxis, first: usize, coefficients: Range<usize>) -> Range<usize> {
    if coefficients.is_empty() {
        return 0..0;
    }
    let row = |coefficient| first + axis.transform.wave_index(coefficient);
    row(coefficients.start)..row(coefficients.end - 1) + 1
}

/// `spectrum`/(k² W²) at every wave vector (which is handed over with its indices and its square),
/// `at_origin` where k = 0; `[y][z][x]`.
fn table(
    waves: &[AxisWaves; 3],
    at_origin: f64,
    spectrum: impl Fn([usize; 3], Vector3<f64>, f64) -> f64 + Sync,
) -> Vec<f64> {
    let [x_count, y_count, z_count] = waves.each_ref().map(|axis| axis.wave.len());
    let mut values = vec![0.0; x_count * y_count * z_count];
    values.par_chunks_mut(x_count).enumerate().for_each(|(line, values)| {
        let (y, z) = (line / z_count, line % z_count);
        let per_window = waves[1].per_window[y] * waves[2].per_window[z];
        for (x, value) in values.iter_mut().enumerate() {
            let wave = Vector3::new(waves[0].wave[x], waves[1].wave[y], waves[2].wave[z]);
            let squared = wave.norm_squared();
            *value = if squared == 0.0 {
                at_origin
            } else {
                spectrum([x, y, z], wave, squared) * per_window * waves[0].per_window[x] / squared
            };
        }
    });
    values
}

/// χ + (T − 1) e^{−k²Σ²/2}.
fn truncated(cloud: Cloud, wide: f64, truncation: f64, wave_squared: f64) -> f64 {
    cloud.spectrum(wave_squared) + truncation * (-0.5 * wave_squared * wide * wide).exp()
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

/// Kernel of a box with two or three axes with an open face: cut at a cylinder or a sphere on a grid wide
/// enough for it, then cropped in real space to the displacements that occur.
fn cut_in_space(
    axes: &[GridAxis; 3],
    window: &Window,
    cloud: Cloud,
    wide: f64,
    coefficients: Range<usize>,
) -> Influence {
    let closed = axes.iter().position(|axis| !axis.open);
    let reach = Vector3::from_fn(|axis, _| if closed == Some(axis) { 0.0 } else { axes[axis].reach() });
    let radius = reach.norm() + TAIL_WIDTHS * wide;
    let half = axes.each_ref().map(|axis| axis.half_period());
    let waves: [AxisWaves; 3] = std::array::from_fn(|axis| {
        if closed == Some(axis) {
            return AxisWaves::of(&axes[axis], window);
        }
        let period = reach[axis] + radius + TAIL_WIDTHS * wide;
        let wide_half = smooth_even((0.5 * period / axes[axis].spacing).ceil() as usize).max(half[axis]);
        let phases = (0..=wide_half).map(|index| PI * index as f64 / wide_half as f64);
        AxisWaves::new(axes[axis].spacing, window, phases)
    });
    // Odd lines have no constant coefficient: their first wave is the second of the even kernel.
    let first: [usize; 3] = std::array::from_fn(|axis| {
        usize::from(closed != Some(axis) && axes[axis].transform.wave_number(0) > 0.0)
    });
    let rows = rows(&axes[1], first[1], coefficients);
    let kernel = |waves: &[AxisWaves; 3]| match closed {
        Some(closed) => around_axis(closed, &axes[closed], waves, cloud, wide, radius),
        None => {
            let at_origin = 0.5 * (wide * wide - cloud.mean_square() + radius * radius);
            table(waves, at_origin, |_, _, wave_squared| {
                let truncation = -(wave_squared.sqrt() * radius).cos();
                truncated(cloud, wide, truncation, wave_squared)
            })
        }
    };
    let mut dimensions = waves.each_ref().map(|axis| axis.wave.len());
    dimensions[1] = rows.len();
    let mut values = if closed == Some(1) {
        kernel(&[waves[0].clone(), waves[1].part(rows.clone()), waves[2].clone()])
    } else {
        cropped_rows(&waves, half[1], rows.clone(), kernel)
    };
    // In the order of the table: y, z, x.
    for axis in [1, 2, 0] {
        if axis != 1 && closed != Some(axis) {
            values = crop_axis(&values, &mut dimensions, axis, half[axis]);
        }
        let normalised = axes[axis].transform.scale();
        for value in &mut values {
            *value /= normalised;
        }
    }
    let volume: f64 = axes.iter().map(|axis| axis.spacing).product();
    for value in &mut values {
        *value *= 4.0 * PI / volume;
    }
    Influence { dimensions, first, rows, values }
}

/// Some rows of a kernel that is cropped to the displacements along y that occur, `keep` nodes. Where they
/// are few, the kernel is computed in pieces of z, and never held as a whole.
fn cropped_rows(
    waves: &[AxisWaves; 3],
    keep: usize,
    rows: Range<usize>,
    kernel: impl Fn(&[AxisWaves; 3]) -> Vec<f64>,
) -> Vec<f64> {
    /// Waves along z that are computed at a time.
    const PIECE: usize = 16;
    let [x_count, y_count, z_count] = waves.each_ref().map(|axis| axis.wave.len());
    let piece = if rows.len() >= keep { z_count } else { PIECE };
    let mut values = vec![0.0; rows.len() * z_count * x_count];
    for start in (0..z_count).step_by(piece) {
        let part = start..z_count.min(start + piece);
        let mut dimensions = [x_count, y_count, part.len()];
        let whole = kernel(&[waves[0].clone(), waves[1].clone(), waves[2].part(part.clone())]);
        let cropped = crop_axis(&whole, &mut dimensions, 1, keep);
        let length = part.len() * x_count;
        for (to, from) in rows.clone().enumerate() {
            values[(to * z_count + start) * x_count..][..length]
                .copy_from_slice(&cropped[from * length..][..length]);
        }
    }
    values
}

/// Spectrum over k² of the kernel around the only closed axis, cut at a radius; `[y][z][x]`.
fn around_axis(
    closed: usize,
    axis: &GridAxis,
    waves: &[AxisWaves; 3],
    cloud: Cloud,
    wide: f64,
    radius: f64,
) -> Vec<f64> {
    let length = axis.nodes as f64 * axis.spacing;
    let lines: Vec<CutLine> =
        waves[closed].wave.iter().map(|&wave| CutLine::new(wave, radius, length)).collect();
    let [a, b] = [(closed + 1) % 3, (closed + 2) % 3];
    let of_b = &waves[b].wave;
    let across: Vec<[f64; 2]> = waves[a]
        .wave
        .par_iter()
        .flat_map_iter(|in_a| of_b.iter().map(move |in_b| bessel::waves(in_a.hypot(*in_b) * radius)))
        .collect();
    let at_origin = 0.5 * (wide * wide - cloud.mean_square()) + CutLine::new(0.0, radius, length).at_origin();
    table(waves, at_origin, |at, _, wave_squared| {
        let change = lines[at[closed]].change(across[at[a] * of_b.len() + at[b]]);
        truncated(cloud, wide, change, wave_squared)
    })
}

/// Real-space kernel along one axis, kept up to displacement `keep` nodes, transformed again.
fn crop_axis(values: &[f64], dimensions: &mut [usize; 3], axis: usize, keep: usize) -> Vec<f64> {
    let mut planner = DctPlanner::new();
    let (whole, kept) = (dimensions[axis], keep + 1);
    let (to_space, to_waves) = (planner.plan_dct1(whole), planner.plan_dct1(kept));
    let [x, y, z] = *dimensions;
    let (blocks, stride) = [(y * z, 1), (1, z * x), (y, x)][axis];
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
