//! Ghosts: charges that stand for what a screen hides and mirrors, and for what the faces of an edge do.
//!
//! A charge q at y before a screen has two of them, each felt only by places that the screen hides from the
//! ghost's place:
//!
//! −q f at y itself, which takes the charge away behind the wall, and ∓q f at its mirror image y*,
//!
//! − before a conductor and + before an insulator. Beside an edge it has one at its own place, felt by all
//! places between the faces. Their potential is q_g T(x, y_g) χ(R/R_g), T = 1/R behind a screen and what the
//! faces add beside an edge, cut off at a radius R_g that the cells can carry. What is cut off is left to
//! the far level, as the density q_g ∇²(Tχ)/(4π) of its source; with T = 1/R that is the density of a cloud.
//! The field is exact whatever the ghosts are: they make the boundary data smooth on both sides of a wall.

use super::buckets::Buckets;
use super::mirror::Extent;
use super::screen::{EdgeKey, EdgeScreen, Place, Screen, ScreenKey};
use super::share::{Share, Shares};
use crate::levels::copies::shifts;
use crate::values::FieldAt;
use amberfield_core::{Axis, Domain};
use amberfield_laws::wedge::Around;
use nalgebra::Vector3;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::hash::Hash;

/// Radius of what comes back of a cloud from the cells, over its own, at most.
const WIDENED_AT_MOST: f64 = 1.5;
/// Rings of buckets in which ghosts near a place are looked for.
const RINGS: u32 = 2;

/// Half space that a ghost is confined to.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Confined {
    /// The wall that bounds it.
    pub(crate) screen: Screen,
    /// +1: before the wall; −1: behind it.
    pub(crate) above: f64,
}

/// Places that feel a ghost.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shown {
    /// Places that a screen hides from it; it is before the screen (+1) or behind it (−1).
    Behind {
        /// The screen.
        screen: Screen,
        /// Side of the ghost.
        above: f64,
    },
    /// Places around an edge: what they feel is the potential that the edge's faces add to the charge's.
    Around(EdgeScreen),
}

/// A charge that not all places feel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ghost {
    /// Place [m].
    pub(crate) at: Vector3<f64>,
    /// Charge [C].
    pub(crate) charge: f64,
    /// Radius up to which it is felt, R_g.
    pub(crate) extent: Extent,
    /// Places that feel it.
    pub(crate) shown: Shown,
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
        let shown = match self.shown {
            Shown::Behind { screen, above } => Shown::Behind { screen: screen.moved(by), above },
            Shown::Around(edge) => Shown::Around(edge.moved(by)),
        };
        Self { at: self.at + by, shown, confined, ..*self }
    }
}

/// The ghosts of all charges, bucket by bucket.
#[derive(Debug)]
pub(crate) struct Ghosts {
    spots: Vec<Spot>,
    ghosts: Vec<Felt>,
    screens: Screens,
    buckets: Buckets,
    shares: BothShares,
}

/// Place of a ghost, and the square of the radius up to which its field is felt [m²].
#[derive(Clone, Copy, Debug)]
struct Spot {
    at: Vector3<f64>,
    reach_squared: f64,
}

/// Ghost that is felt, but for its place: its screens by their numbers.
#[derive(Clone, Copy, Debug)]
struct Felt {
    charge: f64,
    /// Radius of its cloud [m], and of what comes back of that from the cells.
    radius: f64,
    returned: f64,
    by: By,
    confined: [Option<Side>; 2],
}

/// Screen or edge that shows a ghost.
#[derive(Clone, Copy, Debug)]
enum By {
    Screen(Side),
    /// Number of an edge, and where the ghost is around it.
    Edge(u32, Around),
}

/// Side of a screen: +1 before it, −1 behind it.
#[derive(Clone, Copy, Debug)]
struct Side {
    screen: u32,
    above: f32,
}

/// Things that many ghosts have, each once.
#[derive(Debug)]
struct Known<K, T> {
    all: Vec<T>,
    numbers: HashMap<K, u32>,
}

/// Screens and edges of ghosts.
#[derive(Debug, Default)]
struct Screens {
    screens: Known<ScreenKey, Screen>,
    edges: Known<EdgeKey, EdgeScreen>,
}

/// Potential of a unit ghost but for its share [1/m], and its gradient [1/m²].
#[derive(Clone, Copy, Debug)]
struct Whole {
    value: f64,
    slope: Vector3<f64>,
}

impl<K, T> Default for Known<K, T> {
    fn default() -> Self {
        Self { all: Vec::new(), numbers: HashMap::new() }
    }
}

