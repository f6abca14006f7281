//! Charge on walls, by the places at which grains left it.
//!
//! A spot is a place of a surface at which charge was left, with the normal and the scale of the grains that
//! left it. Contacts close by share a spot, whose place is the mean of theirs; what belongs to it is a matter
//! of places alone, never of how a wall is cut into triangles, files or periods. Spots of insulating walls
//! keep their charge, and act as `amberfield_laws::kept_charge` says. In an evaluation of the field that is a
//! point charge just before the surface; near a spot, contacts and grains get the law's field in its place.
//! Spots of grounded walls book what flowed off there. Spots of a wall that moves go along with it.

use super::inside;
use amberfield_core::{Domain, Placement, Vector3};
use amberfield_laws::charge_transfer::ChargeOfInsulator;
use amberfield_laws::kept_charge::KeptCharge;
use amberfield_laws::point_charge;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Distance from a spot's first place up to which contacts share it, over the smaller of both scales.
const SHARED: f64 = 0.75;
/// Largest ratio of the scales of contacts that share a spot.
const SIMILAR: f64 = 1.25;
/// Least cosine of the angle between the normals of contacts that share a spot.
const SAME_SIDE: f64 = 0.8;
/// Distance of a spot's point charge before the surface, over the scale.
const BEFORE: f64 = 0.1;
/// Distance up to which a spot is more than its point charge, over the scale.
const NEAR: f64 = 3.5;
/// Part of the radius by which a contact counts as before its surface: more than round-off.
const IN_FRONT: f64 = 0.02;
/// Side of the square by which a spot is drawn, over the scale: spots that cover a surface have a mean area
/// of its square.
const DRAWN: f64 = 0.9;

/// Charge that grains left around a place on a wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChargedSpot {
    /// Wall of the first contact, by its number; a spot may reach across a seam of walls.
    pub wall: u32,
    /// Mean place of the charge, on the surface [m].
    pub place: Vector3<f64>,
    /// Unit normal of the surface, towards the grains.
    pub normal: Vector3<f64>,
    /// Mean radius of the grains that left the charge [m].
    pub scale: f64,
    /// Charge that it holds, or that flowed off there [C].
    pub charge: f64,
    /// Place of the first contact [m].
    first: Vector3<f64>,
    /// Σ of the sizes of the charges that moved there [C].
    moved: f64,
    /// Whether the charge stays.
    keeps: bool,
    /// Whether the field has images in the surface.
    bounds_field: bool,
    /// Place on a wall that moves, where the wall has not moved; `None` on a wall at rest.
    home: Option<AtHome>,
}

/// Spot of a wall that moves, as it lies where the wall has not moved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct AtHome {
    place: Vector3<f64>,
    normal: Vector3<f64>,
    first: Vector3<f64>,
}

impl ChargedSpot {
    /// Corners of a square around the place, in order [m].
    #[must_use]
    pub fn square(&self) -> [Vector3<f64>; 4] {
        let across = self.normal.cross(&Vector3::ith(self.normal.iamin(), 1.0)).normalize();
        let [u, v] = [across, self.normal.cross(&across)].map(|axis| axis * (0.5 * DRAWN * self.scale));
        [self.place - u - v, self.place + u - v, self.place + u + v, self.place - u + v]
    }

    /// Goes along with its wall.
    fn carry(&mut self, domain: &Domain, placement: &Placement) {
        if let Some(AtHome { place, normal, first }) = &self.home {
            self.place = domain.wrap(placement.place(place));
            self.first = domain.wrap(placement.place(first));
            self.normal = placement.turn * normal;
        }
    }

    fn shape(&self, radius: f64) -> KeptCharge {
        KeptCharge { scale: self.scale.max(radius), normal: self.normal }
    }

    /// Place of its point charge, inside the domain [m].
    fn source(&self, domain: &Domain) -> Vector3<f64> {
        inside(domain, self.place + self.normal * (BEFORE * self.scale))
    }
}

