//! Contacts with plane and mesh walls.

mod course;
mod forces;
mod loads;
mod motion;
pub(crate) mod movers;
mod near;
mod parts;
pub(crate) mod surfaces;
mod touches;

pub(crate) use forces::SAME_CONTACT;
pub use loads::WallLoad;
pub(crate) use touches::{Met, Touch, Touching, of_grain};

use crate::contacts::cells::{NO_SHIFT, images};
use crate::contacts::material_pairs::{Features, PairTable};
use crate::contacts::memory::{Growth, Spring, WallHistory};
use crate::contacts::normal::{Dmt, Hertz, Jkr};
use crate::contacts::walls::parts::{Part, surfaces_of};
use crate::contacts::walls::surfaces::{ClosestPoint, Surfaces};
use crate::motion::chunks::{CHUNK, Loads, chunk_count, for_each_chunk, for_each_load, is_parallel};
use crate::motion::grains::Grains;
use amberfield_core::{Cohesion, Domain, Vector3, Wall};
use movers::Movers;
use std::ops::Range;

/// A touching contact with a wall, for those who look on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TouchingWall<'a> {
    /// Sorted index of the grain.
    pub(crate) grain: usize,
    /// Name of the wall.
    pub(crate) name: &'a str,
    /// Material of the wall.
    pub(crate) material: u16,
    /// Direction from the grain to the wall.
    pub(crate) normal: Vector3<f64>,
    /// Overlap, and that with the line where the contact joins a deeper one, as in [`surfaces::Found`] [m].
    pub(crate) overlap: f64,
    pub(crate) joined: f64,
    /// Tangential spring.
    pub(crate) spring: Spring,
    /// Rolling torque [N·m].
    pub(crate) rolling: [f64; 3],
}

/// A contact with its history.
#[derive(Clone, Copy, Debug, Default)]
struct WallContact {
    normal: Vector3<f64>,
    /// Overlap, and that with the line where the contact joins a deeper one, as in [`surfaces::Found`] [m].
    overlap: f64,
    joined: f64,
    triangle: u32,
    spring: Spring,
    rolling: [f64; 3],
}

/// A grain near a wall, and its contacts with it.
#[derive(Clone, Debug)]
struct Entry {
    /// Grain in the chunk.
    local: u32,
    /// Triangles and planes near the grain, with shift codes.
    triangles: Range<u32>,
    /// First of the entry's contacts.
    contacts: u32,
    /// Contacts that touch.
    count: u32,
}

/// A triangle or plane near a grain, or near its periodic image.
#[derive(Clone, Copy, Debug)]
struct NearTriangle {
    triangle: u32,
    /// Code of the image's shift.
    shift: u32,
}

/// Grains of one chunk that are near walls.
#[derive(Debug, Default)]
pub(crate) struct ChunkWalls {
    entries: Vec<Entry>,
    triangles: Vec<NearTriangle>,
    contacts: Vec<WallContact>,
    /// Growth of the contacts' areas; empty without charge transfer.
    growth: Vec<Growth>,
    scratch: Vec<ClosestPoint>,
    /// Contacts that began at the last evaluation.
    met: Vec<Met>,
    /// Loads on each wall at the last evaluation; empty where no grain is near one.
    loads: Vec<WallLoad>,
    /// Largest overlap over the grain's radius at the last evaluation.
    deepest: f64,
    /// Power of walls that move at the last evaluation [W].
    power: f64,
}

/// Way in which contacts stick to walls.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sticking {
    /// Model of cohesion.
    pub(crate) cohesion: Cohesion,
    /// Bound on the stretch of any contact [m].
    pub(crate) stretch: f64,
}

/// All walls and what is near them.
#[derive(Debug)]
pub(crate) struct ContactWalls {
    surfaces: Surfaces,
    /// Wall of each surface.
    parts: Vec<Part>,
    shifts: [[f64; 3]; 32],
    /// Whether contacts move charge.
    charge: bool,
    /// Way in which contacts stick to walls.
    sticking: Sticking,
    chunks: Vec<ChunkWalls>,
    /// Walls that move; `None` where all are at rest.
    movers: Option<Box<Movers>>,
    /// Whether forces were evaluated since the run began or went on.
    evaluated: bool,
}

