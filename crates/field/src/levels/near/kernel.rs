//! The near kernel: a point charge's field less its cloud's, summed over candidates.
//!
//! E = Σ q r⃗ [1/r³ − S(r²)],  V = Σ q [1/r − P(r²)], with the cloud's S and P (see
//! `amberfield_laws::kaiser_bessel_cloud`). Both are entire functions of r², so one polynomial each covers
//! [0, r_c²] to any accuracy, with no table and no trouble at r ≪ r_c.
//!
//! The candidates of a group of targets are laid side by side, and those beyond the cut-off of the group's
//! box are dropped. Every one left is computed, masked beyond the cut-off: that costs less than packing the
//! ones that count for a single target.

use super::candidates::NearSources;
use super::cells::NearCells;
use super::target::{NearSum, sum_one, sum_two};
use crate::numerics::chebyshev::{chebyshev, monomials};
use crate::numerics::processor::{Instructions, Real, Vector};
use amberfield_laws::kaiser_bessel_cloud::Cloud;

/// Polynomial degrees for which the loop is unrolled.
const DEGREES: [usize; 8] = [5, 7, 9, 11, 14, 18, 24, 32];

/// Polynomials of the cloud in y = 2r²/r_c² − 1, lowest degree first, in units of r_c.
#[derive(Clone, Debug)]
pub(crate) struct NearKernel<T> {
    field: Vec<T>,
    potential: Vec<T>,
    instructions: Instructions,
}

impl<T: Real> NearKernel<T> {
    /// Kernel for clouds of the given shape that end at the cut-off radius, the polynomials good to
    /// `accuracy` of the cloud's value at its centre.
    pub(crate) fn new(cloud_shape: f64, accuracy: f64) -> Self {
        let highest = DEGREES[DEGREES.len() - 1];
        let cloud = Cloud { radius: 1.0, shape: cloud_shape };
        let radius = |y: f64| (0.5 * (1.0 + y)).sqrt();
        let field = chebyshev(|y| cloud.field_over_r(radius(y)), 2 * highest);
        let potential = chebyshev(|y| cloud.potential(radius(y)), 2 * highest);
        let fits = |series: &[f64], degree: usize| {
            let left_out: f64 = series[degree + 1..].iter().map(|c| c.abs()).sum();
            left_out <= accuracy * series.iter().map(|c| c.abs()).sum::<f64>()
        };
        let degree = DEGREES
            .into_iter()
            .find(|&degree| fits(&field, degree) && fits(&potential, degree))
            .unwrap_or(highest);
        let narrow = |series: &[f64]| monomials(&series[..=degree]).into_iter().map(T::narrow).collect();
        Self { field: narrow(&field), potential: narrow(&potential), instructions: Instructions::detect() }
    }

    /// The kernel for other instructions.
    #[cfg(test)]
    pub(crate) fn with_instructions(self, instructions: Instructions) -> Self {
        Self { instructions, ..self }
    }
}

/// Targets that share their candidates: sources of one row of cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Group<'a> {
    pub(crate) cells: &'a NearCells,
    pub(crate) targets: &'a [u32],
    pub(crate) row: [usize; 2],
}

impl<T: Real> NearKernel<T> {
    /// Sums over the sources within the cut-off at every target of a group, each left out at its own place.
    pub(crate) fn sum(
        &self,
        group: Group<'_>,
        potential: bool,
        candidates: &mut NearSources<T>,
        sums: &mut [NearSum],
    ) {
        match self.field.len() {
            6 => self.unrolled::<6>(group, potential, candidates, sums),
            8 => self.unrolled::<8>(group, potential, candidates, sums),
            10 => self.unrolled::<10>(group, potential, candidates, sums),
            12 => self.unrolled::<12>(group, potential, candidates, sums),
            15 => self.unrolled::<15>(group, potential, candidates, sums),
            19 => self.unrolled::<19>(group, potential, candidates, sums),
            25 => self.unrolled::<25>(group, potential, candidates, sums),
            _ => self.unrolled::<33>(group, potential, candidates, sums),
        }
    }

    /// The sums with polynomials of `N` coefficients.
    fn unrolled<const N: usize>(
        &self,
        group: Group<'_>,
        potential: bool,
        candidates: &mut NearSources<T>,
        sums: &mut [NearSum],
    ) {
        if potential {
            self.dispatched::<N, true>(group, candidates, sums);
        } else {
            self.dispatched::<N, false>(group, candidates, sums);
        }
    }

