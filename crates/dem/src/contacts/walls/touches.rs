//! Touching contacts with walls, one by one, for those who follow and charge them.

use super::ContactWalls;
use super::forces::SAME_CONTACT;
use crate::contacts::cells::NO_SHIFT;
use crate::contacts::cells::images;
use crate::contacts::memory::{Follow, Growth, WallHistory};
use crate::contacts::walls::surfaces::{Found, MOST_CONTACTS};
use crate::motion::chunks::CHUNK;
use crate::motion::grains::{Grains, Original};
use amberfield_core::{Cohesion, Domain, Vector3, WallCharging};
use amberfield_laws::contact_area;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Place of a contact with a wall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallSlot {
    chunk: u32,
    /// Contact in the chunk.
    contact: u32,
}

/// A touching contact with a wall that trades charge, and the growth of its area.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touching {
    /// Place of the growth.
    pub(crate) slot: WallSlot,
    pub(crate) touch: Touch,
    pub(crate) growth: Growth,
}

/// Place where a grain touches a wall that trades charge, or may soon.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    /// Sorted index.
    pub(crate) grain: usize,
    /// Wall of the scene.
    pub(crate) wall: u32,
    pub(crate) material: u16,
    pub(crate) charging: WallCharging,
    pub(crate) bounds_field: bool,
    /// Direction from the grain to the wall.
    pub(crate) normal: Vector3<f64>,
    /// Centre of the grain from the wall [m].
    pub(crate) distance: f64,
}

impl Touch {
    /// Place where the wall is touched [m].
    pub(crate) fn place(&self, grains: &Grains) -> Vector3<f64> {
        grains.position(self.grain) + self.normal * self.distance
    }
}

impl ContactWalls {
    /// Follows the areas of all contacts; how many begin.
    pub(crate) fn follow(&mut self, grains: &Grains, follow: Follow) -> u64 {
        let mut begun = 0;
        let sticks = self.sticking.cohesion != Cohesion::None;
        for (k, chunk) in self.chunks.iter_mut().enumerate() {
            for entry in &chunk.entries {
                let radius = grains.centre[k * CHUNK + entry.local as usize][3];
                let touching = entry.contacts as usize..(entry.contacts + entry.count) as usize;
                for (contact, growth) in
                    chunk.contacts[touching.clone()].iter().zip(&mut chunk.growth[touching])
                {
                    // What did not touch before has nothing to remember.
                    let area = if sticks {
                        PI * contact.spring.contact_radius * contact.spring.contact_radius
                    } else {
                        contact_area::hertz(radius, contact.overlap)
                    };
                    begun += u64::from(growth.follow(area, true, follow));
                }
            }
        }
        begun
    }

