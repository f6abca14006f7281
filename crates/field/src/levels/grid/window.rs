//! The window that spreads a charge over nodes and gathers the potential from them.
//!
//! A box of one node spacing convolved with the Kaiser–Bessel function of width P − 1 spacings:
//!
//! w(x) = ½ [Φ((x + ½)/a) − Φ((x − ½)/a)],  W(k) = (sin ½k)/(½k) · χ(k),  a = (P − 1)/2,
//!
//! with Φ and χ of `amberfield_laws::kaiser_bessel_cloud` for radius a, lengths in node spacings. It has
//! support (−P/2, P/2), is continuous, and the box makes its values at the nodes add up to one wherever it
//! stands: charge is kept, as by a B-spline (the box of a box of a box …), but it leaves two to eight times
//! less error at the same P and r_c/h, the more the higher P (the observation of Nestler, Front. Phys. 4,
//! 28, 2016, for windows of this kind).
//!
//! Between two nodes the window is analytic: polynomials in the place, one a node touched, computed side by
//! side.

use crate::numerics::chebyshev::{chebyshev, monomials};
use crate::numerics::processor::Vector;
use amberfield_laws::kaiser_bessel_cloud::Cloud;

/// Highest order supported.
pub(crate) const MAX_ORDER: usize = 8;
/// Nodes beyond the outermost cell centres that a window of any order up to [`MAX_ORDER`] reaches, plus one
/// for positions that round onto a face.
pub(crate) const HALO: usize = MAX_ORDER / 2 + 1;
/// Degree of the polynomials: their error is below a tenth of what a window leaves in its aliases, down to
/// errors near 1e-8, where it is as large.
const DEGREE: usize = 8;

/// A window of given order P (number of nodes touched along an axis) and shape.
#[derive(Clone, Debug)]
pub(crate) struct Window {
    cloud: Cloud,
    /// Coefficients by power of 2t − 1, t in [0, 1) the way from one knot to the next, and by node touched.
    coefficients: [[f64; MAX_ORDER]; DEGREE + 1],
}

/// Weights of a window at one place, by axis.
pub(crate) struct Weights {
    /// Lowest node touched.
    pub(crate) first: [isize; 3],
    /// Weights at the nodes from there, zeros behind the last.
    pub(crate) value: [[f64; MAX_ORDER]; 3],
    /// Derivatives of the weights with respect to the place.
    pub(crate) slope: [[f64; MAX_ORDER]; 3],
}

impl Window {
    pub(crate) fn new(order: usize, shape: f64) -> Self {
        let cloud = Cloud { radius: 0.5 * (order as f64 - 1.0), shape };
        let mut coefficients = [[0.0; MAX_ORDER]; DEGREE + 1];
        for node in 0..order {
            let lowest = node as f64 - 0.5 * order as f64;
            let series = chebyshev(|y| value(cloud, lowest + 0.5 * (1.0 - y)), 2 * DEGREE);
            for (row, coefficient) in coefficients.iter_mut().zip(monomials(&series[..=DEGREE])) {
                row[node] = coefficient;
            }
        }
        Self { cloud, coefficients }
    }

    /// W(k), k in radians per node spacing.
    pub(crate) fn transform(&self, phase: f64) -> f64 {
        let sinc = if phase == 0.0 { 1.0 } else { (0.5 * phase).sin() / (0.5 * phase) };
        sinc * self.cloud.spectrum(phase * phase)
    }