impl<K: Eq + Hash, T> Known<K, T> {
    fn number(&mut self, key: K, thing: T) -> u32 {
        let next = self.all.len() as u32;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.all.push(thing);
        }
        number
    }

    fn memory_bytes(&self) -> usize {
        self.all.capacity() * size_of::<T>() + self.numbers.capacity() * (size_of::<K>() + 4)
    }
}

impl Screens {
    fn side(&mut self, screen: Screen, above: f64) -> Side {
        Side { screen: self.screens.number(screen.key(), screen), above: above as f32 }
    }

    fn by(&mut self, ghost: &Ghost) -> Option<By> {
        match ghost.shown {
            Shown::Behind { screen, above } => Some(By::Screen(self.side(screen, above))),
            Shown::Around(edge) => {
                let around = edge.around(&Place { at: ghost.at, seen_from: ghost.at })?;
                Some(By::Edge(self.edges.number(edge.key(), edge), around))
            }
        }
    }

    fn height(&self, side: Side, place: &Place) -> f64 {
        self.screens.all[side.screen as usize].height(&place.seen_from) * f64::from(side.above)
    }
}

/// Shares of ghosts of both kinds.
#[derive(Debug)]
struct BothShares {
    of_point: Share,
    without_cusp: Share,
    /// Variance by which cells widen a cloud over their size squared.
    smoothing: f64,
}

impl BothShares {
    fn of(&self, by: &By) -> &Share {
        match by {
            By::Screen(_) => &self.of_point,
            By::Edge(..) => &self.without_cusp,
        }
    }

    /// Radius of what comes back from the cells over that of what they were given.
    fn widened(&self, by: &By, cells: f64) -> f64 {
        (1.0 + self.smoothing / (self.of(by).mean_square * cells * cells)).max(0.0).sqrt()
    }
}

/// A place, and where it is around the edge that it was last seen from: many ghosts have one edge.
struct Sight {
    place: Place,
    edge: u32,
    around: Option<Around>,
}

impl Sight {
    fn of(place: &Place) -> Self {
        Self { place: *place, edge: u32::MAX, around: None }
    }

    fn around(&mut self, edge: u32, screen: &EdgeScreen) -> Option<Around> {
        if self.edge != edge {
            (self.edge, self.around) = (edge, screen.around(&self.place));
        }
        self.around
    }
}

impl Ghosts {
    /// No ghosts yet, over cells that widen a cloud by a variance of `smoothing` over their size squared.
    pub(crate) fn new(smoothing: f64) -> Self {
        let shares =
            BothShares { of_point: Share::of_point(), without_cusp: Share::without_cusp(), smoothing };
        let (spots, ghosts) = (Vec::new(), Vec::new());
        Self { spots, ghosts, screens: Screens::default(), buckets: Buckets::default(), shares }
    }

    /// Takes new ghosts in the place of earlier ones, with their copies that are felt inside the domain.
    pub(crate) fn replace(&mut self, ghosts: impl Iterator<Item = Ghost>, domain: &Domain) {
        self.screens = Screens::default();
        let shifts = shifts(domain, Axis::ALL.map(|axis| domain.is_periodic(axis)));
        let (mut spots, mut felt) = (Vec::new(), Vec::new());
        let mut farthest: f64 = 0.0;
        for ghost in ghosts {
            let Extent { radius, cells } = ghost.extent;
            for copy in shifts.iter().map(|by| ghost.moved(by)) {
                let outside = (domain.min() - copy.at).sup(&(copy.at - domain.max())).sup(&Vector3::zeros());
                if outside.norm() >= WIDENED_AT_MOST * radius {
                    continue;
                }
                let Some(by) = self.screens.by(&copy) else { continue };
                let screens = &mut self.screens;
                let confined = copy.confined.map(|other| other.map(|it| screens.side(it.screen, it.above)));
                let returned = radius * self.shares.widened(&by, cells).min(WIDENED_AT_MOST);
                let reach = returned.max(radius);
                farthest = farthest.max(reach);
                spots.push(Spot { at: copy.at, reach_squared: reach * reach });
                felt.push(Felt { charge: copy.charge, radius, returned, by, confined });
            }
        }
        self.buckets = Buckets::with_rings(spots.iter().map(|spot| &spot.at), farthest, RINGS);
        let order = || self.buckets.order().iter().map(|&number| number as usize);
        self.spots = order().map(|number| spots[number]).collect();
        self.ghosts = order().map(|number| felt[number]).collect();
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.ghosts.is_empty()
    }

