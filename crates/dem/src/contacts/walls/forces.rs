//! Forces of walls on the grains of a chunk, and contacts that are the same from step to step.

use super::movers::{Met as Moving, Movers};
use super::parts::Part;
use super::{ChunkWalls, Met, NearTriangle, WallContact, WallLoad, touches};
use crate::contacts::cells::NO_SHIFT;
use crate::contacts::law::{Contact, History, Response, respond};
use crate::contacts::material_pairs::{PairConstants, PairTable};
use crate::contacts::normal::{Elastic, Hertz, NormalLaw};
use crate::contacts::walls::surfaces::{ClosestPoint, Found, MOST_CONTACTS, Surfaces};
use crate::motion::chunks::{CHUNK, ChunkLoads};
use crate::motion::grains::Grains;
use amberfield_core::{RollingModel, Vector3};

/// Cosine of the largest turn between two steps for which a contact is still the same (60°).
pub(crate) const SAME_CONTACT: f64 = 0.5;

/// Data that every chunk reads.
#[derive(Clone, Copy)]
pub(super) struct Scene<'a> {
    pub(super) surfaces: &'a Surfaces,
    pub(super) parts: &'a [Part],
    pub(super) shifts: &'a [[f64; 3]; 32],
    pub(super) grains: &'a Grains,
    pub(super) table: &'a PairTable,
    pub(super) rolling_model: RollingModel,
    /// Bound on the stretch of any contact [m]; 0 where none stretches.
    pub(super) stretch: f64,
    /// Walls that move.
    pub(super) movers: Option<&'a Movers>,
    /// Step by which springs advance [s].
    pub(super) step: f64,
}

impl ChunkWalls {
    /// Forgets what the last evaluation found, for a number of walls.
    fn begin(&mut self, walls: usize) {
        self.met.clear();
        (self.deepest, self.power) = (0.0, 0.0);
        self.loads.clear();
        self.loads.resize(if self.entries.is_empty() { 0 } else { walls }, WallLoad::default());
    }

    /// Adds what walls do to the grains of chunk `k`.
    pub(super) fn forces<
        L: NormalLaw,
        const FRICTION: bool,
        const ROLLING: bool,
        const DAMPING: bool,
        const MOVING: bool,
    >(
        &mut self,
        k: usize,
        scene: &Scene<'_>,
        loads: ChunkLoads<'_>,
    ) {
        let &Scene { surfaces, parts, shifts, grains, table, rolling_model, movers, step, .. } = scene;
        self.begin(parts.len());
        let Self { entries, triangles, contacts, growth, scratch, met, loads: on_walls, deepest, power } =
            self;
        for entry in entries {
            let local = entry.local as usize;
            let i = k * CHUNK + local;
            let (centre, radius) = (grains.position(i), grains.centre[i][3]);
            let mut found = [Found::default(); MOST_CONTACTS];
            let near = &triangles[entry.triangles.start as usize..entry.triangles.end as usize];
            let image = |near: &NearTriangle| centre + Vector3::from(shifts[near.shift as usize]);
            let places = near.iter().map(|near| (near.triangle, image(near)));
            let kept = &mut contacts[entry.contacts as usize..];
            let count = find::<L>(scene, i, places, &kept[..entry.count as usize], scratch, &mut found);
            let from = renew(kept, entry.count as usize, &found[..count]);
            if !growth.is_empty() {
                touches::renew(&mut growth[entry.contacts as usize..], &from[..count]);
            }
            entry.count = count as u32;
            met.extend(begun(scene, i, &kept[..count], &from));
            for (wall_contact, found) in kept[..count].iter_mut().zip(&found) {
                let surface = surfaces.surface_of(wall_contact.triangle);
                let part = &parts[surface];
                let pair = table.get(grains.material[i], part.material);
                let (mut contact, arm) = contact_of::<FRICTION, ROLLING>(grains, i, wall_contact);
                let mut history = History::stored(wall_contact.spring, wall_contact.rolling);
                let moving = movers.filter(|_| MOVING).and_then(|movers| movers.of(surface)).map(|mover| {
                    let shift = shift_of(near, wall_contact.triangle);
                    let place = centre + Vector3::from(shifts[shift as usize]) + contact.normal * arm;
                    mover.meet(&mut contact, &mut history, &place, arm, step)
                });
                let work = if L::COHESIVE { table.work(grains.material[i], part.material) } else { 0.0 };
                let elastic = elastic::<L>(found, radius, pair, work);
                let response = respond::<_, L, FRICTION, ROLLING, DAMPING>(
                    &contact,
                    &elastic,
                    pair,
                    rolling_model,
                    step,
                    &mut history,
                );
                (wall_contact.spring, wall_contact.rolling) = history.to_store();
                *deepest = deepest.max(wall_contact.overlap / radius);
                let lean = lean::<L>(pair, radius, found, work);
                loads.force[local] += response.force - lean;
                if let Some(moving) = moving {
                    *power += power_of(&response, &lean, &moving);
                }
                on_walls[part.wall as usize].add_contact(wall_contact, &response, lean, centre, arm);
                if FRICTION || ROLLING {
                    loads.torque[local] += response.twist * arm + response.rolling;
                }
                if DAMPING || ROLLING {
                    loads.slowing[local] += response.damping * grains.inverse_mass[i];
                }
            }
        }
    }
}

