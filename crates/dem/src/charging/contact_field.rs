//! E_x: the field at a contact of everything but the colliders.
//!
//! Every evaluation of the field is asked for E at the contacts too, those that touch and those that may
//! touch before the next one. They are places without charge, at which every method gives the field of all
//! charges with all images. E_x is that field less the colliders' own, and at a wall that bounds the field
//! less the grain's own image. A grounded wall that the field does not know mirrors the others' charges in
//! its tangent plane at the contact, which doubles their normal field there.
//!
//! A contact that was not foreseen has a stand-in until the next evaluation: the mean of E at the two centres
//! without the partner's field, or at a wall E at the centre without the grain's own image.

use super::around::Toucher;
use super::{Charging, Traders, inside};
use crate::contacts::Contacts;
use crate::contacts::neighbours::{Listed, Neighbours};
use crate::contacts::walls::{ContactWalls, Touch, WallSlot};
use crate::field_stage::Extras;
use crate::motion::grains::Grains;
use amberfield_core::{Axis, Domain, Side, Vector3, WallCharging};

/// Distance before a wall at which its field is asked for, over the radius: a wall of facets may lie outside
/// the field's curved domain.
const BEFORE_WALL: f64 = 0.02;
/// A wall this close to a face of the domain, over the radius, is the face.
const SAME_FACE: f64 = 1e-6;

/// A contact at which E is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    slot: Slot,
    normal: Vector3<f64>,
    /// The colliders' own part of E·n [V/m].
    own: f64,
    factor: f64,
}

#[derive(Clone, Copy, Debug)]
enum Slot {
    Pair { chunk: usize, entry: usize },
    Wall(WallSlot),
}

impl Charging {
    /// Adds the charges of walls to what an evaluation takes.
    pub(crate) fn add_facets(&self, extras: &mut Extras) {
        for facet in self.facets.all() {
            if let Some(place) = facet.place {
                extras.push(place, facet.charge);
            }
        }
    }

    /// Adds the charges of walls and the places of contacts to `extras`. Pairs that are up to `margin` [m]
    /// apart are asked for as well: they may touch before the next evaluation. `charge` is by the set-up's
    /// order [C].
    pub(super) fn ask(
        &mut self,
        traders: Traders<'_>,
        contacts: &Contacts,
        charge: &[f64],
        margin: f64,
        extras: &mut Extras,
    ) {
        let Traders { domain, grains, .. } = traders;
        let Contacts { neighbours, walls, .. } = contacts;
        let walls = walls.as_ref();
        self.add_facets(extras);
        let mut probes = std::mem::take(&mut self.probes);
        probes.clear();
        let k = self.coulomb;
        let of = |grain: usize| charge[grains.original[grain].index()];
        Self::pairs_within(traders, neighbours, margin, |pair, offset| {
            let distance = offset.norm();
            let normal = offset / distance;
            let (a, b) = (grains.centre[pair.i][3], grains.centre[pair.j][3]);
            // The contact lies in the middle of the overlap.
            let to_i = a - 0.5 * (a + b - distance);
            let to_j = distance - to_i;
            let own = k * (of(pair.i) / (to_i * to_i) - of(pair.j) / (to_j * to_j));
            extras.push(inside(domain, grains.position(pair.i) + normal * to_i), 0.0);
            let slot = Slot::Pair { chunk: pair.chunk, entry: pair.entry };
            probes.push(Probe { slot, normal, own, factor: 1.0 });
        });
        for touch in walls.into_iter().flat_map(|walls| walls.touches(grains)) {
            if traders.member(touch.grain).is_none() {
                continue;
            }
            let Touch { grain, normal, distance, .. } = touch;
            let before = BEFORE_WALL * grains.centre[grain][3];
            let place = grains.position(grain) + normal * (distance - before);
            let charge = of(grain);
            // The image makes E·n of the same sign before a conductor, of the other before an insulator.
            let Mirror { image, factor } = mirror(domain, grains, &touch);
            let mut own =
                k * charge / (distance - before).powi(2) + image * k * charge / (distance + before).powi(2);
            if let Some((at, held)) = self.facet_of(traders, walls, &touch) {
                let from = domain.shortest(place - at);
                own += k * held * from.dot(&normal) / from.norm().powi(3);
            }
            extras.push(inside(domain, place), 0.0);
            probes.push(Probe { slot: Slot::Wall(touch.slot), normal, own, factor });
        }
        self.probes = probes;
    }

    /// Place and charge of the insulating facet that a contact touches, if it has been charged.
    fn facet_of(
        &self,
        traders: Traders<'_>,
        walls: Option<&ContactWalls>,
        touch: &Touch,
    ) -> Option<(Vector3<f64>, f64)> {
        let facet = self.facets.known(touch.wall, walls?.surface(touch), touch.place(traders.grains))?;
        Some((facet.place?, facet.charge))
    }