    /// Field and potential at a place, over Coulomb's constant [C/m² and C/m].
    pub(crate) fn field_at(&self, place: &Place) -> FieldAt {
        let mut sum = FieldAt::default();
        let mut sight = Sight::of(place);
        for number in self.near(place) {
            let Felt { charge, returned: radius, by, .. } = &self.ghosts[number];
            let apart = place.at - self.spots[number].at;
            let distance = apart.norm();
            if distance >= *radius {
                continue;
            }
            let Some(whole) = self.whole(number, &mut sight, &apart, distance) else { continue };
            let Shares { value, slope, .. } = self.shares.of(by).of(distance / radius);
            let along = if distance > 0.0 { slope / (radius * distance) } else { 0.0 };
            sum.e -= *charge * (value * whole.slope + whole.value * along * apart);
            sum.potential += charge * value * whole.value;
        }
        sum
    }

    /// Density of the cells' source at a place [C/m³].
    pub(crate) fn density_at(&self, place: &Place) -> f64 {
        let mut sum = 0.0;
        let mut sight = Sight::of(place);
        for number in self.near(place) {
            let Felt { charge, radius, by, .. } = &self.ghosts[number];
            let apart = place.at - self.spots[number].at;
            let distance = apart.norm();
            if distance >= *radius || distance == 0.0 {
                continue;
            }
            let Some(whole) = self.whole(number, &mut sight, &apart, distance) else { continue };
            let shares = self.shares.of(by).of(distance / radius);
            let (slope, bend) = (shares.slope / radius, shares.bend / (radius * radius));
            let outwards = whole.slope.dot(&apart) / distance;
            sum += charge * (2.0 * slope * outwards + whole.value * (bend + 2.0 * slope / distance));
        }
        sum / (4.0 * PI)
    }

    /// Numbers of the ghosts within whose reach a place is.
    #[inline]
    fn near(&self, place: &Place) -> impl Iterator<Item = usize> {
        let at = place.at;
        let is_near = move |number: &usize| {
            let spot = &self.spots[*number];
            (at - spot.at).norm_squared() < spot.reach_squared
        };
        self.buckets.rows(&place.at).flatten().filter(is_near)
    }

    /// Potential of a ghost of unit charge but for its share, if a place at a distance from it feels it.
    #[inline]
    fn whole(&self, number: usize, sight: &mut Sight, apart: &Vector3<f64>, distance: f64) -> Option<Whole> {
        let Felt { by, confined, .. } = &self.ghosts[number];
        if let By::Screen(side) = by
            && self.screens.height(*side, &sight.place) > 0.0
        {
            return None;
        }
        if confined.iter().flatten().any(|side| self.screens.height(*side, &sight.place) <= 0.0) {
            return None;
        }
        match by {
            By::Screen(_) => {
                let value = distance.recip();
                Some(Whole { value, slope: -value.powi(3) * apart })
            }
            By::Edge(edge, there) => {
                let screen = &self.screens.edges.all[*edge as usize];
                let Some(here) = sight.around(*edge, screen) else {
                    let value = -distance.recip();
                    return Some(Whole { value, slope: value.powi(2) / distance * apart });
                };
                let (value, slope) = screen.induced(&here, there);
                Some(Whole { value, slope })
            }
        }
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.ghosts.capacity() * (size_of::<Felt>() + size_of::<Spot>() + 4)
            + self.screens.screens.memory_bytes()
            + self.screens.edges.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;
    use amberfield_laws::wedge::{Face, Wedge};
    use std::f64::consts::{PI, TAU};

    #[test]
    fn sheet_and_body_with_one_rim_add_up_in_any_order() {
        let domain = Domain::new(Vector3::repeat(-5.0), Vector3::repeat(5.0), [[Boundary::Grounded; 2]; 3]);
        let domain = domain.unwrap();
        let ghost = |angle, face| Ghost {
            at: Vector3::new(-0.5, -0.25, 0.0),
            charge: 1.0,
            extent: Extent { radius: 4.0, cells: 4.0 },
            shown: Shown::Around(EdgeScreen {
                point: Vector3::zeros(),
                along: Vector3::z(),
                into: Vector3::x(),
                up: Vector3::y(),
                wedge: Wedge::new(angle, [face; 2]),
            }),
            confined: [None; 2],
        };
        let all =
            [ghost(TAU, Face::Conductor), ghost(1.5 * PI, Face::Conductor), ghost(TAU, Face::Insulator)];
        let at = Vector3::new(-0.25, 0.5, 0.25);
        let potential = |ghosts: &[Ghost]| {
            let mut sum = Ghosts::new(0.0);
            sum.replace(ghosts.iter().copied(), &domain);
            sum.field_at(&Place { at, seen_from: at }).potential
        };
        let alone: f64 = all.iter().map(|ghost| potential(&[*ghost])).sum();
        for order in [[0, 1, 2], [1, 0, 2], [2, 1, 0]] {
            let together = potential(&order.map(|number| all[number]));
            assert!((together - alone).abs() < 1e-14, "{together} for {alone}");
        }
    }
}
