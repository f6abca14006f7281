//! The near kernel: a point charge's field less its cloud's, summed over a run of sources.
//!
//! E = Σ q r⃗ [1/r³ − S(r²)],  V = Σ q [1/r − P(r²)], with the cloud's S and P (see
//! `amberfield_laws::gaussian_cloud`). Both are entire functions of r², so one polynomial each covers
//! [0, r_c²] to any accuracy, with no table and no trouble at r ≪ r_c.
//!
//! Partners are gathered first (see [`super::partners`]): the arithmetic then runs on full vectors.

use super::instructions::Instructions;
use super::partners::{LANES, Partners};
use amberfield_laws::gaussian_cloud::{cloud_field_over_r, cloud_potential};
use std::f64::consts::PI;

/// Polynomial degrees for which the loop is unrolled.
const DEGREES: [usize; 6] = [6, 10, 14, 18, 24, 32];

/// Field and potential of a target (4πε = 1), summed lane by lane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sum {
    lanes: [[f64; LANES]; 4],
}

impl Sum {
    pub(crate) fn field(&self) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.lanes[axis].iter().sum())
    }

    pub(crate) fn potential(&self) -> f64 {
        self.lanes[3].iter().sum()
    }
}

/// Polynomials of the cloud in y = 2r²/r_c² − 1, lowest degree first.
#[derive(Clone, Debug)]
pub(crate) struct NearKernel {
    cutoff_squared: f64,
    field: Vec<f64>,
    potential: Vec<f64>,
    instructions: Instructions,
}

impl NearKernel {
    /// Kernel for clouds of width `sigma` and cut-off `cutoff` [m], the polynomials good to `accuracy` of
    /// the cloud's value at its centre.
    pub(crate) fn new(sigma: f64, cutoff: f64, accuracy: f64) -> Self {
        let field = chebyshev(|r| cloud_field_over_r(r, sigma), cutoff);
        let potential = chebyshev(|r| cloud_potential(r, sigma), cutoff);
        let fits = |series: &[f64], degree: usize| {
            let left_out: f64 = series[degree + 1..].iter().map(|c| c.abs()).sum();
            left_out <= accuracy * series.iter().map(|c| c.abs()).sum::<f64>()
        };
        let degree = DEGREES
            .into_iter()
            .find(|&degree| fits(&field, degree) && fits(&potential, degree))
            .unwrap_or(DEGREES[DEGREES.len() - 1]);
        Self {
            cutoff_squared: cutoff * cutoff,
            field: monomials(&field[..=degree]),
            potential: monomials(&potential[..=degree]),
            instructions: Instructions::detect(),
        }
    }

    /// Squared cut-off radius [m²].
    pub(crate) fn cutoff_squared(&self) -> f64 {
        self.cutoff_squared
    }

    /// Adds the gathered partners to a sum and forgets them.
    #[inline]
    pub(crate) fn add<const POTENTIAL: bool>(&self, partners: &mut Partners, sum: &mut Sum) {
        partners.fill_last_lanes(self.cutoff_squared.sqrt());
        match self.field.len() - 1 {
            6 => self.dispatch::<7, POTENTIAL>(partners, sum),
            10 => self.dispatch::<11, POTENTIAL>(partners, sum),
            14 => self.dispatch::<15, POTENTIAL>(partners, sum),
            18 => self.dispatch::<19, POTENTIAL>(partners, sum),
            24 => self.dispatch::<25, POTENTIAL>(partners, sum),
            _ => self.dispatch::<33, POTENTIAL>(partners, sum),
        }
        partners.clear();
    }

