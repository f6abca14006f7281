//! Real-to-real transforms of a line of nodes, one kind per pair of boundary conditions.
//!
//! Nodes sit at cell centres (i + ½)h, faces between nodes. Every kind maps n reals to n reals, so that a
//! three-dimensional transform is a product of lines whatever the mix of faces, and a kernel that is even in
//! each coordinate is diagonal in all of them.

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustdct::{DctPlanner, TransformType2And3, TransformType4};
use rustfft::num_complex::Complex;
use std::f64::consts::PI;
use std::fmt;
use std::sync::Arc;

/// Continuation of the line beyond its two ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Symmetry {
    /// Repeats itself.
    Periodic,
    /// Odd about both ends: V = 0 on both faces.
    OddOdd,
    /// Even about both ends: both faces insulating.
    EvenEven,
    /// Odd about the lower end, even about the upper.
    OddEven,
    /// Even about the lower end, odd about the upper.
    EvenOdd,
}

/// Working memory of one thread.
#[derive(Debug, Default, Clone)]
pub(crate) struct LineScratch {
    real: Vec<f64>,
    spectrum: Vec<Complex<f64>>,
    complex: Vec<Complex<f64>>,
}

enum Kind {
    Periodic { forward: Arc<dyn RealToComplex<f64>>, inverse: Arc<dyn ComplexToReal<f64>> },
    OddOdd(Arc<dyn TransformType2And3<f64>>),
    EvenEven(Arc<dyn TransformType2And3<f64>>),
    OddEven(Arc<dyn TransformType4<f64>>),
    EvenOdd(Arc<dyn TransformType4<f64>>),
}

/// Forward and inverse transform of lines of one length. `inverse(forward(x)) = x`.
pub(crate) struct LineTransform {
    len: usize,
    symmetry: Symmetry,
    kind: Kind,
}

impl fmt::Debug for LineTransform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "LineTransform({:?}, {})", self.symmetry, self.len)
    }
}

impl LineTransform {
    pub(crate) fn new(symmetry: Symmetry, len: usize) -> Self {
        let mut cosine = DctPlanner::new();
        let kind = match symmetry {
            Symmetry::Periodic => {
                let mut planner = RealFftPlanner::new();
                Kind::Periodic {
                    forward: planner.plan_fft_forward(len),
                    inverse: planner.plan_fft_inverse(len),
                }
            }
            Symmetry::OddOdd => Kind::OddOdd(cosine.plan_dct2(len)),
            Symmetry::EvenEven => Kind::EvenEven(cosine.plan_dct2(len)),
            Symmetry::OddEven => Kind::OddEven(cosine.plan_dct4(len)),
            Symmetry::EvenOdd => Kind::EvenOdd(cosine.plan_dct4(len)),
        };
        Self { len, symmetry, kind }
    }

    pub(crate) fn len(&self) -> usize {
        self.len
    }

    pub(crate) fn symmetry(&self) -> Symmetry {
        self.symmetry
    }

    /// Number of distinct wave numbers: coefficient pairs of a periodic line share one.
    pub(crate) fn wave_count(&self) -> usize {
        match self.symmetry {
            Symmetry::Periodic => self.len / 2 + 1,
            _ => self.len,
        }
    }

    /// Index of the wave number that a coefficient belongs to.
    pub(crate) fn wave_index(&self, coefficient: usize) -> usize {
        match self.symmetry {
            Symmetry::Periodic => coefficient.div_ceil(2),
            _ => coefficient,
        }
    }

    /// Wave number times node spacing, in [0, π], by wave index.
    pub(crate) fn wave_number(&self, wave_index: usize) -> f64 {
        let (index, len) = (wave_index as f64, self.len as f64);
        match self.symmetry {
            Symmetry::Periodic => 2.0 * PI * index / len,
            Symmetry::OddOdd => PI * (index + 1.0) / len,
            Symmetry::EvenEven => PI * index / len,
            Symmetry::OddEven | Symmetry::EvenOdd => PI * (index + 0.5) / len,
        }
    }

    /// Working memory that makes the transforms allocation-free.
    pub(crate) fn scratch(&self) -> LineScratch {
        let zero = Complex::new(0.0, 0.0);
        let (real, spectrum, complex) = match &self.kind {
            Kind::Periodic { forward, inverse } => {
                (self.len, self.len / 2 + 1, forward.get_scratch_len().max(inverse.get_scratch_len()))
            }
            Kind::OddOdd(plan) | Kind::EvenEven(plan) => (plan.get_scratch_len(), 0, 0),
            Kind::OddEven(plan) | Kind::EvenOdd(plan) => (plan.get_scratch_len(), 0, 0),
        };
        LineScratch { real: vec![0.0; real], spectrum: vec![zero; spectrum], complex: vec![zero; complex] }
    }

