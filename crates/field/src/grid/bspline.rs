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

/// Lowest node that a spline of order `P` at `u` (in node spacings, node i at i) touches, and the weights
/// and derivatives with respect to `u` at the `P` nodes from there.
#[inline(always)]
pub(crate) fn weights<const P: usize>(u: f64) -> (isize, [f64; P], [f64; P]) {
    let shift = if P.is_multiple_of(2) { 0.0 } else { 0.5 };
    let cell = (u + shift).floor();
    let first = cell as isize - (P as isize - 1) / 2;
    // Distance past the lowest knot of the last spline that is non-zero here, in [0, 1).
    let t = u + shift - cell;
    let mut value = [0.0; P];
    let mut slope = [0.0; P];
    value[0] = 1.0 - t;
    value[1] = t;
    for order in 3..=P {
        if order == P {
            slope[0] = -value[0];
            for i in 1..P - 1 {
                slope[i] = value[i - 1] - value[i];
            }
            slope[P - 1] = value[P - 2];
        }
        let scale = 1.0 / (order as f64 - 1.0);
        let top = order - 1;
        value[top] = scale * t * value[top - 1];
        for i in (1..top).rev() {
            let from_left = t + (top - i) as f64;
            let from_right = (i + 1) as f64 - t;
            value[i] = scale * (from_left * value[i - 1] + from_right * value[i]);
        }
        value[0] *= scale * (1.0 - t);
    }
    (first, value, slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUND_OFF: f64 = 1e-14;

    fn check<const P: usize>() {
        for step in 0..40 {
            let u = -1.3 + 0.077 * f64::from(step);
            let (first, value, slope) = weights::<P>(u);
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
            let (first_after, after, _) = weights::<P>(u + delta);
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
