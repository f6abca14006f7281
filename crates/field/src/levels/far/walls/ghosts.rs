//! Ghosts: charges that stand for what a screen hides and mirrors.
//!
//! A charge q at y before a screen has two of them, each felt only by places that the screen hides from the
//! ghost's place:
//!
//! −q f at y itself, which takes the charge away behind the wall, and ∓q f at its mirror image y*,
//!
//! − before a conductor and + before an insulator. Their potential is q_g T(x, y_g) χ(R/R_g): the share
//! that is hidden, cut off at a radius R_g that the cells can carry. What is cut off is left to the far
//! level, as the density q_g ∇²(Tχ)/(4π) of its source; with T = 1/R that is the density of a cloud.
//! The field is exact whatever the ghosts are: they make the boundary data smooth on both sides of a wall.

use super::buckets::Buckets;
use super::mirror::{RADIUS_AT_RIM_OF_CELL, RADIUS_OF_CELL};
use super::screen::{HiddenAt, Place, Screen};
use crate::levels::far::copies::shifts;
use crate::values::FieldAt;
use amberfield_core::{Axis, Domain};
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use nalgebra::Vector3;
use std::f64::consts::PI;

/// Shape of the ghosts' clouds.
const SHAPE: f64 = 10.0;
/// Shape of the share without cusp.
const SHAPE_WITHOUT_CUSP: f64 = 12.0;
/// Intervals of the table of the clouds' share.
const INTERVALS: usize = 512;

/// Half space that a ghost is confined to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Confined {
    /// The wall that bounds it.
    pub(crate) screen: Screen,
    /// +1: before the wall; −1: behind it.
    pub(crate) above: f64,
}

/// A charge that only places behind a screen feel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ghost {
    /// Place [m].
    pub(crate) at: Vector3<f64>,
    /// Charge [C].
    pub(crate) charge: f64,
    /// Radius up to which it is felt, R_g [m].
    pub(crate) radius: f64,
    /// Screen that hides it.
    pub(crate) screen: Screen,
    /// Side of the screen on which its place is: +1 before it, −1 behind it.
    pub(crate) above: f64,
    /// Half spaces of other screens that confine it.
    pub(crate) confined: [Option<Confined>; 2],
}

impl Ghost {
    /// The ghost of a charge [C] in the place of a unit charge.
    pub(crate) fn with_charge(&self, charge: f64) -> Self {
        Self { charge: self.charge * charge, ..*self }
    }

    /// The ghost moved by a period [m].
    fn moved(&self, by: &Vector3<f64>) -> Self {
        let confined = self.confined.map(|other| {
            other.map(|Confined { screen, above }| Confined { screen: screen.moved(by), above })
        });
        Self { at: self.at + by, screen: self.screen.moved(by), confined, ..*self }
    }

    /// Whether its other screens let a place feel it.
    fn reaches(&self, place: &Place) -> bool {
        let mut confined = self.confined.iter().flatten();
        confined.all(|other| other.screen.height(&place.seen_from) * other.above > 0.0)
    }

    fn hidden(&self, place: &Place, distance: f64) -> Option<HiddenAt> {
        if !self.reaches(place) {
            return None;
        }
        self.screen.hides(place, &self.at, distance, self.above)
    }

    /// Field and potential at a place, over Coulomb's constant [C/m² and C/m].
    fn field_at(&self, share: &Share, place: &Place) -> FieldAt {
        let apart = place.at - self.at;
        let (distance, radius) = (apart.norm(), self.radius * share.widened);
        if distance >= radius {
            return FieldAt::default();
        }
        let Some(hidden) = self.hidden(place, distance) else { return FieldAt::default() };
        let Shares { value, slope, .. } = share.of(distance / radius);
        let slope_over_distance = if distance > 0.0 { slope / (radius * distance) } else { 0.0 };
        let along = value * hidden.slope_over_distance + hidden.value * slope_over_distance;
        FieldAt {
            e: -self.charge * (along * apart + value * hidden.aside),
            potential: self.charge * value * hidden.value,
        }
    }

    /// Density of the cells' source at a place [C/m³].
    fn density_at(&self, share: &Share, place: &Place) -> f64 {
        let apart = place.at - self.at;
        let distance = apart.norm();
        if distance >= self.radius || distance == 0.0 {
            return 0.0;
        }
        let Some(hidden) = self.hidden(place, distance) else { return 0.0 };
        let shares = share.of(distance / self.radius);
        let (slope, bend) = (shares.slope / self.radius, shares.bend / (self.radius * self.radius));
        let outwards = hidden.slope_over_distance * distance + hidden.aside.dot(&apart) / distance;
        let laplacian = 2.0 * slope * outwards + hidden.value * (bend + 2.0 * slope / distance);
        self.charge * laplacian / (4.0 * PI)
    }
}

/// The ghosts of all charges.
#[derive(Debug)]
pub(crate) struct Ghosts {
    ghosts: Vec<Ghost>,
    buckets: Buckets,
    shares: BothShares,
}