impl ContactWalls {
    pub(crate) fn new(
        walls: &[Wall],
        shifts: [[f64; 3]; 32],
        charge: bool,
        sticking: Sticking,
    ) -> Result<Self, String> {
        let (surfaces, parts) = surfaces_of(walls)?;
        let chunks = Vec::new();
        Ok(Self { surfaces, parts, shifts, charge, sticking, chunks, movers: None, evaluated: false })
    }

    /// Finds the grains near walls; histories stay with their grain and wall.
    pub(crate) fn build(&mut self, domain: &Domain, grains: &Grains, skin: f64, histories: &[WallHistory]) {
        let chunks = chunk_count(grains.len());
        self.chunks.resize_with(chunks, ChunkWalls::default);
        if let Some(movers) = &mut self.movers {
            movers.begin_list(&mut self.surfaces, domain);
        }
        let Self { surfaces, shifts, charge, chunks: near, sticking, movers, .. } = self;
        let outside = movers.as_ref().map_or_else(Vector3::zeros, |movers| movers.outside);
        let (charge, skin) = (*charge, skin + sticking.stretch);
        let search = near::Search { surfaces, charge, shifts, domain, grains, outside, skin, histories };
        let mut marks = vec![(); chunks];
        for_each_chunk!(is_parallel(grains.len()), chunks, (near / 1, marks / 1), |k: usize,
                                                                                   (near, _): (
            &mut [ChunkWalls],
            &mut [()]
        )| {
            near[0].fill(k, &search);
        });
        if let Some(movers) = movers {
            let named = self.chunks.iter().flat_map(|chunk| &chunk.triangles).map(|near| near.triangle);
            movers.end_list(surfaces, named);
        }
    }

    /// Takes in that there are `count` grains now, of which those that came last are near no wall.
    pub(crate) fn append(&mut self, count: usize) {
        self.chunks.resize_with(chunk_count(count), ChunkWalls::default);
    }

    /// Histories of touching contacts, sorted by grain.
    pub(crate) fn histories(&self, grains: &Grains) -> Vec<WallHistory> {
        let mut out = Vec::new();
        for (k, chunk) in self.chunks.iter().enumerate() {
            for entry in &chunk.entries {
                let original = grains.original[k * CHUNK + entry.local as usize];
                let touching = entry.contacts as usize..(entry.contacts + entry.count) as usize;
                out.extend(touching.map(|number| {
                    let contact = &chunk.contacts[number];
                    WallHistory {
                        grain: original,
                        normal: contact.normal.into(),
                        overlap: contact.overlap,
                        joined: contact.joined,
                        triangle: contact.triangle,
                        spring: contact.spring,
                        rolling: contact.rolling,
                        growth: chunk.growth.get(number).copied().unwrap_or_default(),
                    }
                }));
            }
        }
        // Stable: several contacts of one grain keep their order.
        out.sort_by_key(|h| h.grain);
        out
    }

    /// Adds what the walls do to grains.
    pub(crate) fn forces(
        &mut self,
        grains: &Grains,
        table: &PairTable,
        features: Features,
        step: f64,
        loads: &mut Loads,
    ) {
        self.evaluated = true;
        let near = &mut self.chunks[..];
        let Self { surfaces, parts, shifts, sticking, movers, .. } = self;
        let (rolling_model, stretch) = (features.rolling_model, sticking.stretch);
        let movers = movers.as_deref();
        let scene =
            forces::Scene { surfaces, parts, shifts, grains, table, rolling_model, stretch, movers, step };
        macro_rules! run {
            ($f:literal, $r:literal, $d:literal) => {
                run!(Hertz, $f, $r, $d)
            };
            ($law:ty, $f:literal, $r:literal, $d:literal) => {
                if movers.is_some() {
                    for_each_load(near, loads, |k, near, loads| {
                        near.forces::<$law, $f, $r, $d, true>(k, &scene, loads);
                    })
                } else {
                    for_each_load(near, loads, |k, near, loads| {
                        near.forces::<$law, $f, $r, $d, false>(k, &scene, loads);
                    })
                }
            };
        }
        match (features.cohesion, features.rolling) {
            (Cohesion::None, _) => {}
            (Cohesion::Dmt, false) => return run!(Dmt, true, false, true),
            (Cohesion::Dmt, true) => return run!(Dmt, true, true, true),
            (Cohesion::Jkr, false) => return run!(Jkr, true, false, true),
            (Cohesion::Jkr, true) => return run!(Jkr, true, true, true),
        }
        match (features.friction, features.rolling, features.damping) {
            (false, false, false) => run!(false, false, false),
            (false, false, true) => run!(false, false, true),
            (false, true, false) => run!(false, true, false),
            (false, true, true) => run!(false, true, true),
            (true, false, false) => run!(true, false, false),
            (true, false, true) => run!(true, false, true),
            (true, true, false) => run!(true, true, false),
            (true, true, true) => run!(true, true, true),
        }
    }