    /// Coefficients of a line, in place; a periodic line becomes (c₀, Re c₁, Im c₁, Re c₂, …).
    pub(crate) fn forward(&self, line: &mut [f64], scratch: &mut LineScratch) {
        match &self.kind {
            Kind::Periodic { forward, .. } => {
                let real = &mut scratch.real[..self.len];
                real.copy_from_slice(line);
                forward
                    .process_with_scratch(real, &mut scratch.spectrum, &mut scratch.complex)
                    .expect("buffers have the plan's lengths");
                line[0] = scratch.spectrum[0].re;
                for (pair, value) in line[1..].chunks_mut(2).zip(&scratch.spectrum[1..]) {
                    pair[0] = value.re;
                    if let Some(imaginary) = pair.get_mut(1) {
                        *imaginary = value.im;
                    }
                }
            }
            Kind::OddOdd(plan) => plan.process_dst2_with_scratch(line, &mut scratch.real),
            Kind::EvenEven(plan) => plan.process_dct2_with_scratch(line, &mut scratch.real),
            Kind::OddEven(plan) => plan.process_dst4_with_scratch(line, &mut scratch.real),
            Kind::EvenOdd(plan) => plan.process_dct4_with_scratch(line, &mut scratch.real),
        }
    }

    /// The line of given coefficients, in place, times [`Self::scale`].
    pub(crate) fn inverse(&self, line: &mut [f64], scratch: &mut LineScratch) {
        match &self.kind {
            Kind::Periodic { inverse, .. } => {
                scratch.spectrum[0] = Complex::new(line[0], 0.0);
                for (value, pair) in scratch.spectrum[1..].iter_mut().zip(line[1..].chunks(2)) {
                    *value = Complex::new(pair[0], pair.get(1).copied().unwrap_or(0.0));
                }
                inverse
                    .process_with_scratch(&mut scratch.spectrum, line, &mut scratch.complex)
                    .expect("buffers have the plan's lengths and real ends");
            }
            Kind::OddOdd(plan) => plan.process_dst3_with_scratch(line, &mut scratch.real),
            Kind::EvenEven(plan) => plan.process_dct3_with_scratch(line, &mut scratch.real),
            Kind::OddEven(plan) => plan.process_dst4_with_scratch(line, &mut scratch.real),
            Kind::EvenOdd(plan) => plan.process_dct4_with_scratch(line, &mut scratch.real),
        }
    }

    /// `inverse(forward(x)) = scale · x`.
    pub(crate) fn scale(&self) -> f64 {
        match self.symmetry {
            Symmetry::Periodic => self.len as f64,
            _ => self.len as f64 / 2.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Symmetry; 5] =
        [Symmetry::Periodic, Symmetry::OddOdd, Symmetry::EvenEven, Symmetry::OddEven, Symmetry::EvenOdd];
    /// Round-off of transforms of a few tens of nodes.
    const ROUND_OFF: f64 = 1e-12;

    #[test]
    fn inverse_undoes_forward() {
        for symmetry in ALL {
            for len in [1, 2, 3, 5, 8, 12, 15] {
                let transform = LineTransform::new(symmetry, len);
                let mut scratch = transform.scratch();
                let before: Vec<f64> = (0..len).map(|i| (i as f64 * 1.7).sin() + 0.3).collect();
                let mut line = before.clone();
                transform.forward(&mut line, &mut scratch);
                transform.inverse(&mut line, &mut scratch);
                for (value, expected) in line.iter().zip(&before) {
                    assert!((value / transform.scale() - expected).abs() < ROUND_OFF, "{symmetry:?} {len}");
                }
            }
        }
    }

    /// A symmetric three-point stencil is diagonal with eigenvalue 2cos(kh) − 2 on the continued line.
    #[test]
    fn an_even_stencil_is_diagonal() {
        for symmetry in ALL {
            for len in [4, 7, 10] {
                let transform = LineTransform::new(symmetry, len);
                let mut scratch = transform.scratch();
                let line: Vec<f64> = (0..len).map(|i| (i as f64 * 0.9).cos() - 0.2 * i as f64).collect();
                let (below, above) = match symmetry {
                    Symmetry::Periodic => (line[len - 1], line[0]),
                    Symmetry::OddOdd => (-line[0], -line[len - 1]),
                    Symmetry::EvenEven => (line[0], line[len - 1]),
                    Symmetry::OddEven => (-line[0], line[len - 1]),
                    Symmetry::EvenOdd => (line[0], -line[len - 1]),
                };
                let mut stencil: Vec<f64> = (0..len)
                    .map(|i| {
                        let left = if i == 0 { below } else { line[i - 1] };
                        let right = if i == len - 1 { above } else { line[i + 1] };
                        left - 2.0 * line[i] + right
                    })
                    .collect();
                let mut coefficients = line;
                transform.forward(&mut coefficients, &mut scratch);
                transform.forward(&mut stencil, &mut scratch);
                for index in 0..len {
                    let k = transform.wave_number(transform.wave_index(index));
                    let expected = (2.0 * k.cos() - 2.0) * coefficients[index];
                    assert!((stencil[index] - expected).abs() < ROUND_OFF * 100.0, "{symmetry:?} {index}");
                }
            }
        }
    }
}