    #[inline(always)]
    fn dispatch<const N: usize, const POTENTIAL: bool>(&self, partners: &Partners, sum: &mut Sum) {
        match self.instructions {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `detect` found the instructions on this processor.
            Instructions::Avx512 => unsafe { add_avx512::<N, POTENTIAL>(self, partners, sum) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Instructions::Avx2 => unsafe { add_avx2::<N, POTENTIAL>(self, partners, sum) },
            Instructions::Portable => add_lanes::<N, POTENTIAL, false>(self, partners, sum),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,fma")]
fn add_avx512<const N: usize, const POTENTIAL: bool>(
    kernel: &NearKernel,
    partners: &Partners,
    sum: &mut Sum,
) {
    add_lanes::<N, POTENTIAL, true>(kernel, partners, sum);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn add_avx2<const N: usize, const POTENTIAL: bool>(kernel: &NearKernel, partners: &Partners, sum: &mut Sum) {
    add_lanes::<N, POTENTIAL, true>(kernel, partners, sum);
}

/// a·b + c, fused where the instructions have it (elsewhere `mul_add` would call a function).
#[inline(always)]
fn fused<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

#[inline(always)]
fn add_lanes<const N: usize, const POTENTIAL: bool, const FUSED: bool>(
    kernel: &NearKernel,
    partners: &Partners,
    sum: &mut Sum,
) {
    let field: &[f64; N] = kernel.field[..].try_into().expect("N coefficients");
    let potential: &[f64; N] = kernel.potential[..].try_into().expect("N coefficients");
    let scale = 2.0 / kernel.cutoff_squared;
    let mut total = sum.lanes;
    for block in partners.blocks() {
        // One loop over the lanes for each operation: what the compiler turns into vectors.
        let [x, y, z, q] = block;
        let r2 = each(|lane| {
            let yz = fused::<FUSED>(y[lane], y[lane], z[lane] * z[lane]);
            fused::<FUSED>(x[lane], x[lane], yz)
        });
        let inverse = each(|lane| 1.0 / r2[lane].sqrt());
        let argument = each(|lane| fused::<FUSED>(r2[lane], scale, -1.0));
        let cloud = horner::<N, FUSED>(field, &argument);
        let weight = each(|lane| q[lane] * (inverse[lane] * inverse[lane] * inverse[lane] - cloud[lane]));
        for (total, d) in total.iter_mut().zip([x, y, z]) {
            *total = each(|lane| fused::<FUSED>(weight[lane], d[lane], total[lane]));
        }
        if POTENTIAL {
            let cloud = horner::<N, FUSED>(potential, &argument);
            total[3] = each(|lane| fused::<FUSED>(q[lane], inverse[lane] - cloud[lane], total[3][lane]));
        }
    }
    sum.lanes = total;
}

/// One value per lane.
#[inline(always)]
fn each(value: impl Fn(usize) -> f64) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    for (lane, slot) in lanes.iter_mut().enumerate() {
        *slot = value(lane);
    }
    lanes
}

/// Polynomial in every lane, highest power last in `coefficients`.
#[inline(always)]
fn horner<const N: usize, const FUSED: bool>(
    coefficients: &[f64; N],
    argument: &[f64; LANES],
) -> [f64; LANES] {
    let mut value = [coefficients[N - 1]; LANES];
    for power in (0..N - 1).rev() {
        value = each(|lane| fused::<FUSED>(value[lane], argument[lane], coefficients[power]));
    }
    value
}

/// Chebyshev coefficients of a function of r², in y = 2r²/cutoff² − 1, to twice the highest degree used.
fn chebyshev(function: impl Fn(f64) -> f64, cutoff: f64) -> Vec<f64> {
    let count = 2 * DEGREES[DEGREES.len() - 1];
    let angle = |node: usize| PI * (node as f64 + 0.5) / count as f64;
    let samples: Vec<f64> =
        (0..count).map(|node| function(cutoff * (0.5 * (1.0 + angle(node).cos())).sqrt())).collect();
    let coefficient = |degree: usize| {
        let sum: f64 =
            samples.iter().enumerate().map(|(node, value)| value * (degree as f64 * angle(node)).cos()).sum();
        sum * if degree == 0 { 1.0 } else { 2.0 } / count as f64
    };
    (0..count).map(coefficient).collect()
}

/// Power-series coefficients of a Chebyshev series.
fn monomials(series: &[f64]) -> Vec<f64> {
    let mut result = vec![0.0; series.len()];
    let (mut before, mut current) = (vec![0.0; series.len()], vec![0.0; series.len()]);
    before[0] = 1.0;
    if series.len() > 1 {
        current[1] = 1.0;
    }
    for (degree, coefficient) in series.iter().enumerate() {
        let polynomial = if degree == 0 { &before } else { &current };
        for (sum, term) in result.iter_mut().zip(polynomial) {
            *sum += coefficient * term;
        }
        if degree > 0 {
            let mut next: Vec<f64> = before.iter().map(|term| -term).collect();
            for power in 1..series.len() {
                next[power] += 2.0 * current[power - 1];
            }
            before = std::mem::replace(&mut current, next);
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::near::partners::{Gather, PADDING, Sources, Target};
    use amberfield_laws::gaussian_cloud::{near_field_over_r, near_potential};

    /// Deterministic scatter of sources around the origin, some beyond the cut-off, padded with ones that must
    /// not count; source `OWN` is the target.
    fn sources(count: usize) -> [Vec<f64>; 4] {
        let value = |i: usize, k: f64| if i < count { 1.3 * (i as f64 * k + 0.3).sin() } else { 0.1 };
        [0.917, 1.731, 2.331, 3.177].map(|k| (0..count + PADDING).map(|i| value(i, k)).collect())
    }

    const COUNT: usize = 203;
    const OWN: usize = 50;

    fn sum_of(kernel: &NearKernel, arrays: &[Vec<f64>; 4]) -> Sum {
        let view = Sources { x: &arrays[0], y: &arrays[1], z: &arrays[2], charge: &arrays[3] };
        let target = Target { position: [0.0; 3], own: OWN };
        let (mut partners, mut sum) = (Partners::default(), Sum::default());
        let gather = Gather::new(kernel.cutoff_squared, kernel.instructions);
        for run in [0..31, 31..COUNT] {
            gather
                .append(target, view, run, &mut partners, |partners| kernel.add::<true>(partners, &mut sum));
        }
        kernel.add::<true>(&mut partners, &mut sum);
        sum
    }

    fn exact(sigma: f64, cutoff: f64, sources: &[Vec<f64>; 4]) -> ([f64; 3], f64) {
        let (mut field, mut potential) = ([0.0; 3], 0.0);
        for i in (0..COUNT).filter(|&i| i != OWN) {
            let d = [0, 1, 2].map(|axis| -sources[axis][i]);
            let r = d.iter().map(|c| c * c).sum::<f64>().sqrt();
            if r < cutoff {
                for (sum, d) in field.iter_mut().zip(d) {
                    *sum += sources[3][i] * d * near_field_over_r(r, sigma);
                }
                potential += sources[3][i] * near_potential(r, sigma);
            }
        }
        (field, potential)
    }

    #[test]
    fn polynomials_meet_the_closed_form() {
        let sources = sources(COUNT);
        for (sigma, cutoff, accuracy) in
            [(0.4, 1.2, 1e-4), (0.3, 1.2, 1e-7), (0.25, 1.25, 1e-10), (0.2, 1.25, 1e-12), (5.0, 1.2, 1e-13)]
        {
            let sum = sum_of(&NearKernel::new(sigma, cutoff, accuracy), &sources);
            let (field, potential) = exact(sigma, cutoff, &sources);
            let scale = cloud_potential(0.0, sigma) * COUNT as f64;
            assert!((sum.potential() - potential).abs() < (accuracy + 1e-13) * scale);
            let scale = cloud_field_over_r(0.0, sigma) * COUNT as f64 * cutoff;
            for (computed, expected) in sum.field().into_iter().zip(field) {
                assert!((computed - expected).abs() < (accuracy + 1e-13) * scale);
            }
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_sum() {
        let sources = sources(COUNT);
        let mut kernel = NearKernel::new(0.3, 1.2, 1e-9);
        let native = sum_of(&kernel, &sources);
        kernel.instructions = Instructions::Portable;
        let portable = sum_of(&kernel, &sources);
        // Fused and unfused arithmetic differ by round-off only.
        assert!((native.potential() - portable.potential()).abs() < 1e-11);
        for (native, portable) in native.field().into_iter().zip(portable.field()) {
            assert!((native - portable).abs() < 1e-10);
        }
    }
}
