//! E_x: the field at a contact of everything but the colliders.
//!
//! Every evaluation of the field is asked for E at the contacts too, those that touch and those that may
//! touch before the next one. They are places without charge, at which every method gives the field of all
//! charges with all images. E_x is that field less the colliders' own, and at a wall that bounds the field
//! less the grain's own image. A grounded wall that the field does not know mirrors the others' charges in
//! its tangent plane at the contact, which doubles their normal field there. What is there without charges,
//! an external field or that of electrodes, has no images and stays as it is.
//!
//! Between evaluations E_x follows the line through the last two, where both foresaw the contact, to the
//! middle of the time in which the area grew. A part that changes with time and is the same everywhere is not
//! on that line: it is added as it was in the middle of that time.
//!
//! A contact that was not foreseen has a stand-in until the next evaluation: the mean of E at the two centres
//! without the partner's field, or at a wall E at the centre without the grain's own image.

use super::around::Toucher;
use super::spots::Contact;
use super::{Charging, Traders, inside};
use crate::contacts::Contacts;
use crate::contacts::memory::Foreseen;
use crate::contacts::neighbours::{Listed, Neighbours};
use crate::contacts::walls::Touch;
use crate::field_stage::{Extras, FieldStage};
use crate::motion::grains::{Grains, Original};
use amberfield_core::{Domain, Vector3, WallCharging};
use serde::{Deserialize, Serialize};

/// Distance before a wall at which its field is asked for, over the radius: a wall of facets may lie outside
/// the field's curved domain.
const BEFORE_WALL: f64 = 0.02;

/// Cosine of the largest turn for which a contact with a wall is the one that was foreseen (60°).
const SAME_CONTACT: f64 = 0.5;

/// A contact at which E is asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    slot: Slot,
    normal: Vector3<f64>,
    /// The colliders' own part of E·n [V/m].
    own: f64,
    mirror: Mirror,
}

#[derive(Clone, Copy, Debug)]
enum Slot {
    Pair { chunk: usize, entry: usize },
    Wall(Original),
}

/// Contact with a wall that an evaluation foresaw.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct AtWall {
    grain: Original,
    /// Direction from the grain to the wall.
    normal: Vector3<f64>,
    foreseen: Foreseen,
}

/// Contact of a grain in the direction that is nearest to a normal, among contacts sorted by grain.
fn at_wall(contacts: &[AtWall], grain: Original, normal: &Vector3<f64>) -> Option<Foreseen> {
    let from = contacts.partition_point(|contact| contact.grain < grain);
    let of_grain = contacts[from..].iter().take_while(|contact| contact.grain == grain);
    let cosines = of_grain.map(|contact| (contact.normal.dot(normal), contact.foreseen));
    let nearest = cosines.max_by(|(a, _), (b, _)| a.total_cmp(b));
    nearest.filter(|(cosine, _)| *cosine > SAME_CONTACT).map(|(_, foreseen)| foreseen)
}

impl Charging {
    /// Adds the charges of walls to what an evaluation takes.
    pub(crate) fn add_spots(&self, domain: &Domain, extras: &mut Extras) {
        self.spots.sources(domain).for_each(|(place, charge)| extras.push(place, charge));
    }

    /// Adds what E at grains gains by the law of kept charge.
    fn soften(&self, traders: Traders<'_>, extras: &mut Extras) {
        if !self.spots.all().is_empty() {
            let grains = traders.grains;
            for grain in (0..grains.len()).filter(|&grain| traders.member(grain).is_some()) {
                let gained = self.spots.softened(traders.domain, grains.position(grain), self.coulomb);
                extras.gained.extend(gained.map(|e| (grain as u32, e)));
            }
        }
    }

    /// Adds the charges of walls and the places of contacts to `extras`. Pairs, and grains and walls, that
    /// are up to given margins [m] apart are asked for as well: they may touch before the next evaluation.
    /// `charge` is by the set-up's order [C].
    pub(super) fn ask(
        &mut self,
        traders: Traders<'_>,
        contacts: &Contacts,
        charge: &[f64],
        [of_pairs, of_walls]: [f64; 2],
        extras: &mut Extras,
    ) {
        let Traders { domain, grains, .. } = traders;
        let Contacts { neighbours, walls, .. } = contacts;
        let walls = walls.as_ref();
        self.add_spots(domain, extras);
        self.soften(traders, extras);
        let mut probes = std::mem::take(&mut self.probes);
        probes.clear();
        let k = self.coulomb;
        let of = |grain: usize| charge[grains.original[grain].index()];
        Self::pairs_within(traders, neighbours, of_pairs, |pair, offset| {
            let distance = offset.norm();
            let normal = offset / distance;
            let (a, b) = (grains.centre[pair.i][3], grains.centre[pair.j][3]);
            // The contact lies in the middle of the overlap.
            let to_i = a - 0.5 * (a + b - distance);
            let to_j = distance - to_i;
            let own = k * (of(pair.i) / (to_i * to_i) - of(pair.j) / (to_j * to_j));
            extras.push(inside(domain, grains.position(pair.i) + normal * to_i), 0.0);
            let slot = Slot::Pair { chunk: pair.chunk, entry: pair.entry };
            probes.push(Probe { slot, normal, own, mirror: Mirror::NONE });
        });
        let touching = walls.into_iter().flat_map(|walls| walls.touches(grains));
        let upcoming = walls.into_iter().flat_map(|walls| walls.upcoming(domain, grains, of_walls));
        for touch in touching.map(|touching| touching.touch).chain(upcoming) {
            if traders.member(touch.grain).is_none() {
                continue;
            }
            let Touch { grain, normal, distance, .. } = touch;
            let original = grains.original[grain];
            let before = BEFORE_WALL * grains.centre[grain][3];
            let place = grains.position(grain) + normal * (distance - before);
            let charge = of(grain);
            // The image makes E·n of the same sign before a conductor, of the other before an insulator.
            let mirror = Mirror::of(traders, &touch, place);
            let mut own = k * charge / (distance - before).powi(2)
                + mirror.image * k * charge / (distance + before).powi(2);
            if touch.charging == WallCharging::Insulating {
                let contact = Contact::of(traders, &touch);
                own += self.spots.evaluated(domain, &contact, [place, normal], mirror.image, false, k);
            }
            extras.push(inside(domain, place), 0.0);
            probes.push(Probe { slot: Slot::Wall(original), normal, own, mirror });
        }
        self.probes = probes;
    }