    /// The sums by the instructions of this processor.
    fn dispatched<const N: usize, const POTENTIAL: bool>(
        &self,
        group: Group<'_>,
        candidates: &mut NearSources<T>,
        sums: &mut [NearSum],
    ) {
        match self.instructions {
            #[cfg(target_arch = "x86_64")]
            // SAFETY: `detect` found the instructions on this processor.
            Instructions::Avx512 => unsafe { avx512::<T, N, POTENTIAL>(self, group, candidates, sums) },
            #[cfg(target_arch = "x86_64")]
            // SAFETY: as above.
            Instructions::Avx2 => unsafe { avx2::<T, N, POTENTIAL>(self, group, candidates, sums) },
            Instructions::Portable => {
                sum_group::<T::Portable, N, POTENTIAL>(self, group, candidates, sums);
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx512f,fma")]
fn avx512<T: Real, const N: usize, const POTENTIAL: bool>(
    kernel: &NearKernel<T>,
    group: Group<'_>,
    candidates: &mut NearSources<T>,
    sums: &mut [NearSum],
) {
    sum_group::<T::Avx512, N, POTENTIAL>(kernel, group, candidates, sums);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn avx2<T: Real, const N: usize, const POTENTIAL: bool>(
    kernel: &NearKernel<T>,
    group: Group<'_>,
    candidates: &mut NearSources<T>,
    sums: &mut [NearSum],
) {
    sum_group::<T::Avx2, N, POTENTIAL>(kernel, group, candidates, sums);
}

#[inline(always)]
fn sum_group<V: Vector, const N: usize, const POTENTIAL: bool>(
    kernel: &NearKernel<V::Number>,
    group: Group<'_>,
    candidates: &mut NearSources<V::Number>,
    sums: &mut [NearSum],
) {
    let field: &[V::Number; N] = kernel.field[..].try_into().expect("N coefficients");
    let potential: &[V::Number; N] = kernel.potential[..].try_into().expect("N coefficients");
    let (shift, reference) = gather::<V>(group, candidates);
    let place = |target: u32| {
        let charged = V::Number::narrow(group.cells.charge(target as usize)) != V::Number::narrow(0.0);
        let before = (target as usize).wrapping_add(shift);
        let own = if charged { candidates.number::<V>(before) } else { candidates.len() };
        (relative(group.cells, target, reference), own)
    };
    let polynomials = (field, potential);
    for (targets, sums) in group.targets.chunks(2).zip(sums.chunks_mut(2)) {
        match (targets, sums) {
            (&[first, second], [first_sum, second_sum]) => {
                let places = [place(first), place(second)];
                [*first_sum, *second_sum] = sum_two::<V, N, POTENTIAL>(polynomials, candidates, places);
            }
            (&[only], [sum, ..]) => *sum = sum_one::<V, N, POTENTIAL>(polynomials, candidates, place(only)),
            _ => {}
        }
    }
}

/// A source's place as the candidates have theirs.
#[inline(always)]
fn relative<T: Real>(cells: &NearCells, source: u32, reference: [f64; 3]) -> [T; 3] {
    let [x, y, z] = cells.place(source as usize);
    [T::narrow(x - reference[0]), T::narrow(y - reference[1]), T::narrow(z - reference[2])]
}

/// Lays the sources around a group side by side and drops those beyond the cut-off of all; before that, a
/// target's number among them was its number plus what is returned. Their places are relative to the other
/// result.
#[inline(always)]
fn gather<V: Vector>(group: Group<'_>, candidates: &mut NearSources<V::Number>) -> (usize, [f64; 3]) {
    let cells = group.cells;
    let first = group.targets[0] as usize;
    let mut range = [cells.place(first)[0]; 2];
    for &target in group.targets {
        let x = cells.place(target as usize)[0];
        range = [range[0].min(x), range[1].max(x)];
    }
    let (reference, sources) = (cells.place(first), cells.sources());
    let mut shift = 0;
    candidates.clear();
    for row in cells.rows() {
        let run = cells.run(row, group.row, range);
        if run.contains(&first) {
            shift = candidates.len().wrapping_sub(run.start);
        }
        candidates.append::<V>(sources, run, reference);
    }
    candidates.finish();
    candidates.cull::<V>(bounds(group, reference));
    (shift, reference)
}

/// Lowest and highest coordinates of the targets, as the candidates have theirs.
#[inline(always)]
fn bounds<T: Real>(group: Group<'_>, reference: [f64; 3]) -> [[T; 3]; 2] {
    let place = |target: u32| relative::<T>(group.cells, target, reference);
    let [mut low, mut high] = [place(group.targets[0]); 2];
    for &target in &group.targets[1..] {
        let place = place(target);
        for axis in 0..3 {
            low[axis] = if place[axis] < low[axis] { place[axis] } else { low[axis] };
            high[axis] = if place[axis] > high[axis] { place[axis] } else { high[axis] };
        }
    }
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::images::ImageLattice;
    use crate::levels::near::cells::Charges;
    use amberfield_core::{Boundary, Domain};
    use nalgebra::Vector3;

    /// A term of the sum is good to this many units in the last place of the point charge's term.
    const UNITS: f64 = 8.0;
    const COUNT: usize = 203;
    const CUTOFF: f64 = 1.2;

    struct Scatter {
        positions: Vec<Vector3<f64>>,
        charges: Vec<f64>,
        cells: NearCells,
    }

    fn scatter() -> Scatter {
        let value = |i: usize, k: f64| 1.3 * (i as f64 * k + 0.3).sin();
        let positions: Vec<_> =
            (0..COUNT).map(|i| Vector3::new(value(i, 0.917), value(i, 1.731), value(i, 2.331))).collect();
        let charges: Vec<f64> = (0..COUNT).map(|i| value(i, 3.177) / 1.3).collect();
        let domain =
            Domain::new(Vector3::repeat(-2.0), Vector3::repeat(2.0), [[Boundary::Open; 2]; 3]).unwrap();
        let mut cells = NearCells::default();
        cells.build(
            &domain,
            &ImageLattice::new(&domain),
            Charges { positions: &positions, charges: &charges, targets: COUNT },
            CUTOFF,
            1.0,
        );
        Scatter { positions, charges, cells }
    }

    /// The sum at every source, in the kernel's units; sources of a row in groups of at most five.
    fn sums<T: Real>(kernel: &NearKernel<T>, scatter: &Scatter) -> Vec<NearSum> {
        let mut candidates = NearSources::default();
        let mut sums = vec![NearSum::default(); COUNT];
        let sources: Vec<u32> = (0..COUNT as u32).collect();
        let row = |source: u32| scatter.cells.row_of(source as usize);
        for together in sources.chunk_by(|&a, &b| row(a) == row(b)) {
            for targets in together.chunks(5) {
                let group = Group { cells: &scatter.cells, targets, row: row(targets[0]) };
                let first = targets[0] as usize;
                kernel.sum(group, true, &mut candidates, &mut sums[first..first + targets.len()]);
            }
        }
        sums
    }

    /// The scalar twin: field, potential, and the sums of the sizes of their point charges' terms.
    fn exact(shape: f64, scatter: &Scatter, target: usize) -> ([f64; 4], [f64; 2]) {
        let cloud = Cloud { radius: 1.0, shape };
        let (mut sum, mut size) = ([0.0; 4], [0.0; 2]);
        for source in (0..COUNT).filter(|&source| source != target) {
            let d = (scatter.positions[target] - scatter.positions[source]) / CUTOFF;
            let (r, q) = (d.norm(), scatter.charges[source]);
            if r < 1.0 {
                for axis in 0..3 {
                    sum[axis] += q * d[axis] * cloud.near_field_over_r(r);
                }
                sum[3] += q * cloud.near_potential(r);
                size[0] += q.abs() / (r * r);
                size[1] += q.abs() / r;
            }
        }
        (sum, size)
    }

    fn check<T: Real>(shape: f64, accuracy: f64, instructions: Instructions) {
        let (scatter, cloud) = (scatter(), Cloud { radius: 1.0, shape });
        let kernel = NearKernel::<T>::new(shape, accuracy).with_instructions(instructions);
        let round_off = UNITS * if T::DOUBLE { f64::EPSILON } else { f64::from(f32::EPSILON) };
        for (source, sum) in sums(&kernel, &scatter).iter().enumerate() {
            let (exact, size) = exact(shape, &scatter, scatter.cells.real[source] as usize);
            // Coordinates are rounded too: that counts by the inverse of the distance to the nearest.
            let rounding = round_off * (1.0 + 1.0 / sum.nearest_squared.sqrt());
            let polynomials = accuracy * COUNT as f64;
            for (value, expected) in sum.field.into_iter().zip(exact) {
                let bound = rounding * size[0] + polynomials * cloud.field_over_r(0.0);
                assert!((value - expected).abs() < bound, "{instructions:?}: {value} for {expected}");
            }
            let bound = rounding * size[1] + polynomials * cloud.potential(0.0);
            assert!(
                (sum.potential - exact[3]).abs() < bound,
                "{instructions:?}: potential {}",
                sum.potential
            );
        }
    }

    #[test]
    fn every_instruction_set_meets_the_scalar_twin_in_both_precisions() {
        let all = [
            #[cfg(target_arch = "x86_64")]
            Instructions::Avx2,
            Instructions::Portable,
            Instructions::detect(),
        ];
        let known = |instructions| {
            instructions == Instructions::Portable || Instructions::detect() != Instructions::Portable
        };
        for instructions in all.into_iter().filter(|&instructions| known(instructions)) {
            for (shape, accuracy) in [(5.0, 1e-3), (7.0, 1e-5), (10.0, 1e-6)] {
                check::<f32>(shape, accuracy, instructions);
            }
            for (shape, accuracy) in [(5.0, 1e-4), (10.0, 1e-7), (14.0, 1e-10), (19.0, 1e-12), (1.0, 1e-13)] {
                check::<f64>(shape, accuracy, instructions);
            }
        }
    }
}