/// Force that a contact lacks where it joins a deeper one: it pushes away from its own place and pulls to
/// where they join [N].
#[inline(always)]
fn lean<L: NormalLaw>(pair: &PairConstants<f64>, radius: f64, found: &Found, work: f64) -> Vector3<f64> {
    if L::COHESIVE && found.joined > 0.0 {
        return found.lean * L::elastic(found.joined, radius, pair, work).load;
    }
    found.lean * Hertz::elastic(found.joined, radius, pair, work).load
}

/// Elastic state of a contact; of a cohesive one less that of the line where it joins a deeper one.
#[inline(always)]
fn elastic<L: NormalLaw>(found: &Found, radius: f64, pair: &PairConstants<f64>, work: f64) -> Elastic<f64> {
    let own = L::elastic(found.overlap, radius, pair, work);
    if !L::COHESIVE || found.joined <= 0.0 {
        return own;
    }
    let line = L::elastic(found.joined, radius, pair, work);
    let share = (1.0 - (line.contact_radius / own.contact_radius).powi(2)).max(0.0);
    Elastic {
        contact_radius: own.contact_radius * share.sqrt(),
        load: own.load - line.load,
        grip: own.grip * share,
    }
}

/// Finds the contacts of grain `i` with what is near it, after those `before`; returns how many there are.
#[inline(always)]
fn find<L: NormalLaw>(
    scene: &Scene<'_>,
    i: usize,
    near: impl Iterator<Item = (u32, Vector3<f64>)>,
    before: &[WallContact],
    scratch: &mut Vec<ClosestPoint>,
    found: &mut [Found; MOST_CONTACTS],
) -> usize {
    let &Scene { surfaces, parts, grains, table, stretch, .. } = scene;
    let radius = grains.centre[i][3];
    if !L::COHESIVE {
        return surfaces.contacts(radius, near, scratch, found);
    }
    let count = surfaces.contacts(radius + stretch, near, scratch, found);
    let holds = |found: &Found| {
        let material = parts[surfaces.surface_of(found.triangle)].material;
        let own = table.stretch(grains.material[i], material, radius);
        let is_old = |old: &WallContact| old.normal.dot(&found.normal) > SAME_CONTACT;
        found.overlap > 0.0 || (found.overlap > -own && before.iter().any(is_old))
    };
    sticking(found, count, stretch, holds)
}

