//! Search for the grains near walls, and the histories that they keep.

use super::{ChunkWalls, Entry, NearTriangle, WallContact};
use crate::contacts::cells::{NO_SHIFT, images};
use crate::contacts::memory::{Growth, WallHistory};
use crate::contacts::walls::surfaces::{MOST_CONTACTS, Surfaces};
use crate::motion::chunks::CHUNK;
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Vector3};

/// Everything that a search for grains near walls reads.
pub(super) struct Search<'a> {
    pub(super) surfaces: &'a Surfaces,
    /// Whether contacts move charge.
    pub(super) charge: bool,
    pub(super) shifts: &'a [[f64; 3]; 32],
    pub(super) domain: &'a Domain,
    pub(super) grains: &'a Grains,
    /// Largest way by which walls that move stand out of the domain along periodic axes [m].
    pub(super) outside: Vector3<f64>,
    /// Distance from a wall within which a grain is near it [m].
    pub(super) skin: f64,
    /// Histories of the contacts before, sorted by grain.
    pub(super) histories: &'a [WallHistory],
}

impl ChunkWalls {
    /// Finds the walls near the grains of chunk `k`, and gives contacts the histories that they had.
    pub(super) fn fill(&mut self, k: usize, search: &Search<'_>) {
        let &Search { surfaces, charge, shifts, domain, grains, outside, skin, histories } = search;
        self.entries.clear();
        self.triangles.clear();
        self.contacts.clear();
        self.growth.clear();
        let mut near = Vec::new();
        let mut most = 0;
        for i in k * CHUNK..grains.len().min((k + 1) * CHUNK) {
            // Walls do nothing to what never moves.
            if grains.is_fixed(i) {
                continue;
            }
            let (centre, reach) = (grains.position(i), grains.centre[i][3] + skin);
            let first = self.triangles.len();
            for (shift, image) in images(domain, shifts, centre, outside.add_scalar(reach)) {
                near.clear();
                surfaces.within(image, reach, &mut near);
                if shift == NO_SHIFT {
                    surfaces.planes_within(centre, reach, &mut near);
                }
                self.triangles.extend(near.iter().map(|&triangle| NearTriangle { triangle, shift }));
            }
            let count = self.triangles.len() - first;
            most = most.max(count);
            if count == 0 {
                continue;
            }
            let (contacts, room) = (self.contacts.len(), count.min(MOST_CONTACTS));
            self.contacts.resize(contacts + room, WallContact::default());
            self.growth.resize(if charge { contacts + room } else { 0 }, Growth::default());
            let original = grains.original[i];
            let from = histories.partition_point(|h| h.grain < original);
            let mut touching = 0;
            for h in histories[from..].iter().take_while(|h| h.grain == original).take(room) {
                self.contacts[contacts + touching] = WallContact {
                    normal: h.normal.into(),
                    overlap: h.overlap,
                    joined: h.joined,
                    triangle: h.triangle,
                    spring: h.spring,
                    rolling: h.rolling,
                };
                if charge {
                    self.growth[contacts + touching] = h.growth;
                }
                touching += 1;
            }
            self.entries.push(Entry {
                local: (i - k * CHUNK) as u32,
                triangles: first as u32..self.triangles.len() as u32,
                contacts: contacts as u32,
                count: touching as u32,
            });
        }
        self.scratch.clear();
        self.scratch.reserve(most);
        self.met.clear();
        self.met.reserve(self.contacts.len());
    }
}
