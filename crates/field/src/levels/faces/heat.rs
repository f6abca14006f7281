//! One-dimensional heat kernels (∂K/∂t = ∂²K/∂x²) of an axis with its faces: what survives, what leaves
//! through a conductor, what an insulator's flux brings in.

use crate::geometry::images::{AxisKind, FaceKind};
use libm::{erf, erfc};
use std::f64::consts::PI;

/// Gaussians beyond e^{−45} of their peak are left out.
const LAST_EXPONENT: f64 = 45.0;
/// erfc beyond this argument is below 1e-18.
const LAST_ERFC: f64 = 6.2;

/// A value and its derivative along the axis.
pub(super) type WithSlope = [f64; 2];

/// Heat kernel integrals of one axis at one place and time.
#[derive(Clone, Copy, Debug)]
pub(super) struct AxisHeat {
    /// Rest of a unit amount that started here: ∫ K dx'. Slope [1/m].
    pub(super) survival: WithSlope,
    /// Lower and upper face: rate of first passage through a conductor [1/m² as t is in m²], kernel at an
    /// insulator [1/m], zero for others.
    pub(super) faces: [WithSlope; 2],
}

impl AxisHeat {
    /// The kernels at distances `below` from the lower and `above` from the upper face [m], time `t` [m²].
    pub(super) fn new(kind: AxisKind, below: f64, above: f64, t: f64) -> Self {
        use FaceKind::{Conductor, Insulator, Open};
        let length = below + above;
        let none = [0.0; 2];
        let whole = [1.0, 0.0];
        match kind {
            AxisKind::Periodic | AxisKind::Faces(Open, Open) => Self { survival: whole, faces: [none; 2] },
            AxisKind::Faces(Conductor, Conductor) => Self {
                survival: survival(below, above, t),
                faces: [
                    passage(theta(below, 2.0 * length, t)),
                    flipped(passage(theta(above, 2.0 * length, t))),
                ],
            },
            AxisKind::Faces(Insulator, Insulator) => Self {
                survival: whole,
                faces: [twice(theta(below, 2.0 * length, t)), flipped(twice(theta(above, 2.0 * length, t)))],
            },
            AxisKind::Faces(Conductor, Insulator) => Self::mixed(below, above, t),
            AxisKind::Faces(Insulator, Conductor) => Self::mixed(above, below, t).mirrored(),
            AxisKind::Faces(face, Open) => Self::half_line(face, below, t),
            AxisKind::Faces(Open, face) => Self::half_line(face, above, t).mirrored(),
        }
    }

    /// Conductor at distance `near`, insulator at `far`: two conductors at twice the length.
    fn mixed(near: f64, far: f64, t: f64) -> Self {
        let length = near + far;
        let period = 4.0 * length;
        let direct = passage(theta(near, period, t));
        let mirrored = flipped(passage(theta(length + far, period, t)));
        let inward = theta(far, period, t);
        let image = theta(length + near, period, t);
        Self {
            survival: survival(near, length + far, t),
            faces: [
                [direct[0] + mirrored[0], direct[1] + mirrored[1]],
                [2.0 * (inward[0] - image[0]), -2.0 * (inward[1] + image[1])],
            ],
        }
    }

    fn half_line(face: FaceKind, distance: f64, t: f64) -> Self {
        let kernel = gaussian(distance, t);
        match face {
            FaceKind::Conductor => Self {
                survival: [erf(distance / (4.0 * t).sqrt()), 2.0 * kernel[0]],
                faces: [passage(kernel), [0.0; 2]],
            },
            _ => Self { survival: [1.0, 0.0], faces: [twice(kernel), [0.0; 2]] },
        }
    }

    fn mirrored(self) -> Self {
        Self { survival: flipped(self.survival), faces: [flipped(self.faces[1]), flipped(self.faces[0])] }
    }
}

/// Turns a value with its slope around, as seen from the other end.
fn flipped([value, slope]: WithSlope) -> WithSlope {
    [value, -slope]
}

fn twice([value, slope, _]: [f64; 3]) -> WithSlope {
    [2.0 * value, 2.0 * slope]
}

/// First passage through a conductor from the kernel of its images.
fn passage([_, slope, curvature]: [f64; 3]) -> WithSlope {
    [-2.0 * slope, -2.0 * curvature]
}

/// e^{−y²/4t}/√(4πt) with its first two derivatives.
fn gaussian(y: f64, t: f64) -> [f64; 3] {
    let exponent = y * y / (4.0 * t);
    if exponent > LAST_EXPONENT {
        return [0.0; 3];
    }
    let value = (-exponent).exp() / (4.0 * PI * t).sqrt();
    [value, -0.5 * y / t * value, (exponent - 0.5) / t * value]
}

