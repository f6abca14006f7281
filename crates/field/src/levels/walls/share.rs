//! Share of a ghost's potential that pairs carry, by its distance: the rest is left to the cells.

use amberfield_laws::kaiser_bessel_cloud::Cloud;

/// Shape of the ghosts' clouds.
const SHAPE: f64 = 10.0;
/// Shape of the share without cusp.
const SHAPE_WITHOUT_CUSP: f64 = 12.0;
/// Intervals of the table of the clouds' share.
const INTERVALS: usize = 512;

/// Share χ(t) of a ghost's potential that pairs carry, t = R/R_g, with its first two derivatives.
#[derive(Debug)]
pub(super) struct Share {
    nodes: Vec<[f64; 3]>,
    /// Mean square of one coordinate over the cloud's density, whose potential is (1 − χ)/t.
    pub(super) mean_square: f64,
}

impl Share {
    /// Share for T = 1/R, 1 − Φ(t) with Φ the clouds' share of a point charge.
    pub(super) fn of_point() -> Self {
        let cloud = Cloud { radius: 1.0, shape: SHAPE };
        Self::tabulated(|t| [1.0 - cloud.primitive(t), -cloud.slope(t), -cloud.bend(t)])
    }

    /// Share for a T that is finite at R = 0, where a cusp as that of 1 − Φ would be felt: its slope goes as
    /// t²Φ'.
    pub(super) fn without_cusp() -> Self {
        let cloud = Cloud { radius: 1.0, shape: SHAPE_WITHOUT_CUSP };
        let slope = |t: f64| t * t * cloud.slope(t);
        let bend = |t: f64| 2.0 * t * cloud.slope(t) + t * t * cloud.bend(t);
        // Simpson's rule from node to node.
        let step = 1.0 / INTERVALS as f64;
        let mut sums = vec![0.0];
        for interval in 0..INTERVALS {
            let t = interval as f64 * step;
            let piece = (slope(t) + 4.0 * slope(t + 0.5 * step) + slope(t + step)) * step / 6.0;
            sums.push(sums[interval] + piece);
        }
        let whole = sums[INTERVALS];
        let at = |t: f64| sums[((t / step).round() as usize).min(INTERVALS)];
        Self::tabulated(|t| [1.0 - at(t) / whole, -slope(t) / whole, -bend(t) / whole])
    }

    fn tabulated(function: impl Fn(f64) -> [f64; 3]) -> Self {
        let nodes: Vec<[f64; 3]> =
            (0..=INTERVALS).map(|node| function(node as f64 / INTERVALS as f64)).collect();
        let of_node = |(node, [_, slope, _]): (usize, &[f64; 3])| {
            let t = node as f64 / INTERVALS as f64;
            -slope * t * t / INTERVALS as f64
        };
        Self { mean_square: nodes.iter().enumerate().map(of_node).sum(), nodes }
    }

    /// χ, χ' and χ'' at t below 1, by cubics between the nodes.
    #[inline]
    pub(super) fn of(&self, t: f64) -> Shares {
        let step = 1.0 / INTERVALS as f64;
        let first = ((t / step) as usize).min(INTERVALS - 1);
        let u = t / step - first as f64;
        let ([value0, slope0, bend0], [value1, slope1, bend1]) = (self.nodes[first], self.nodes[first + 1]);
        Shares {
            value: cubic(u, step, [value0, slope0], [value1, slope1]),
            slope: cubic(u, step, [slope0, bend0], [slope1, bend1]),
            bend: bend0 + u * (bend1 - bend0),
        }
    }
}

/// χ and its derivatives at one place.
pub(super) struct Shares {
    pub(super) value: f64,
    pub(super) slope: f64,
    pub(super) bend: f64,
}

/// Cubic at u in [0, 1] of an interval, from value and slope at both its ends.
#[inline]
fn cubic(u: f64, step: f64, [value0, slope0]: [f64; 2], [value1, slope1]: [f64; 2]) -> f64 {
    let (square, cube) = (u * u, u * u * u);
    (2.0 * cube - 3.0 * square + 1.0) * value0
        + (cube - 2.0 * square + u) * step * slope0
        + (3.0 * square - 2.0 * cube) * value1
        + (cube - square) * step * slope1
}