/// Contact at which charge moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Wall, by its number.
    pub(super) wall: u32,
    /// Whether the wall keeps charge.
    pub(super) keeps: bool,
    /// Whether the field has images in the surface.
    pub(super) bounds_field: bool,
    /// Place on the surface [m].
    pub(super) place: Vector3<f64>,
    /// Direction from the wall to the grain.
    pub(super) inward: Vector3<f64>,
    /// Radius of the grain [m].
    pub(super) radius: f64,
}

/// All spots.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spots {
    spots: Vec<ChargedSpot>,
    /// Edge of a cell [m].
    cell: f64,
    /// Spots of walls at rest in each cell and the cells around it, ascending.
    around: HashMap<[i64; 3], Vec<u32>>,
    /// Walls that move.
    movers: Vec<MovingWall>,
}

/// Wall that moves, with its spots.
#[derive(Clone, Debug)]
struct MovingWall {
    /// Number of the wall.
    wall: u32,
    placement: Placement,
    /// Numbers of its spots.
    spots: Vec<u32>,
    /// Spots in each cell and the cells around it, by where they are when the wall has not moved.
    around: HashMap<[i64; 3], Vec<u32>>,
}

impl Spots {
    /// Spots of grains with radii up to a largest one [m].
    pub(super) fn new(largest_radius: f64) -> Self {
        Self { cell: (NEAR + SHARED) * largest_radius, ..Self::default() }
    }

    pub(super) fn all(&self) -> &[ChargedSpot] {
        &self.spots
    }

    /// Goes on from the spots of a state.
    pub(super) fn restore(&mut self, domain: &Domain, spots: &[ChargedSpot]) {
        self.around.clear();
        self.movers.clear();
        self.spots.clear();
        spots.iter().for_each(|spot| {
            self.push(domain, spot.clone());
        });
    }

    fn cell_of(&self, place: Vector3<f64>) -> [i64; 3] {
        [0, 1, 2].map(|axis| (place[axis] / self.cell).floor() as i64)
    }

    /// Number of a wall that moves among those; `None` for others.
    fn mover_of(&self, wall: u32) -> Option<usize> {
        self.movers.iter().position(|mover| mover.wall == wall)
    }

    /// Takes spots along with the walls that move.
    pub(super) fn follow(&mut self, domain: &Domain, placements: impl Iterator<Item = (u32, Placement)>) {
        for (wall, placement) in placements {
            let mover = self.provide_mover(wall);
            if self.movers[mover].placement != placement {
                self.movers[mover].placement = placement;
                for &spot in &self.movers[mover].spots {
                    self.spots[spot as usize].carry(domain, &placement);
                }
            }
        }
    }

    /// Number among the walls that move of one that does.
    fn provide_mover(&mut self, wall: u32) -> usize {
        self.mover_of(wall).unwrap_or_else(|| {
            let (placement, spots) = (Placement::home(), Vec::new());
            self.movers.push(MovingWall { wall, placement, spots, around: HashMap::new() });
            self.movers.len() - 1
        })
    }

    fn push(&mut self, domain: &Domain, spot: ChargedSpot) -> usize {
        let number = self.spots.len();
        let cells = self.cells_around(domain, spot.home.map_or(spot.first, |home| domain.wrap(home.first)));
        let mover = spot.home.map(|_| self.provide_mover(spot.wall));
        let around = match mover {
            Some(mover) => {
                self.movers[mover].spots.push(number as u32);
                &mut self.movers[mover].around
            }
            None => &mut self.around,
        };
        for cell in cells {
            let list = around.entry(cell).or_default();
            if list.last() != Some(&(number as u32)) {
                list.push(number as u32);
            }
        }
        self.spots.push(spot);
        number
    }