/// Keeps what holds among the contacts of a sphere that is larger by `stretch` [m] than the grain, with the
/// grain's own overlaps, which are negative where a contact is stretched. Returns how many there are.
fn sticking(
    found: &mut [Found; MOST_CONTACTS],
    count: usize,
    stretch: f64,
    holds: impl Fn(&Found) -> bool,
) -> usize {
    let mut kept = 0;
    for number in 0..count {
        let Found { normal, lean, triangle, .. } = found[number];
        let (overlap, joined) = (found[number].depth() - stretch, found[number].joined - stretch);
        let lean = if joined > 0.0 { lean } else { Vector3::zeros() };
        let contact = Found { normal, overlap, joined: joined.max(0.0), lean, triangle };
        if holds(&contact) {
            found[kept] = contact;
            kept += 1;
        }
    }
    kept
}

/// Contacts of grain `i` that are new, by which of the old ones each was.
fn begun<'a>(
    scene: &'a Scene<'_>,
    i: usize,
    contacts: &'a [WallContact],
    from: &'a [Option<usize>],
) -> impl Iterator<Item = Met> + 'a {
    let new = contacts.iter().zip(from).filter(|(_, from)| from.is_none());
    new.map(move |(contact, _)| {
        let part = &scene.parts[scene.surfaces.surface_of(contact.triangle)];
        Met { grain: i, normal: contact.normal, bounds_field: part.bounds_field }
    })
}

/// Power that a wall which moves gives to a grain [W].
fn power_of(response: &Response<f64>, lean: &Vector3<f64>, moving: &Moving) -> f64 {
    response.force.dot(&moving.contact) - lean.dot(&moving.centre) + response.rolling.dot(&moving.spin)
}

/// Code of the shift of the grain's image that touches a triangle.
fn shift_of(near: &[NearTriangle], triangle: u32) -> u32 {
    near.iter().find(|near| near.triangle == triangle).map_or(NO_SHIFT, |near| near.shift)
}

/// Geometry and motion of a grain's contact with a wall at rest, and the centre's distance from it.
#[inline(always)]
fn contact_of<const FRICTION: bool, const ROLLING: bool>(
    grains: &Grains,
    i: usize,
    found: &WallContact,
) -> (Contact<f64>, f64) {
    let (radius, inverse_mass) = (grains.centre[i][3], grains.inverse_mass[i]);
    let arm = radius - found.overlap;
    let turning = if FRICTION || ROLLING { grains.angular[i] } else { Vector3::zeros() };
    let contact = Contact {
        normal: found.normal,
        velocity: grains.velocity[i],
        forecast: grains.forecast[i],
        spin: turning * arm,
        turning,
        radius,
        inverse_mass,
        inverse_moment: inverse_mass / (radius * radius),
        slowing: grains.slowing[i],
    };
    (contact, arm)
}

/// Replaces the contacts of the last step by those found now; springs go to the nearest direction. Returns
/// which of the old contacts each one was.
fn renew(kept: &mut [WallContact], old_count: usize, found: &[Found]) -> [Option<usize>; MOST_CONTACTS] {
    let mut old = [WallContact::default(); MOST_CONTACTS];
    old[..old_count].copy_from_slice(&kept[..old_count]);
    let mut unused = [true; MOST_CONTACTS];
    let mut from = [None; MOST_CONTACTS];
    for ((kept, found), from) in kept.iter_mut().zip(found).zip(&mut from) {
        let Found { normal, overlap, joined, triangle, .. } = *found;
        *kept = WallContact { normal, overlap, joined, triangle, ..WallContact::default() };
        *from = best_match(&old[..old_count], &unused, &normal);
        if let Some(m) = *from {
            unused[m] = false;
            (kept.spring, kept.rolling) = (old[m].spring, old[m].rolling);
        }
    }
    from
}

/// The unused old contact whose direction is nearest.
fn best_match(old: &[WallContact], unused: &[bool; MOST_CONTACTS], normal: &Vector3<f64>) -> Option<usize> {
    let mut best = None;
    let mut cosine = SAME_CONTACT;
    for (m, contact) in old.iter().enumerate() {
        let c = contact.normal.dot(normal);
        if unused[m] && c > cosine {
            (best, cosine) = (Some(m), c);
        }
    }
    best
}
