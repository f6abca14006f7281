//! Overlaps: looked at at the start, and watched in every step.

use super::Simulation;
use super::earlier::Carried;
use crate::contacts::neighbours::Listed;
use crate::contacts::walls::{ContactWalls, TouchingWall};
use crate::contacts::{Contacts, Depths};
use crate::error::DemError;

/// Largest overlap over the smaller radius that a run may have: soft impacts reach 0.6. In walls it is less
/// where grains are fast: with the way of the next step it must not bring a centre into a wall.
const DEEPEST: f64 = 0.8;
/// Largest overlap over the smaller radius at the start, unless more is allowed: a hundredth, and what
/// decimals of a file leave.
const DEEPEST_AT_START: f64 = 0.010_001;

/// A contact with a large overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Deepest {
    /// Id of the grain.
    pub id: u64,
    /// Grain or wall that it overlaps, in words.
    pub partner: String,
    /// Overlap [m].
    pub overlap_m: f64,
    /// Overlap over the smaller radius.
    pub share: f64,
}

/// Largest overlaps over the smaller radius that a run may have whose contacts begin with others: those of
/// grains do not matter where a scene allows overlaps; in walls it is half of the way to where a grain's
/// centre is in the wall.
pub(super) fn allowed(begin: Depths, allow_overlap: bool) -> Depths {
    Depths {
        grains: if allow_overlap { f64::INFINITY } else { DEEPEST },
        walls: if begin.walls > DEEPEST { 0.5 * (1.0 + begin.walls) } else { DEEPEST },
    }
}

impl Simulation {
    /// The touching contact with the largest overlap over the smaller radius; `None` without contacts.
    #[must_use]
    pub fn deepest(&self) -> Option<Deepest> {
        self.deepest_of(None)
    }

    /// [`Self::deepest`] of the contacts that are not from another run.
    fn deepest_of(&self, carried: Option<&Carried>) -> Option<Deepest> {
        let found = self.deepest_pair(carried).into_iter().chain(self.deepest_in_wall(carried));
        found.max_by(|a, b| a.share.total_cmp(&b.share))
    }

    /// The deepest contact of two grains that is not from another run.
    fn deepest_pair(&self, carried: Option<&Carried>) -> Option<Deepest> {
        let (grains, neighbours) = (&self.grains, &self.contacts.neighbours);
        let depth = |pair: &Listed| {
            let (a, b) = (grains.centre[pair.i][3], grains.centre[pair.j][3]);
            let overlap_m = a + b - pair.distance(grains, &neighbours.shifts);
            (overlap_m, overlap_m / a.min(b))
        };
        let new = neighbours.touching().filter(|pair| !self.is_carried_pair(carried, pair));
        let pair = new.max_by(|a, b| depth(a).1.total_cmp(&depth(b).1))?;
        let (overlap_m, share) = depth(&pair);
        let (one, other) = (self.id_of(pair.i), self.id_of(pair.j));
        Some(Deepest { id: one.min(other), partner: format!("grain {}", one.max(other)), overlap_m, share })
    }

    /// The deepest contact of a grain with a wall that is not from another run.
    fn deepest_in_wall(&self, carried: Option<&Carried>) -> Option<Deepest> {
        let share = |touching: &TouchingWall<'_>| touching.overlap / self.grains.centre[touching.grain][3];
        let touching = self.contacts.walls.iter().flat_map(ContactWalls::touching);
        let new = touching.filter(|touching| !self.is_carried_to_wall(carried, touching));
        let deepest = new.max_by(|a, b| share(a).total_cmp(&share(b)))?;
        Some(Deepest {
            id: self.id_of(deepest.grain),
            partner: format!("wall '{}'", deepest.name),
            overlap_m: deepest.overlap,
            share: share(&deepest),
        })
    }

    /// Largest overlaps of the contacts as they are, computed anew.
    pub(super) fn depths(&self) -> Depths {
        let share = |found: Option<Deepest>| found.map_or(0.0, |deepest| deepest.share);
        Depths { grains: share(self.deepest_pair(None)), walls: share(self.deepest_in_wall(None)) }
    }