    /// Takes E [V/m] at what was asked for.
    pub(super) fn take(
        &mut self,
        e: &[Vector3<f64>],
        neighbours: &mut Neighbours,
        mut walls: Option<&mut ContactWalls>,
        charge: &[f64],
    ) {
        let sources = e.len() - self.probes.len();
        for (probe, e) in self.probes.iter().zip(&e[sources..]) {
            let field = probe.factor * (e.dot(&probe.normal) - probe.own);
            match (probe.slot, walls.as_mut()) {
                (Slot::Pair { chunk, entry }, _) => neighbours.lists[chunk].foreseen[entry] = Some(field),
                (Slot::Wall(slot), Some(walls)) => walls.memory_mut(slot).foreseen = Some(field),
                (Slot::Wall(_), None) => {}
            }
        }
        self.evaluated.copy_from_slice(charge);
        self.lag = 0.0;
    }

    /// E_x·n of a pair of charges [C] that was not foreseen [V/m].
    pub(super) fn unforeseen(
        &self,
        traders: Traders<'_>,
        shifts: &[[f64; 3]; 32],
        pair: Listed,
        [of_i, of_j]: [f64; 2],
    ) -> f64 {
        let offset = pair.offset(traders.grains, shifts);
        let distance2 = offset.norm_squared();
        let sum = traders.field.at(pair.i) + traders.field.at(pair.j);
        0.5 * (sum.dot(&offset) / distance2.sqrt() + self.coulomb * (of_j - of_i) / distance2)
    }

    /// E_x·n of a contact with a wall that was not foreseen [V/m].
    pub(super) fn unforeseen_at_wall(&self, traders: Traders<'_>, touch: &Touch, charge: &[f64]) -> f64 {
        let field = traders.field.at(touch.grain).dot(&touch.normal);
        let own = charge[traders.grains.original[touch.grain].index()];
        let Mirror { image, factor } = mirror(traders.domain, traders.grains, touch);
        factor * (field - image * self.coulomb * own / (4.0 * touch.distance * touch.distance))
    }

    /// Change of E·n since the last evaluation, at a distance `reach` [m] along `normal` from grain i, made
    /// by the grains that touch i or its partner. `charge` gives that of a sorted index [C].
    pub(super) fn gained_beside(
        &self,
        grains: &Grains,
        i: usize,
        partner: &Toucher,
        normal: Vector3<f64>,
        reach: f64,
        charge: impl Fn(usize) -> f64,
    ) -> f64 {
        let mut sum = 0.0;
        self.around.beside(i, partner, |grain, offset| {
            let from = normal * reach - offset;
            let original = grains.original[grain].index();
            let gained = charge(grain) - self.evaluated[original];
            sum += gained * from.dot(&normal) / from.norm().powi(3);
        });
        self.coulomb * sum
    }
}

/// Effect of a wall on the field of a grain and of the others at their contact.
struct Mirror {
    /// Sign of E·n of the grain's own image in the field, as of [`image_sign`].
    image: f64,
    /// Factor of the others' E·n: a grounded wall that the field does not know doubles it.
    factor: f64,
}

fn mirror(domain: &Domain, grains: &Grains, touch: &Touch) -> Mirror {
    let image = image_sign(domain, grains, touch);
    let unknown_conductor = touch.charging == WallCharging::Grounded && image == 0.0;
    Mirror { image, factor: if unknown_conductor { 2.0 } else { 1.0 } }
}

/// Sign of the E·n that the grain's own image makes where the touched wall bounds the field: 1 for a
/// conductor, −1 for an insulator, 0 where the field does not know the wall.
fn image_sign(domain: &Domain, grains: &Grains, touch: &Touch) -> f64 {
    if touch.bounds_field {
        return if touch.charging == WallCharging::Insulating { -1.0 } else { 1.0 };
    }
    let place = touch.place(grains);
    let slack = SAME_FACE * grains.centre[touch.grain][3];
    let of_face = |axis: Axis, side: Side| {
        let (corner, out) = match side {
            Side::Min => (domain.min(), -1.0),
            Side::Max => (domain.max(), 1.0),
        };
        let axis_index = axis.index();
        let is_it = out * touch.normal[axis_index] > 1.0 - SAME_FACE
            && (place[axis_index] - corner[axis_index]).abs() < slack;
        match domain.face(axis, side) {
            face if is_it && face.is_conductor() => 1.0,
            face if is_it && face.is_insulating() => -1.0,
            _ => 0.0,
        }
    };
    Axis::ALL.into_iter().flat_map(|axis| [Side::Min, Side::Max].map(|side| of_face(axis, side))).sum()
}