    /// Cells of a place [m] and its periodic copies, and those around them.
    fn cells_around(&self, domain: &Domain, place: Vector3<f64>) -> Vec<[i64; 3]> {
        let extent = domain.extent();
        let mut cells = Vec::with_capacity(27);
        for code in 0..27_i32 {
            let periods = Vector3::new(code / 9 - 1, code / 3 % 3 - 1, code % 3 - 1);
            let is_there =
                |axis: amberfield_core::Axis| periods[axis.index()] == 0 || domain.is_periodic(axis);
            if !amberfield_core::Axis::ALL.into_iter().all(is_there) {
                continue;
            }
            let [x, y, z] = self.cell_of(place + periods.map(f64::from).component_mul(&extent));
            cells.extend((0..27).map(|near| [x + near / 9 - 1, y + near / 3 % 3 - 1, z + near % 3 - 1]));
        }
        cells
    }

    /// Spots around a place [m] with their numbers, in order.
    fn around(&self, domain: &Domain, place: Vector3<f64>) -> impl Iterator<Item = (usize, &ChargedSpot)> {
        let at_rest =
            if self.spots.is_empty() { None } else { self.around.get(&self.cell_of(domain.wrap(place))) };
        let moving = self.movers.iter().filter(|mover| !mover.spots.is_empty()).filter_map(move |mover| {
            let home = domain.wrap(mover.placement.home_of(&place));
            mover.around.get(&self.cell_of(home))
        });
        let numbers = at_rest.into_iter().chain(moving).flatten();
        numbers.map(|&number| (number as usize, &self.spots[number as usize]))
    }