    /// Takes E at what was asked for.
    pub(super) fn take(&mut self, field: &FieldStage, neighbours: &mut Neighbours, charge: &[f64]) {
        let (e, changing) = (field.beside(), field.changing_uniform_before(0.0));
        let sources = e.len() - self.probes.len();
        self.evaluation += 1;
        let (evaluation, age) = (self.evaluation, std::mem::take(&mut self.age));
        let mut at_walls = Vec::with_capacity(self.at_walls.len());
        for (probe, e) in self.probes.iter().zip(&e[sources..]) {
            let field = probe.mirror.of_others(e.dot(&probe.normal) - probe.own);
            let field = changing.map_or(field, |changing| field - changing.dot(&probe.normal));
            match probe.slot {
                Slot::Pair { chunk, entry } => {
                    let known = &mut neighbours.lists[chunk].foreseen[entry];
                    *known = Foreseen::new(field, evaluation, Some(*known), age);
                }
                Slot::Wall(grain) => {
                    let known = at_wall(&self.at_walls, grain, &probe.normal);
                    let foreseen = Foreseen::new(field, evaluation, known, age);
                    at_walls.push(AtWall { grain, normal: probe.normal, foreseen });
                }
            }
        }
        at_walls.sort_by_key(|contact| contact.grain);
        self.at_walls = at_walls;
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

    /// E_x·n of a contact with a wall [V/m] in the middle of the step, if it was foreseen.
    pub(super) fn foreseen_at_wall(&self, traders: Traders<'_>, touch: &Touch) -> Option<f64> {
        let grain = traders.grains.original[touch.grain];
        let field =
            at_wall(&self.at_walls, grain, &touch.normal)?.at(self.evaluation, self.age as f64 - 0.5)?;
        let changing = traders.field.changing_uniform_before(0.5);
        Some(changing.map_or(field, |changing| field + changing.dot(&touch.normal)))
    }

    /// E_x·n of a contact with a wall that was not foreseen [V/m].
    pub(super) fn unforeseen_at_wall(&self, traders: Traders<'_>, touch: &Touch, charge: &[f64]) -> f64 {
        let field = traders.field.at(touch.grain).dot(&touch.normal);
        let own = charge[traders.grains.original[touch.grain].index()];
        let mirror = Mirror::of(traders, touch, traders.grains.position(touch.grain));
        let image = mirror.image * self.coulomb * own / (4.0 * touch.distance * touch.distance);
        let mut others = field - image;
        if touch.charging == WallCharging::Insulating {
            let (contact, centre) = (Contact::of(traders, touch), traders.grains.position(touch.grain));
            let [at, out] = [centre, touch.normal];
            others -=
                self.spots.evaluated(traders.domain, &contact, [at, out], mirror.image, true, self.coulomb);
        }
        mirror.of_others(others)
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
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirror {
    /// Sign of E·n of the grain's own image where the wall bounds the field: 1 for a conductor, −1 for an
    /// insulator, 0 where the field does not know the wall.
    image: f64,
    /// E·n that is there without charges [V/m] and has no images, where a grounded wall that the field does
    /// not know doubles that of the others.
    unmirrored: Option<f64>,
}

impl Mirror {
    /// No wall.
    const NONE: Self = Self { image: 0.0, unmirrored: None };

    /// Effect of a touched wall at a place where E is known [m].
    fn of(traders: Traders<'_>, touch: &Touch, place: Vector3<f64>) -> Self {
        let Traders { domain, grains, field } = traders;
        let image = Self::image(domain, grains, touch);
        let doubles = touch.charging == WallCharging::Grounded && image == 0.0;
        let unmirrored =
            doubles.then(|| field.source.field.without_charges(&inside(domain, place)).dot(&touch.normal));
        Self { image, unmirrored }
    }

    /// Sign of E·n of the grain's own image.
    pub(super) fn image(domain: &Domain, grains: &Grains, touch: &Touch) -> f64 {
        if touch.bounds_field {
            return if touch.charging == WallCharging::Insulating { -1.0 } else { 1.0 };
        }
        match domain.face_under(&touch.place(grains), &touch.normal) {
            Some(face) if face.is_conductor() => 1.0,
            Some(face) if face.is_insulating() => -1.0,
            _ => 0.0,
        }
    }

    /// E_x·n from that of the field without the colliders [V/m].
    fn of_others(self, field: f64) -> f64 {
        field + self.unmirrored.map_or(0.0, |unmirrored| field - unmirrored)
    }
}