/// Σₙ gaussian(y + n·period) with its first two derivatives, 0 ≤ y ≤ period/2.
fn theta(y: f64, period: f64, t: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    if 4.0 * PI * t < period * period {
        for copies in -3_i8..=3 {
            let term = gaussian(y + f64::from(copies) * period, t);
            for (total, value) in sum.iter_mut().zip(term) {
                *total += value;
            }
        }
        return sum;
    }
    let step = 2.0 * PI / period;
    sum[0] = 1.0 / period;
    for order in 1_u8..=4 {
        let k = f64::from(order) * step;
        let weight = 2.0 / period * (-k * k * t).exp();
        let (sine, cosine) = (k * y).sin_cos();
        sum[0] += weight * cosine;
        sum[1] -= weight * k * sine;
        sum[2] -= weight * k * k * cosine;
    }
    sum
}

/// Survival between two conductors at distances `below` and `above`.
fn survival(below: f64, above: f64, t: f64) -> WithSlope {
    let length = below + above;
    if PI * t < length * length {
        let width = (4.0 * t).sqrt();
        let mut value = erf(below / width) - erfc(above / width);
        let mut slope = 2.0 * (gaussian(below, t)[0] - gaussian(above, t)[0]);
        let mut sign = 1.0;
        let mut shift = length;
        while shift < LAST_ERFC * width {
            value += sign * (erfc((shift + below) / width) + erfc((shift + above) / width));
            slope -= sign * 2.0 * (gaussian(shift + below, t)[0] - gaussian(shift + above, t)[0]);
            sign = -sign;
            shift += length;
        }
        return [value, slope];
    }
    // Odd orders are symmetric: count from the nearer end, where the sine is accurate.
    let (nearer, side) = if below <= above { (below, 1.0) } else { (above, -1.0) };
    let (mut value, mut slope) = (0.0, 0.0);
    for order in [1.0, 3.0, 5.0] {
        let k = order * PI / length;
        let weight = 4.0 / length * (-k * k * t).exp();
        let (sine, cosine) = (k * nearer).sin_cos();
        value += weight / k * sine;
        slope += side * weight * cosine;
    }
    [value, slope]
}

#[cfg(test)]
mod tests {
    use super::*;
    use FaceKind::{Conductor, Insulator, Open};

    /// Round-off of sums of a few terms of order 1.
    const ROUND_OFF: f64 = 1e-13;

    /// Images and modes agree where one takes over from the other.
    #[test]
    fn small_and_large_times_join() {
        for y in [0.01, 0.4, 0.9] {
            let (before, after) = (1.0 / PI * (1.0 - 1e-14), 1.0 / PI * (1.0 + 1e-14));
            let pairs = theta(y, 2.0, before).into_iter().zip(theta(y, 2.0, after));
            let survivals = survival(y, 1.0 - y, before).into_iter().zip(survival(y, 1.0 - y, after));
            for (a, b) in pairs.chain(survivals) {
                assert!((a - b).abs() < ROUND_OFF, "{a} {b}");
            }
        }
    }

    /// Losses leave through the conductors: −dU/dt = ΣF. And slopes are derivatives.
    #[test]
    fn losses_are_passages_and_slopes_derivatives() {
        const STEP: f64 = 1e-5;
        for kind in [
            (Conductor, Conductor),
            (Conductor, Insulator),
            (Insulator, Conductor),
            (Conductor, Open),
            (Open, Conductor),
        ] {
            let kind = AxisKind::Faces(kind.0, kind.1);
            for t in [0.003, 0.05, 0.3, 0.9] {
                let at = |x: f64, t: f64| AxisHeat::new(kind, x, 1.0 - x, t);
                let x = 0.3;
                let rate = (at(x, t * (1.0 + STEP)).survival[0] - at(x, t * (1.0 - STEP)).survival[0])
                    / (2.0 * STEP * t);
                let is_conductor = |face| face == Conductor;
                let AxisKind::Faces(lower, upper) = kind else { unreachable!() };
                let passages = [lower, upper].into_iter().zip(at(x, t).faces);
                let passed: f64 =
                    passages.filter(|(face, _)| is_conductor(*face)).map(|(_, value)| value[0]).sum();
                assert!((rate + passed).abs() < 1e-7 * passed.max(1e-3), "{kind:?} {t}: {rate} {passed}");
                let [low, high] = [at(x - STEP, t), at(x + STEP, t)];
                let here = at(x, t);
                let terms = [
                    (low.survival, high.survival, here.survival),
                    (low.faces[0], high.faces[0], here.faces[0]),
                    (low.faces[1], high.faces[1], here.faces[1]),
                ];
                for (low, high, here) in terms {
                    let difference = (high[0] - low[0]) / (2.0 * STEP);
                    assert!((difference - here[1]).abs() < 1e-6 * here[1].abs().max(1.0), "{kind:?} {t}");
                }
            }
        }
    }
}
