//! Cardinal B-splines that spread charge to nodes and interpolate the potential back.
//!
//! M_p(x) has support (−p/2, p/2), integral 1 and Fourier transform (sin(k/2)/(k/2))^p. Source: Essmann et
//! al., J. Chem. Phys. 103, 8577 (1995), with the centred argument of Hockney & Eastwood's order p assignment
//! functions.

/// Highest order supported.
pub(crate) const MAX_ORDER: usize = 8;
/// Nodes beyond the outermost cell centres that a spline of any order up to [`MAX_ORDER`] reaches, plus one
/// for positions that round onto a face.
pub(crate) const HALO: usize = MAX_ORDER / 2 + 1;

/// Axes handled side by side: a vector of four.
const AXES: usize = 4;

/// What a spline of order `P` does at one place, by axis.
pub(crate) struct Weights<const P: usize> {
    /// Lowest node touched.
    pub(crate) first: [isize; 3],
    /// Weights at the `P` nodes from there.
    pub(crate) value: [[f64; P]; 3],
    /// Derivatives of the weights with respect to the place.
    pub(crate) slope: [[f64; P]; 3],
}

/// Lowest node that a spline of order `P` at `u` (in node spacings, node i at i) touches.
#[inline(always)]
pub(crate) fn first_node<const P: usize>(u: f64) -> isize {
    knot::<P>(u) as isize - (P as isize - 1) / 2
}

/// The knot below `u`.
#[inline(always)]
fn knot<const P: usize>(u: f64) -> f64 {
    (u + shift::<P>()).floor()
}

#[inline(always)]
fn shift<const P: usize>() -> f64 {
    if P.is_multiple_of(2) { 0.0 } else { 0.5 }
}

/// Weights and derivatives of the splines of order `P` at the place `u` (in node spacings, node i at i).
#[inline(always)]
pub(crate) fn weights<const P: usize>(u: [f64; 3]) -> Weights<P> {
    // Distance past the lowest knot of the last spline that is non-zero here, in [0, 1).
    let mut t = [0.0; AXES];
    for axis in 0..3 {
        t[axis] = u[axis] + shift::<P>() - knot::<P>(u[axis]);
    }
    let mut value = [[0.0; AXES]; P];
    let mut slope = [[0.0; AXES]; P];
    value[0] = each(|axis| 1.0 - t[axis]);
    value[1] = t;
    for order in 3..=P {
        if order == P {
            slope[0] = each(|axis| -value[0][axis]);
            for i in 1..P - 1 {
                slope[i] = each(|axis| value[i - 1][axis] - value[i][axis]);
            }
            slope[P - 1] = value[P - 2];
        }
        let scale = 1.0 / (order as f64 - 1.0);
        let top = order - 1;
        value[top] = each(|axis| scale * t[axis] * value[top - 1][axis]);
        for i in (1..top).rev() {
            let (left, right) = ((top - i) as f64, (i + 1) as f64);
            value[i] = each(|axis| {
                scale * ((t[axis] + left) * value[i - 1][axis] + (right - t[axis]) * value[i][axis])
            });
        }
        value[0] = each(|axis| scale * (1.0 - t[axis]) * value[0][axis]);
    }
    // Spelled out: closures over arrays are not always inlined.
    let [ux, uy, uz] = u;
    let first = [first_node::<P>(ux), first_node::<P>(uy), first_node::<P>(uz)];
    let mut weights = Weights { first, value: [[0.0; P]; 3], slope: [[0.0; P]; 3] };
    for axis in 0..3 {
        for i in 0..P {
            weights.value[axis][i] = value[i][axis];
            weights.slope[axis][i] = slope[i][axis];
        }
    }
    weights
}

/// One value per axis.
#[inline(always)]
fn each(value: impl Fn(usize) -> f64) -> [f64; AXES] {
    let mut lanes = [0.0; AXES];
    for (axis, lane) in lanes.iter_mut().enumerate() {
        *lane = value(axis);
    }
    lanes
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUND_OFF: f64 = 1e-14;

    fn check<const P: usize>() {
        for step in 0..40 {
            let u = -1.3 + 0.077 * f64::from(step);
            let Weights { first: [first, ..], value: [value, ..], slope: [slope, ..] } =
                weights::<P>([u, 0.3, -0.2]);
            assert!((value.iter().sum::<f64>() - 1.0).abs() < ROUND_OFF);
            assert!(slope.iter().sum::<f64>().abs() < ROUND_OFF);
            // Linear functions are reproduced, and so is their slope.
            let mean: f64 = value.iter().enumerate().map(|(i, w)| w * (first + i as isize) as f64).sum();
            let rise: f64 = slope.iter().enumerate().map(|(i, w)| w * (first + i as isize) as f64).sum();
            assert!((mean - u).abs() < 1e-13, "order {P} at {u}: {mean}");
            assert!((rise - 1.0).abs() < 1e-13, "order {P} at {u}: {rise}");
            // Every node within the support, none beyond.
            assert!((first as f64 - u) > -(P as f64) / 2.0 - ROUND_OFF);
            assert!((first + P as isize - 1) as f64 - u < P as f64 / 2.0 + ROUND_OFF);
            let delta = 1e-6;
            let Weights { first: [.., first_after], value: [.., after], .. } =
                weights::<P>([0.1, 0.7, u + delta]);
            if first_after == first {
                for i in 0..P {
                    assert!(((after[i] - value[i]) / delta - slope[i]).abs() < 1e-5);
                }
            }
        }
    }

    #[test]
    fn partition_of_unity_linear_precision_and_slopes() {
        check::<3>();
        check::<4>();
        check::<5>();
        check::<6>();
        check::<7>();
        check::<8>();
    }
}
