//! Loose grains: those that came while the run goes on and have been alone since.
//!
//! A list of such a grain would be empty. It goes without one until another grain or a wall is near: as long
//! as it is alone, only the place from which its way is counted is taken anew.

use crate::contacts::Contacts;
use crate::contacts::cells::images;
use crate::contacts::neighbours::{ChunkList, Neighbours};
use crate::contacts::walls::ContactWalls;
use crate::motion::chunks::chunk_count;
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Vector3};
use std::ops::Range;

/// Loose grains that there are at most: they are compared with each other.
pub(crate) const MOST_LOOSE: usize = 256;
/// Share of the radii by which grains that come stay off each other, walls and a region's ends: round-off
/// makes no contact.
pub(crate) const GAP: f64 = 1e-6;

impl Contacts {
    /// Sorted indices of the loose grains.
    pub(crate) fn loose(&self) -> Range<usize> {
        self.neighbours.listed..self.neighbours.reference.len()
    }

    /// Takes in the grain after the last, which is alone.
    pub(crate) fn append(&mut self, grains: &Grains) {
        let Neighbours { reference, lists, inbox, .. } = &mut self.neighbours;
        reference.push(grains.position(reference.len()));
        let count = reference.len();
        let chunks = chunk_count(count);
        lists.resize_with(chunks, || ChunkList { start: vec![0], ..ChunkList::default() });
        inbox.resize_with(chunks, Vec::new);
        let list = &mut lists[chunks - 1];
        list.start.push(list.partner.len() as u32);
        if let Some(walls) = &mut self.walls {
            walls.append(count);
        }
    }

    /// Distance of surfaces [m] from which on a grain is alone, where no grain has moved by more than
    /// `travel` [m] since lists were built: lists need their skin between the places where ways begin.
    pub(crate) fn clear(&self, travel: f64) -> f64 {
        let travel_of_walls = self.walls.as_ref().map_or(0.0, ContactWalls::travel);
        self.neighbours.cells.skin() + travel.max(travel_of_walls)
    }

    /// Whether a grain is `clear` [m] of all listed grains and of walls, which must be where they are.
    pub(crate) fn is_alone(&self, domain: &Domain, centre: &[f64; 4], clear: f64) -> bool {
        self.listed_near(domain, centre, clear).is_empty() && !self.walls_are_near(domain, centre, clear)
    }

    /// Whether a grain touches a listed grain or a wall, or is behind a plane. From walls that move it must
    /// stay by the lists' `skin` [m], within which they are where the lists know them.
    pub(crate) fn touch(&self, domain: &Domain, grains: &Grains, centre: &[f64; 4], skin: f64) -> bool {
        let [x, y, z, radius] = *centre;
        let is_touched = |&index: &usize| {
            let apart = (radius + grains.centre[index][3]) * (1.0 + GAP);
            let way = grains.position(index) - Vector3::new(x, y, z);
            domain.shortest(way).norm_squared() < apart * apart
        };
        let some_move = self.walls.as_ref().is_some_and(|walls| walls.move_at_all());
        self.listed_near(domain, centre, self.neighbours.cells.skin()).iter().any(is_touched)
            || self.walls_are_near(domain, centre, if some_move { skin } else { 0.0 })
    }

    /// Sorted indices of the loose grains that are alone now; see [`Self::clear`].
    pub(crate) fn still_alone(&mut self, domain: &Domain, grains: &Grains, travel: f64) -> Vec<usize> {
        if self.loose().is_empty() {
            return Vec::new();
        }
        if let Some(walls) = &mut self.walls {
            walls.settle();
        }
        let clear = self.clear(travel);
        let is_clear_of = |i: usize, j: usize| {
            let apart = grains.centre[i][3] + grains.centre[j][3] + clear;
            domain.shortest(grains.position(i) - grains.position(j)).norm_squared() >= apart * apart
        };
        // Grains that have just come may not be known to the lists.
        let others = self.neighbours.listed..grains.len();
        let is_clear = |&i: &usize| others.clone().all(|j| j == i || is_clear_of(i, j));
        self.loose().filter(is_clear).filter(|&i| self.is_alone(domain, &grains.centre[i], clear)).collect()
    }

    /// Counts the ways of loose grains that are alone from where they are now; see [`Self::clear`].
    pub(crate) fn renew_loose(&mut self, domain: &Domain, grains: &mut Grains, travel: f64) {
        for i in self.still_alone(domain, grains, travel) {
            // Nothing knows a loose grain by one of its images.
            let centre = domain.wrap(grains.position(i));
            grains.centre[i][..3].copy_from_slice(centre.as_slice());
            self.neighbours.reference[i] = centre;
        }
    }

    /// Sorted indices of the listed grains whose surfaces were nearer than a gap [m] when lists were built.
    fn listed_near(&self, domain: &Domain, centre: &[f64; 4], gap: f64) -> Vec<usize> {
        let cells = &self.neighbours.cells;
        let [x, y, z, radius] = *centre;
        let reach = Vector3::repeat(radius + cells.largest() + gap);
        let mut found = Vec::new();
        let place = domain.wrap(Vector3::new(x, y, z));
        for (_, image) in images(domain, &self.neighbours.shifts, place, reach) {
            cells.near(&[image.x, image.y, image.z, radius], gap, &mut found);
        }
        found.into_iter().map(|index| index as usize).collect()
    }

    /// Whether a wall is nearer than a gap [m] to the surface of a grain.
    fn walls_are_near(&self, domain: &Domain, centre: &[f64; 4], gap: f64) -> bool {
        let [x, y, z, radius] = *centre;
        let place = domain.wrap(Vector3::new(x, y, z));
        self.walls.as_ref().is_some_and(|walls| walls.are_within(domain, place, radius + gap))
    }
}