    /// Weights and derivatives at the place `u` (in node spacings, node i at i) of a window of order `P`.
    #[inline(always)]
    pub(crate) fn weights<const P: usize, V: Vector<Number = f64>>(&self, u: [f64; 3]) -> Weights {
        let mut weights =
            Weights { first: [0; 3], value: [[0.0; MAX_ORDER]; 3], slope: [[0.0; MAX_ORDER]; 3] };
        for (axis, u) in u.into_iter().enumerate() {
            weights.first[axis] = first_node::<P>(u);
            let way = V::splat(2.0 * (u + shift::<P>() - knot::<P>(u) as f64) - 1.0);
            for lane in (0..P).step_by(V::LANES) {
                let mut value = V::load(&self.coefficients[DEGREE][lane..]);
                let mut slope = V::splat(0.0);
                for coefficients in self.coefficients[..DEGREE].iter().rev() {
                    slope = slope.mul_add(way, value);
                    value = value.mul_add(way, V::load(&coefficients[lane..]));
                }
                value.write(&mut weights.value[axis][lane..]);
                slope.add(slope).write(&mut weights.slope[axis][lane..]);
            }
        }
        weights
    }
}

/// w(x).
fn value(cloud: Cloud, x: f64) -> f64 {
    let end = |x: f64| cloud.primitive(x / cloud.radius);
    0.5 * (end(x + 0.5) - end(x - 0.5))
}

/// Lowest node that a window of order `P` at `u` (in node spacings, node i at i) touches.
#[inline(always)]
pub(crate) fn first_node<const P: usize>(u: f64) -> isize {
    knot::<P>(u) - (P as isize - 1) / 2
}

/// The knot below `u`: where a window begins to touch another node.
#[inline(always)]
fn knot<const P: usize>(u: f64) -> isize {
    /// No place lies as far below node 0: what is cut off is positive, and cutting needs no library where
    /// rounding would.
    const BELOW: isize = 64;
    (u + shift::<P>() + BELOW as f64) as isize - BELOW
}

#[inline(always)]
fn shift<const P: usize>() -> f64 {
    if P.is_multiple_of(2) { 0.0 } else { 0.5 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::levels::grid::shapes;

    const ROUND_OFF: f64 = 1e-12;
    /// Error of the polynomials, worst at order 4.
    const POLYNOMIALS: f64 = 2e-7;

    fn check<const P: usize>() {
        for ratio in [1.5, 3.0, 6.0] {
            let window = Window::new(P, shapes::best(P, ratio).window);
            for step in 0..40 {
                let u = -1.3 + 0.077 * f64::from(step);
                let weights = window.weights::<P, [f64; 2]>([u, 0.3, -0.2]);
                let (first, value, slope) = (weights.first[0], &weights.value[0], &weights.slope[0]);
                assert!((value.iter().sum::<f64>() - 1.0).abs() < POLYNOMIALS);
                assert!(slope.iter().sum::<f64>().abs() < 100.0 * POLYNOMIALS);
                assert!(value[P..].iter().chain(&slope[P..]).all(|&beyond| beyond == 0.0));
                for (node, &weight) in value[..P].iter().enumerate() {
                    let x = (first + node as isize) as f64 - u;
                    assert!(x.abs() <= P as f64 / 2.0 + ROUND_OFF);
                    let exact = super::value(window.cloud, x);
                    assert!((weight - exact).abs() < POLYNOMIALS, "order {P}, {ratio}: {weight} for {exact}");
                }
                let delta = 1e-6;
                let after = window.weights::<P, [f64; 2]>([0.1, 0.7, u + delta]);
                if after.first[2] == first {
                    for node in 0..P {
                        let rise = (after.value[2][node] - value[node]) / delta;
                        assert!((rise - slope[node]).abs() < 1e-5);
                    }
                }
            }
        }
    }

    #[test]
    fn partition_of_unity_values_and_slopes() {
        check::<4>();
        check::<5>();
        check::<6>();
        check::<7>();
        check::<8>();
    }

    #[test]
    fn transform_is_the_windows() {
        let window = Window::new(5, 7.0);
        for phase in [0.0, 0.7, 2.9, 6.0] {
            const STEPS: usize = 4000;
            let step = 5.0 / STEPS as f64;
            let sum: f64 = (0..STEPS)
                .map(|i| (i as f64 + 0.5) * step - 2.5)
                .map(|x| super::value(window.cloud, x) * (phase * x).cos() * step)
                .sum();
            assert!((sum - window.transform(phase)).abs() < 1e-6, "{phase}");
        }
    }
}