    /// Touching contacts with walls that trade charge, in order.
    pub(crate) fn touches<'a>(
        &'a self,
        grains: &'a Grains,
    ) -> impl DoubleEndedIterator<Item = Touching> + 'a {
        self.chunks.iter().enumerate().flat_map(move |(k, chunk)| {
            chunk.entries.iter().flat_map(move |entry| {
                (entry.contacts..entry.contacts + entry.count).filter_map(move |number| {
                    let contact = &chunk.contacts[number as usize];
                    let grain = k * CHUNK + entry.local as usize;
                    let distance = grains.centre[grain][3] - contact.overlap;
                    let touch = self.touch(grain, contact.triangle, contact.normal, distance);
                    touch.map(|touch| Touching {
                        slot: WallSlot { chunk: k as u32, contact: number },
                        touch,
                        growth: chunk.growth[number as usize],
                    })
                })
            })
        })
    }

    /// Place at a triangle or plane whose wall trades charge.
    fn touch(&self, grain: usize, triangle: u32, normal: Vector3<f64>, distance: f64) -> Option<Touch> {
        let part = self.part(triangle);
        (part.charging != WallCharging::None).then_some(Touch {
            grain,
            wall: part.wall,
            material: part.material,
            charging: part.charging,
            bounds_field: part.bounds_field,
            normal,
            distance,
        })
    }

    /// Places at walls that trade charge, up to `margin` [m] from grains that do not touch them, in order.
    /// They may be farther than the lists know walls.
    pub(crate) fn upcoming(&self, domain: &Domain, grains: &Grains, margin: f64) -> Vec<Touch> {
        let outside = self.movers.as_ref().map_or_else(Vector3::zeros, |movers| movers.outside);
        let chunk = |k: usize| {
            let (mut numbers, mut near) = (Vec::new(), Vec::new());
            let (mut scratch, mut touches) = (Vec::new(), Vec::new());
            let all = k * CHUNK..grains.len().min((k + 1) * CHUNK);
            for grain in all.filter(|&grain| !grains.is_fixed(grain)) {
                let (centre, reach) = (grains.position(grain), grains.centre[grain][3] + margin);
                near.clear();
                for (shift, image) in images(domain, &self.shifts, centre, outside.add_scalar(reach)) {
                    numbers.clear();
                    self.surfaces.within(image, reach, &mut numbers);
                    if shift == NO_SHIFT {
                        self.surfaces.planes_within(centre, reach, &mut numbers);
                    }
                    near.extend(numbers.iter().map(|&number| (number, image)));
                }
                let mut found = [Found::default(); MOST_CONTACTS];
                let count = self.surfaces.contacts(reach, near.iter().copied(), &mut scratch, &mut found);
                touches.extend(found[..count].iter().filter(|found| found.depth() < margin).filter_map(
                    |found| self.touch(grain, found.triangle, found.normal, reach - found.depth()),
                ));
            }
            touches
        };
        (0..self.chunks.len()).into_par_iter().flat_map_iter(chunk).collect()
    }

    /// Contacts that began at the last evaluation, in order.
    pub(crate) fn met(&self) -> impl Iterator<Item = &Met> {
        self.chunks.iter().flat_map(|chunk| &chunk.met)
    }

    /// Number of the wall of each touching contact, in the order of [`Self::histories`].
    pub(crate) fn touched(&self, grains: &Grains) -> Vec<u32> {
        let mut found: Vec<(Original, u32)> = Vec::new();
        for (k, chunk) in self.chunks.iter().enumerate() {
            for entry in &chunk.entries {
                let grain = grains.original[k * CHUNK + entry.local as usize];
                let touching = entry.contacts as usize..(entry.contacts + entry.count) as usize;
                let walls = chunk.contacts[touching].iter().map(|contact| self.part(contact.triangle).wall);
                found.extend(walls.map(|wall| (grain, wall)));
            }
        }
        found.sort_by_key(|(grain, _)| *grain);
        found.into_iter().map(|(_, wall)| wall).collect()
    }

    /// Gives contacts the springs that those of the same grain in nearly the same direction had in another
    /// run; `carried` are sorted by grain.
    pub(crate) fn carry(&mut self, grains: &Grains, carried: &[WallHistory]) {
        for (k, chunk) in self.chunks.iter_mut().enumerate() {
            for entry in &chunk.entries {
                let grain = grains.original[k * CHUNK + entry.local as usize];
                let touching = entry.contacts as usize..(entry.contacts + entry.count) as usize;
                let of_grain = || of_grain(carried, grain).iter();
                for contact in &mut chunk.contacts[touching] {
                    let cosine = |history: &&WallHistory| contact.normal.dot(&Vector3::from(history.normal));
                    let nearest = of_grain().max_by(|a, b| cosine(a).total_cmp(&cosine(b)));
                    if let Some(history) = nearest.filter(|history| cosine(history) > SAME_CONTACT) {
                        (contact.spring, contact.rolling) = (history.spring, history.rolling);
                    }
                }
            }
        }
    }

    /// Growth of a contact's area.
    pub(crate) fn growth_mut(&mut self, WallSlot { chunk, contact }: WallSlot) -> &mut Growth {
        &mut self.chunks[chunk as usize].growth[contact as usize]
    }
}

/// Histories of a grain among those that are sorted by grain.
pub(crate) fn of_grain(histories: &[WallHistory], grain: Original) -> &[WallHistory] {
    let from = histories.partition_point(|history| history.grain < grain);
    let count = histories[from..].partition_point(|history| history.grain == grain);
    &histories[from..from + count]
}

/// Contact with a wall that begins.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met {
    /// Sorted index.
    pub(crate) grain: usize,
    /// Direction from the grain to the wall.
    pub(crate) normal: Vector3<f64>,
    /// Whether the wall mirrors the grain's charge, besides those on faces of the domain.
    pub(crate) bounds_field: bool,
}

/// Moves growth along with contacts that were others before; those that are gone have nothing due.
pub(super) fn renew(growth: &mut [Growth], from: &[Option<usize>]) {
    let mut old = [Growth::default(); MOST_CONTACTS];
    let count = growth.len().min(MOST_CONTACTS);
    old[..count].copy_from_slice(&growth[..count]);
    for (growth, from) in growth.iter_mut().zip(from) {
        *growth = from.map_or_else(Growth::default, |from| old[from]);
    }
}