/// Shares of ghosts of both kinds.
#[derive(Debug)]
struct BothShares {
    of_point: Share,
    without_cusp: Share,
}

impl BothShares {
    fn of(&self, ghost: &Ghost) -> &Share {
        if matches!(ghost.screen, Screen::Rim(_)) { &self.without_cusp } else { &self.of_point }
    }
}

impl Ghosts {
    /// No ghosts yet, with radii scaled, over cells that widen a cloud by a variance of `smoothing` over
    /// their size squared.
    pub(crate) fn new(smoothing: f64, scale: f64) -> Self {
        let shares = BothShares {
            of_point: Share::of_point().over_cells(smoothing, scale * RADIUS_OF_CELL),
            without_cusp: Share::without_cusp().over_cells(smoothing, scale * RADIUS_AT_RIM_OF_CELL),
        };
        Self { ghosts: Vec::new(), buckets: Buckets::default(), shares }
    }

    /// Takes new ghosts in the place of earlier ones, with their copies that are felt inside the domain.
    pub(crate) fn replace(&mut self, ghosts: impl Iterator<Item = Ghost>, domain: &Domain) {
        self.ghosts.clear();
        let shifts = shifts(domain, Axis::ALL.map(|axis| domain.is_periodic(axis)));
        let mut reach: f64 = 0.0;
        for ghost in ghosts {
            let radius = ghost.radius * self.shares.of(&ghost).widened.max(1.0);
            reach = reach.max(radius);
            let felt = |at: &Vector3<f64>| {
                let outside = (domain.min() - at).sup(&(at - domain.max())).sup(&Vector3::zeros());
                outside.norm() < radius
            };
            self.ghosts.extend(shifts.iter().map(|by| ghost.moved(by)).filter(|copy| felt(&copy.at)));
        }
        self.buckets = Buckets::new(self.ghosts.iter().map(|ghost| &ghost.at), reach);
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.ghosts.is_empty()
    }

    /// Field and potential at a place, over Coulomb's constant [C/m² and C/m].
    pub(crate) fn field_at(&self, place: &Place) -> FieldAt {
        self.near(place)
            .fold(FieldAt::default(), |sum, ghost| sum + ghost.field_at(self.shares.of(ghost), place))
    }

    /// Density of the cells' source at a place [C/m³].
    pub(crate) fn density_at(&self, place: &Place) -> f64 {
        self.near(place).map(|ghost| ghost.density_at(self.shares.of(ghost), place)).sum()
    }

    fn near(&self, place: &Place) -> impl Iterator<Item = &Ghost> {
        self.buckets.near(&place.at).map(|number| &self.ghosts[number])
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.ghosts.capacity() * (size_of::<Ghost>() + 4)
    }
}

/// Share χ(t) of a ghost's potential that pairs carry, t = R/R_g, with its first two derivatives.
#[derive(Debug)]
struct Share {
    nodes: Vec<[f64; 3]>,
    /// Radius of what comes back from the cells over that of what they were given.
    widened: f64,
}

impl Share {
    /// Share for T = 1/R, 1 − Φ(t) with Φ the clouds' share of a point charge.
    fn of_point() -> Self {
        let cloud = Cloud { radius: 1.0, shape: SHAPE };
        Self::tabulated(|t| [1.0 - cloud.primitive(t), -cloud.slope(t), -cloud.bend(t)])
    }

    /// Share for a T that is finite at R = 0, where a cusp as that of 1 − Φ would be felt: its slope goes as
    /// t²Φ'.
    fn without_cusp() -> Self {
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
        let nodes = (0..=INTERVALS).map(|node| function(node as f64 / INTERVALS as f64)).collect();
        Self { nodes, widened: 1.0 }
    }

    /// The share that stays correct where cells widen a cloud by a variance of `smoothing` over their size
    /// squared, and clouds have a radius of `cells` cells.
    fn over_cells(self, smoothing: f64, cells: f64) -> Self {
        // Mean square of one coordinate over the cloud's density, whose potential is (1 − χ)/t.
        let of_node = |(node, [_, slope, _]): (usize, &[f64; 3])| {
            let t = node as f64 / INTERVALS as f64;
            -slope * t * t / INTERVALS as f64
        };
        let mean_square: f64 = self.nodes.iter().enumerate().map(of_node).sum();
        let widened = (1.0 + smoothing / (mean_square * cells * cells)).max(0.0).sqrt();
        Self { widened, ..self }
    }

    /// χ, χ' and χ'' at t below 1, by cubics between the nodes.
    fn of(&self, t: f64) -> Shares {
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
struct Shares {
    value: f64,
    slope: f64,
    bend: f64,
}

/// Cubic at u in [0, 1] of an interval, from value and slope at both its ends.
fn cubic(u: f64, step: f64, [value0, slope0]: [f64; 2], [value1, slope1]: [f64; 2]) -> f64 {
    let (square, cube) = (u * u, u * u * u);
    (2.0 * cube - 3.0 * square + 1.0) * value0
        + (cube - 2.0 * square + u) * step * slope0
        + (3.0 * square - 2.0 * cube) * value1
        + (cube - square) * step * slope1
}