    /// Whether a pair touched in another run already.
    fn is_carried_pair(&self, carried: Option<&Carried>, pair: &Listed) -> bool {
        let original = |i: usize| self.grains.original[i];
        carried.is_some_and(|carried| carried.has_pair([original(pair.i), original(pair.j)]))
    }

    /// Whether a contact with a wall was as deep in another run already.
    fn is_carried_to_wall(&self, carried: Option<&Carried>, touching: &TouchingWall<'_>) -> bool {
        let grain = self.grains.original[touching.grain];
        carried.is_some_and(|carried| carried.has_wall(grain, &touching.normal, touching.overlap))
    }

    /// Id of the grain of a sorted index.
    fn id_of(&self, index: usize) -> u64 {
        self.particles.id[self.grains.original[index].index()]
    }

    /// Refuses overlaps at the start that are not allowed, and tells of the largest of the others. Those that
    /// another run had are.
    pub(super) fn check_overlaps(&mut self, carried: Option<&Carried>) -> Result<(), DemError> {
        let depths = self.contacts.depths();
        let was_deep = carried.is_some() && depths.grains > DEEPEST;
        self.allowed = allowed(depths, self.time.allow_overlap || was_deep);
        let new = self.deepest_of(carried).filter(|new| new.share > DEEPEST_AT_START);
        if let Some(Deepest { id, partner, overlap_m, share }) = new.filter(|_| !self.time.allow_overlap) {
            let count = self.shares(carried).filter(|share| *share > DEEPEST_AT_START).count();
            return Err(DemError::Overlap { count, id, partner, overlap_m, share });
        }
        let Some(Deepest { id, partner, overlap_m, share }) = self.deepest() else { return Ok(()) };
        tracing::info!(
            "{} contacts at the start; the largest overlap is {overlap_m:.3e} m, {share:.2e} of a radius, of \
             grain {id} and {partner}",
            self.contacts()
        );
        Ok(())
    }

    /// Ends the run where a contact is too deep: its grain may pass through.
    pub(super) fn watch_overlaps(&mut self) -> Result<(), DemError> {
        let Depths { grains, walls } = self.contacts.depths();
        let pace = self.progress.pace + self.limits.pace_of_walls();
        let deepest_now = 1.0 - self.progress.step_s * pace;
        let allowed = Depths { walls: self.allowed.walls.min(deepest_now), ..self.allowed };
        if walls <= DEEPEST {
            // Contacts that began deeper have come out of it.
            self.allowed.walls = DEEPEST;
        }
        let is_wall = walls > allowed.walls;
        if !is_wall && grains <= allowed.grains {
            return Ok(());
        }
        let (deepest, limit) = if is_wall {
            (self.deepest_in_wall(None), allowed.walls)
        } else {
            (self.deepest_pair(None), allowed.grains)
        };
        let Some(Deepest { id, partner, overlap_m, share }) = deepest else { return Ok(()) };
        let i = (0..self.grains.len()).find(|&i| self.id_of(i) == id);
        let i = i.expect("a grain that touches is there");
        Err(DemError::TooDeep {
            id,
            position_m: self.domain.wrap(self.grains.position(i)),
            velocity_m_s: self.grains.velocity[i],
            partner,
            overlap_m,
            share,
            limit,
            time_s: self.progress.time_s(),
        })
    }

    /// Overlaps over the smaller radius of all touching contacts that are not from another run.
    fn shares<'a>(&'a self, carried: Option<&'a Carried>) -> impl Iterator<Item = f64> + 'a {
        let (grains, Contacts { neighbours, walls, .. }) = (&self.grains, &self.contacts);
        let new = neighbours.touching().filter(move |pair| !self.is_carried_pair(carried, pair));
        let pairs = new.map(move |pair| {
            let (a, b) = (grains.centre[pair.i][3], grains.centre[pair.j][3]);
            (a + b - pair.distance(grains, &neighbours.shifts)) / a.min(b)
        });
        let touching = walls.iter().flat_map(ContactWalls::touching);
        let touching = touching.filter(move |touching| !self.is_carried_to_wall(carried, touching));
        pairs.chain(touching.map(move |touching| touching.overlap / grains.centre[touching.grain][3]))
    }
}