    /// Largest overlap over the grain's radius at the last evaluation.
    pub(crate) fn deepest(&self) -> f64 {
        self.chunks.iter().map(|chunk| chunk.deepest).fold(0.0, f64::max)
    }

    /// Loads on each wall of the scene at the last evaluation; `None` before it.
    pub(crate) fn loads(&self) -> Option<Vec<WallLoad>> {
        let mut sum = vec![WallLoad::default(); self.parts.len()];
        for chunk in &self.chunks {
            chunk.loads.iter().zip(&mut sum).for_each(|(part, sum)| sum.add(part));
        }
        self.evaluated.then_some(sum)
    }

    /// Number of touching contacts.
    pub(crate) fn contacts(&self) -> usize {
        self.chunks.iter().flat_map(|c| &c.entries).map(|e| e.count as usize).sum()
    }

    /// Every touching contact, in order.
    pub(crate) fn touching(&self) -> impl Iterator<Item = TouchingWall<'_>> {
        self.chunks.iter().enumerate().flat_map(move |(k, chunk)| {
            chunk.entries.iter().flat_map(move |entry| {
                let first = entry.contacts as usize;
                chunk.contacts[first..first + entry.count as usize].iter().map(move |contact| {
                    let part = self.part(contact.triangle);
                    TouchingWall {
                        grain: k * CHUNK + entry.local as usize,
                        name: &part.name,
                        material: part.material,
                        normal: contact.normal,
                        overlap: contact.overlap,
                        joined: contact.joined,
                        spring: contact.spring,
                        rolling: contact.rolling,
                    }
                })
            })
        })
    }

    /// Whether a wall stands within a distance [m] of a place [m], or a plane between the place and the
    /// grains.
    pub(crate) fn covers(&self, place: Vector3<f64>, distance: f64) -> bool {
        let mut near = Vec::new();
        self.surfaces.within(place, distance, &mut near);
        self.surfaces.planes_within(place, distance, &mut near);
        !near.is_empty()
    }

    /// Whether a wall stands within a distance [m] of a place [m], or a plane before it. Walls that move are
    /// where [`Self::settle`] knew them last.
    pub(crate) fn are_within(&self, domain: &Domain, place: Vector3<f64>, reach: f64) -> bool {
        let mut near = Vec::new();
        let outside = self.movers.as_ref().map_or_else(Vector3::zeros, |movers| movers.outside);
        for (shift, image) in images(domain, &self.shifts, place, outside.add_scalar(reach)) {
            self.surfaces.within(image, reach, &mut near);
            if shift == NO_SHIFT {
                self.surfaces.planes_within(image, reach, &mut near);
            }
        }
        !near.is_empty()
    }

    /// Whether a wall stands within a distance [m] of a place [m] beside a grain, or a plane before the
    /// place. The lists know walls up to half the skin from the grain's surface.
    pub(crate) fn stand_at(&self, grain: usize, place: Vector3<f64>, distance: f64) -> bool {
        let chunk = &self.chunks[grain / CHUNK];
        let local = (grain % CHUNK) as u32;
        let Ok(entry) = chunk.entries.binary_search_by_key(&local, |entry| entry.local) else { return false };
        let Range { start, end } = chunk.entries[entry].triangles;
        chunk.triangles[start as usize..end as usize].iter().any(|near| {
            let image = place + Vector3::from(self.shifts[near.shift as usize]);
            self.surfaces.closest(near.triangle, image, distance).distance <= distance
        })
    }

    /// Wall that a triangle or plane belongs to.
    fn part(&self, number: u32) -> &Part {
        &self.parts[self.surfaces.surface_of(number)]
    }
}
