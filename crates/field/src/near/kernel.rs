//! The near kernel: a point charge's field less its cloud's, summed over a run of sources.
//!
//! E = Σ q r⃗ [1/r³ − S(r²)],  V = Σ q [1/r − P(r²)], with the cloud's S and P (see
//! `amberfield_laws::gaussian_cloud`). Both are entire functions of r², so one polynomial each covers
//! [0, r_c²] to any accuracy, with no table and no trouble at r ≪ r_c.

use amberfield_laws::gaussian_cloud::{cloud_field_over_r, cloud_potential};
use std::f64::consts::PI;
use std::ops::Range;

/// Sources handled together.
const LANES: usize = 8;
/// Polynomial degrees for which the loop is unrolled.
const DEGREES: [usize; 6] = [6, 10, 14, 18, 24, 32];

/// Sources in separate arrays, with [`PADDING`] more values behind the last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sources<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) z: &'a [f64],
    pub(crate) charge: &'a [f64],
}

/// Values that arrays of sources hold behind the last one, so that the last ones can be read as whole lanes.
pub(crate) const PADDING: usize = LANES;

/// What a sum is taken at: a place, and the index of the source that is the target itself.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Target {
    pub(crate) position: [f64; 3],
    pub(crate) own: usize,
}

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

/// Vector instructions found when the kernel was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Instructions {
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    Portable,
}

impl Instructions {
    fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            if std::arch::is_x86_feature_detected!("avx512f") && std::arch::is_x86_feature_detected!("fma") {
                return Self::Avx512;
            }
            if std::arch::is_x86_feature_detected!("avx2") && std::arch::is_x86_feature_detected!("fma") {
                return Self::Avx2;
            }
        }
        Self::Portable
    }
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

    /// Adds the sources of a run to the target's sum, the target itself excepted.
    #[inline]
    pub(crate) fn add<const POTENTIAL: bool>(
        &self,
        target: Target,
        sources: Sources<'_>,
        run: Range<usize>,
        sum: &mut Sum,
    ) {
        match self.field.len() - 1 {
            6 => self.dispatch::<7, POTENTIAL>(target, sources, run, sum),
            10 => self.dispatch::<11, POTENTIAL>(target, sources, run, sum),
            14 => self.dispatch::<15, POTENTIAL>(target, sources, run, sum),
            18 => self.dispatch::<19, POTENTIAL>(target, sources, run, sum),
            24 => self.dispatch::<25, POTENTIAL>(target, sources, run, sum),
            _ => self.dispatch::<33, POTENTIAL>(target, sources, run, sum),
        }
    }

    #[inline(always)]
    fn dispatch<const N: usize, const POTENTIAL: bool>(
        &self,
        target: Target,
        sources: Sources<'_>,
        run: Range<usize>,
        sum: &mut Sum,
    ) {
        match self.instructions {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `detect` found the instructions on this processor.
            Instructions::Avx512 => unsafe { add_avx512::<N, POTENTIAL>(self, target, sources, run, sum) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Instructions::Avx2 => unsafe { add_avx2::<N, POTENTIAL>(self, target, sources, run, sum) },
            Instructions::Portable => add_lanes::<N, POTENTIAL, false>(self, target, sources, run, sum),
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,avx512vl,avx512dq,fma")]
fn add_avx512<const N: usize, const POTENTIAL: bool>(
    kernel: &NearKernel,
    target: Target,
    sources: Sources<'_>,
    run: Range<usize>,
    sum: &mut Sum,
) {
    add_lanes::<N, POTENTIAL, true>(kernel, target, sources, run, sum);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn add_avx2<const N: usize, const POTENTIAL: bool>(
    kernel: &NearKernel,
    target: Target,
    sources: Sources<'_>,
    run: Range<usize>,
    sum: &mut Sum,
) {
    add_lanes::<N, POTENTIAL, true>(kernel, target, sources, run, sum);
}

/// a·b + c, fused where the instructions have it (elsewhere `mul_add` would call a function).
#[inline(always)]
fn fused<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

#[inline(always)]
fn add_lanes<const N: usize, const POTENTIAL: bool, const FUSED: bool>(
    kernel: &NearKernel,
    target: Target,
    sources: Sources<'_>,
    run: Range<usize>,
    sum: &mut Sum,
) {
    let field: &[f64; N] = kernel.field[..].try_into().expect("N coefficients");
    let potential: &[f64; N] = kernel.potential[..].try_into().expect("N coefficients");
    let mut lanes = sum.lanes;
    for start in run.clone().step_by(LANES) {
        let block = [sources.x, sources.y, sources.z, sources.charge].map(|array| whole_lanes(array, start));
        // Lanes past the run's end and the target itself lie nowhere.
        let excluded = each(|lane| {
            let source = start + lane;
            if source < run.end && source != target.own { 0.0 } else { f64::INFINITY }
        });
        add_block::<N, POTENTIAL, FUSED>(
            (field, potential),
            kernel.cutoff_squared,
            target.position,
            block,
            excluded,
            &mut lanes,
        );
    }
    sum.lanes = lanes;
}

/// One loop over the lanes for each operation: what the compiler turns into vectors. Always inlined, or the
/// caller's instructions would not reach it.
#[inline(always)]
fn add_block<const N: usize, const POTENTIAL: bool, const FUSED: bool>(
    (field, potential): (&[f64; N], &[f64; N]),
    cutoff_squared: f64,
    target: [f64; 3],
    [x, y, z, q]: [&[f64; LANES]; 4],
    excluded: [f64; LANES],
    total: &mut [[f64; LANES]; 4],
) {
    let scale = 2.0 / cutoff_squared;
    let d = [
        each(|lane| target[0] - x[lane]),
        each(|lane| target[1] - y[lane]),
        each(|lane| target[2] - z[lane]),
    ];
    let r2 = each(|lane| {
        let yz = fused::<FUSED>(d[1][lane], d[1][lane], d[2][lane] * d[2][lane]);
        fused::<FUSED>(d[0][lane], d[0][lane], yz) + excluded[lane]
    });
    let inverse = each(|lane| 1.0 / r2[lane].sqrt());
    let argument = each(|lane| fused::<FUSED>(r2[lane], scale, -1.0));
    let cloud = horner::<N, FUSED>(field, &argument);
    let weight = each(|lane| {
        let over_r = inverse[lane] * inverse[lane] * inverse[lane] - cloud[lane];
        if r2[lane] < cutoff_squared { q[lane] * over_r } else { 0.0 }
    });
    for axis in 0..3 {
        total[axis] = each(|lane| fused::<FUSED>(weight[lane], d[axis][lane], total[axis][lane]));
    }
    if POTENTIAL {
        let cloud = horner::<N, FUSED>(potential, &argument);
        total[3] = each(|lane| {
            let value = q[lane] * (inverse[lane] - cloud[lane]);
            total[3][lane] + if r2[lane] < cutoff_squared { value } else { 0.0 }
        });
    }
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

#[inline(always)]
fn whole_lanes(values: &[f64], start: usize) -> &[f64; LANES] {
    values[start..start + LANES].try_into().expect("arrays of sources are padded")
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
        let mut sum = Sum::default();
        kernel.add::<true>(target, view, 0..31, &mut sum);
        kernel.add::<true>(target, view, 31..COUNT, &mut sum);
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
