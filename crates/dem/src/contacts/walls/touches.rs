//! Touching contacts with walls, one by one, for those who follow and charge them.

use super::ContactWalls;
use crate::contacts::memory::{Follow, Memory};
use crate::contacts::walls::surfaces::MOST_CONTACTS;
use crate::motion::chunks::CHUNK;
use crate::motion::grains::Grains;
use amberfield_core::{Vector3, WallCharging};
use amberfield_laws::contact_area;

/// Place of a contact with a wall.
#[derive(Clone, Copy, Debug)]
pub(crate) struct WallSlot {
    chunk: u32,
    /// Contact in the chunk.
    contact: u32,
}

/// A touching contact of a grain with a wall that trades charge.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Touch {
    /// Place of its memory.
    pub(crate) slot: WallSlot,
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
    pub(crate) memory: Memory,
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
        for (k, chunk) in self.chunks.iter_mut().enumerate() {
            for entry in &chunk.entries {
                let radius = grains.centre[k * CHUNK + entry.local as usize][3];
                let touching = entry.contacts as usize..(entry.contacts + entry.count) as usize;
                for (contact, memory) in
                    chunk.contacts[touching.clone()].iter().zip(&mut chunk.charging[touching])
                {
                    // What did not touch before has nothing to remember.
                    let area = contact_area::hertz(radius, contact.overlap);
                    begun += u64::from(memory.growth.follow(area, true, follow));
                }
            }
        }
        begun
    }

    /// Touching contacts with walls that trade charge, in order.
    pub(crate) fn touches<'a>(&'a self, grains: &'a Grains) -> impl DoubleEndedIterator<Item = Touch> + 'a {
        self.chunks.iter().enumerate().flat_map(move |(k, chunk)| {
            chunk.entries.iter().flat_map(move |entry| {
                (entry.contacts..entry.contacts + entry.count).filter_map(move |number| {
                    let contact = &chunk.contacts[number as usize];
                    let grain = k * CHUNK + entry.local as usize;
                    let part = self.part(contact.triangle);
                    (part.charging != WallCharging::None).then(|| Touch {
                        slot: WallSlot { chunk: k as u32, contact: number },
                        grain,
                        wall: part.wall,
                        material: part.material,
                        charging: part.charging,
                        bounds_field: part.bounds_field,
                        normal: contact.normal,
                        distance: grains.centre[grain][3] - contact.overlap,
                        memory: chunk.charging[number as usize],
                    })
                })
            })
        })
    }

    /// Memory that a contact has of its charging.
    pub(crate) fn memory_mut(&mut self, WallSlot { chunk, contact }: WallSlot) -> &mut Memory {
        &mut self.chunks[chunk as usize].charging[contact as usize]
    }
}

/// Moves charging along with contacts that were others before; those that are gone have nothing due.
pub(super) fn renew(memory: &mut [Memory], from: &[Option<usize>]) {
    let mut old = [Memory::default(); MOST_CONTACTS];
    let count = memory.len().min(MOST_CONTACTS);
    old[..count].copy_from_slice(&memory[..count]);
    for (memory, from) in memory.iter_mut().zip(from) {
        *memory = from.map_or_else(Memory::default, |from| old[from]);
    }
}