    /// Spots that keep charge near a place [m], felt by a grain of a radius [m], with the offset from each.
    fn kept_near(
        &self,
        domain: &Domain,
        place: Vector3<f64>,
        radius: f64,
    ) -> impl Iterator<Item = (usize, &ChargedSpot, Vector3<f64>)> {
        let with_offset =
            move |(number, spot): (usize, &'_ ChargedSpot)| (number, domain.shortest(place - spot.place));
        let near =
            move |spot: &ChargedSpot, offset: &Vector3<f64>| offset.norm() < NEAR * spot.scale.max(radius);
        self.around(domain, place).filter(|(_, spot)| spot.keeps).filter_map(move |(number, spot)| {
            let (_, offset) = with_offset((number, spot));
            near(spot, &offset).then_some((number, spot, offset))
        })
    }

    /// Number of the spot that a contact charges; it begins to exist where it did not.
    pub(super) fn at(&mut self, domain: &Domain, contact: &Contact) -> usize {
        let &Contact { wall, keeps, bounds_field, place, inward, radius } = contact;
        let mover = self.mover_of(wall);
        let mut nearest = None;
        let mut least = f64::INFINITY;
        for (number, spot) in self.around(domain, place) {
            let similar = spot.scale.max(radius) <= SIMILAR * spot.scale.min(radius);
            let distance = domain.shortest(place - spot.first).norm();
            // What moves has no spot in common with anything else.
            let is_of_wall = spot.home.is_some() == mover.is_some() && (mover.is_none() || spot.wall == wall);
            let is_shared = (spot.keeps, spot.bounds_field) == (keeps, bounds_field)
                && is_of_wall
                && similar
                && distance <= SHARED * spot.scale.min(radius)
                && spot.normal.dot(&inward) > SAME_SIDE;
            if is_shared && distance < least {
                (nearest, least) = (Some(number), distance);
            }
        }
        nearest.unwrap_or_else(|| {
            let place = domain.wrap(place);
            let home = mover.map(|mover| {
                let Placement { turn, .. } = self.movers[mover].placement;
                let home = self.movers[mover].placement.home_of(&place);
                AtHome { place: home, normal: turn.tr_mul(&inward), first: home }
            });
            let spot = ChargedSpot {
                wall,
                place,
                normal: inward,
                scale: radius,
                charge: 0.0,
                first: place,
                moved: 0.0,
                keeps,
                bounds_field,
                home,
            };
            self.push(domain, spot)
        })
    }

    /// Adds the charge [C] that a contact leaves at a spot; its place is the mean over all that moved there.
    pub(super) fn leave(&mut self, domain: &Domain, number: usize, contact: &Contact, charge: f64) {
        let mover = self.mover_of(self.spots[number].wall);
        let spot = &mut self.spots[number];
        spot.charge += charge;
        spot.moved += charge.abs();
        if spot.moved > 0.0 {
            let share = charge.abs() / spot.moved;
            spot.place = domain.wrap(spot.place + domain.shortest(contact.place - spot.place) * share);
            spot.normal = (spot.normal * (1.0 - share) + contact.inward * share).normalize();
            spot.scale += (contact.radius - spot.scale) * share;
            if let (Some(home), Some(mover)) = (&mut spot.home, mover) {
                let placement = &self.movers[mover].placement;
                home.place = placement.home_of(&spot.place);
                home.normal = placement.turn.tr_mul(&spot.normal);
            }
        }
    }

    /// Field of the kept charges around a contact that leaves its own at a spot: k = 1/(4πε) [V·m/C].
    pub(super) fn felt(&self, domain: &Domain, contact: &Contact, own: usize, k: f64) -> ChargeOfInsulator {
        let inward = contact.inward;
        let mut felt = ChargeOfInsulator::default();
        for (number, spot, offset) in self.kept_near(domain, contact.place, contact.radius) {
            let side = (offset + inward * (IN_FRONT * contact.radius)).dot(&spot.normal);
            let field = spot.shape(contact.radius).field(offset, side).dot(&inward);
            felt.normal_field += k * spot.charge * field;
            if number == own {
                felt.per_charge = field.max(0.0) / (4.0 * std::f64::consts::PI);
            }
        }
        felt
    }

    /// Part of E·n [V/m] in an evaluation that the kept charges around a contact make, at a place before it
    /// [m]: point charges, and where the wall bounds the field their images, with the sign of E·n that
    /// `Mirror` has. At a grain, `is_grain`, E is that of the law already.
    pub(super) fn evaluated(
        &self,
        domain: &Domain,
        contact: &Contact,
        [place, out]: [Vector3<f64>; 2],
        image: f64,
        is_grain: bool,
        k: f64,
    ) -> f64 {
        self.kept_near(domain, contact.place, contact.radius)
            .map(|(_, spot, offset)| {
                if is_grain && !spot.bounds_field {
                    let at_grain = domain.shortest(place - spot.place);
                    let side = at_grain.dot(&spot.normal);
                    return k * spot.charge * spot.shape(0.0).field(at_grain, side).dot(&out);
                }
                let from = domain.shortest(place - spot.source(domain));
                let mut e = point_charge::field(k, spot.charge, from);
                if image != 0.0 && offset.dot(&contact.inward).abs() < BEFORE * spot.scale {
                    // The plane of the surface lies at the contact.
                    let height = (place - contact.place).dot(&out);
                    let mirrored = from - out * (2.0 * (from.dot(&out) - height));
                    e -= image * point_charge::field(k, spot.charge, mirrored);
                }
                e.dot(&out)
            })
            .sum()
    }

    /// Gain of E at a grain [V/m] where the law's field takes the place of point charges; `None` away from
    /// all spots.
    pub(super) fn softened(&self, domain: &Domain, centre: Vector3<f64>, k: f64) -> Option<Vector3<f64>> {
        let mut gained = None;
        for (_, spot, offset) in self.kept_near(domain, centre, 0.0).filter(|(_, spot, _)| !spot.bounds_field)
        {
            let by_law = spot.shape(0.0).field(offset, offset.dot(&spot.normal)) * (k * spot.charge);
            let from = domain.shortest(centre - spot.source(domain));
            *gained.get_or_insert_with(Vector3::zeros) += by_law - point_charge::field(k, spot.charge, from);
        }
        gained
    }

    /// Place and charge of every point charge in an evaluation.
    pub(super) fn sources(&self, domain: &Domain) -> impl Iterator<Item = (Vector3<f64>, f64)> {
        self.spots.iter().filter(|spot| spot.keeps).map(|spot| (spot.source(domain), spot.charge))
    }

    /// Charge per area at a spot with what its neighbours have there [C/m²].
    pub(super) fn density(&self, domain: &Domain, spot: &ChargedSpot) -> f64 {
        self.around(domain, spot.place)
            .filter(|(_, other)| other.normal.dot(&spot.normal) > SAME_SIDE)
            .map(|(_, other)| {
                let offset = domain.shortest(spot.place - other.place);
                other.charge * other.shape(0.0).density(offset.norm())
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;
    use std::f64::consts::PI;

    const LARGE: f64 = 1e-3;

    fn contact(x: f64, inward: f64, radius: f64) -> Contact {
        let (place, inward) = (Vector3::new(x, 0.0, 0.0), Vector3::z() * inward);
        Contact { wall: 0, keeps: true, bounds_field: false, place, inward, radius }
    }

    fn charged(contacts: &[(Contact, f64)]) -> (Domain, Spots) {
        let domain =
            Domain::new(Vector3::repeat(-1.0), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3]).unwrap();
        let mut spots = Spots::new(LARGE);
        for (contact, charge) in contacts {
            let number = spots.at(&domain, contact);
            spots.leave(&domain, number, contact, *charge);
        }
        (domain, spots)
    }

    #[test]
    fn small_grain_feels_what_a_large_one_left_as_from_the_large_one_s_radius() {
        let small = contact(0.0, 1.0, 0.2 * LARGE);
        let (domain, mut spots) = charged(&[(contact(0.0, 1.0, LARGE), 1.0)]);
        let own = spots.at(&domain, &small);
        let felt = spots.felt(&domain, &small, own, 1.0);
        assert_eq!((own, spots.all().len()), (1, 2));
        assert!((felt.normal_field * LARGE * LARGE - 1.0).abs() < 1e-12, "{felt:?}");
        assert!((felt.per_charge * 4.0 * PI * small.radius.powi(2) - 1.0).abs() < 1e-12, "{felt:?}");
        // And the large one what the small one leaves, from its own radius.
        spots.leave(&domain, own, &small, 1.0);
        let felt = spots.felt(&domain, &contact(0.0, 1.0, LARGE), 0, 1.0);
        assert!((felt.normal_field * LARGE * LARGE - 2.0).abs() < 1e-12, "{felt:?}");
    }

    #[test]
    fn sides_of_a_sheet_are_two_spots_and_places_close_by_are_one() {
        let at = |x: f64, side: f64| (contact(x, side, LARGE), 1.0);
        let (_, spots) = charged(&[at(0.0, 1.0), at(0.4e-3, 1.0), at(0.0, -1.0), at(1.6e-3, 1.0)]);
        let charges: Vec<f64> = spots.all().iter().map(|spot| spot.charge).collect();
        assert_eq!(charges, [2.0, 1.0, 1.0]);
        assert!((spots.all()[0].place.x - 0.2e-3).abs() < 1e-15);
    }

    #[test]
    fn grain_that_touches_feels_its_charge_from_a_radius_away() {
        let (domain, spots) = charged(&[(contact(0.0, 1.0, LARGE), 1.0)]);
        let centre = Vector3::new(0.0, 0.0, LARGE);
        let (point, _) = spots.sources(&domain).next().unwrap();
        let evaluated = point_charge::field(1.0, 1.0, centre - point);
        let e = evaluated + spots.softened(&domain, centre, 1.0).unwrap();
        assert!((e.z * LARGE * LARGE - 1.0).abs() < 1e-12, "{e}");
    }
}
