//! Search for the grains near walls, and the histories that they keep.

use super::{ChunkWalls, Entry, NearTriangle, Shape, Solid, WallContact};
use crate::contacts::cells::NO_SHIFT;
use crate::contacts::memory::{Memory, WallHistory};
use crate::contacts::walls::mesh::MOST_CONTACTS;
use crate::motion::chunks::CHUNK;
use crate::motion::grains::Grains;
use amberfield_core::{Axis, Domain, Vector3};

/// Everything that a search for grains near walls reads.
pub(super) struct Search<'a> {
    pub(super) solids: &'a [Solid],
    /// Whether contacts move charge.
    pub(super) charge: bool,
    pub(super) shifts: &'a [[f64; 3]; 32],
    pub(super) domain: &'a Domain,
    pub(super) grains: &'a Grains,
    /// Distance from a wall within which a grain is near it [m].
    pub(super) skin: f64,
    /// Histories of the contacts before, sorted by grain and wall.
    pub(super) histories: &'a [WallHistory],
}

impl ChunkWalls {
    /// Finds the walls near the grains of chunk `k`, and gives contacts the histories that they had.
    pub(super) fn fill(&mut self, k: usize, search: &Search<'_>) {
        let &Search { solids, charge, shifts, domain, grains, skin, histories } = search;
        self.entries.clear();
        self.triangles.clear();
        self.contacts.clear();
        self.charging.clear();
        let mut near = Vec::new();
        let mut most = 0;
        for i in k * CHUNK..grains.len().min((k + 1) * CHUNK) {
            let (centre, reach) = (grains.position(i), grains.centre[i][3] + skin);
            for (number, solid) in solids.iter().enumerate() {
                let number = number as u32;
                let first = self.triangles.len();
                let room = match &solid.shape {
                    Shape::Plane { point, normal } => usize::from((centre - point).dot(normal) < reach),
                    Shape::Mesh(mesh) => {
                        for (code, image) in images(domain, shifts, centre, reach) {
                            near.clear();
                            mesh.within(image, reach, &mut near);
                            let found = near.iter().map(|&triangle| NearTriangle { triangle, shift: code });
                            self.triangles.extend(found);
                        }
                        if self.triangles.len() > first { MOST_CONTACTS } else { 0 }
                    }
                };
                most = most.max(self.triangles.len() - first);
                if room > 0 {
                    let contacts = self.contacts.len();
                    self.contacts.resize(contacts + room, WallContact::default());
                    self.charging.resize(if charge { contacts + room } else { 0 }, Memory::default());
                    let original = grains.original[i];
                    let from = histories.partition_point(|h| (h.grain, h.solid) < (original, number));
                    let mut count = 0;
                    let same = histories[from..].iter().take_while(|h| h.grain == original);
                    for h in same.take_while(|h| h.solid == number).take(room) {
                        self.contacts[contacts + count] = WallContact {
                            normal: h.normal.into(),
                            overlap: h.overlap,
                            triangle: h.triangle,
                            spring: h.spring,
                            rolling: h.rolling,
                        };
                        if charge {
                            self.charging[contacts + count] = h.charging;
                        }
                        count += 1;
                    }
                    self.entries.push(Entry {
                        local: (i - k * CHUNK) as u32,
                        solid: number,
                        triangles: first as u32..self.triangles.len() as u32,
                        contacts: contacts as u32,
                        count: count as u32,
                    });
                }
            }
        }
        self.scratch.clear();
        self.scratch.reserve(most);
    }
}

/// The centre and its periodic images that can reach into the domain, with their shift codes.
fn images<'a>(
    domain: &'a Domain,
    shifts: &'a [[f64; 3]; 32],
    centre: Vector3<f64>,
    reach: f64,
) -> impl Iterator<Item = (u32, Vector3<f64>)> + 'a {
    let (min, max) = (domain.min(), domain.max());
    (0..27_u32).filter_map(move |code| {
        let digits = [code / 9, code / 3 % 3, code % 3];
        let wanted = code == NO_SHIFT
            || (0..3).all(|axis| match (digits[axis], domain.is_periodic(Axis::ALL[axis])) {
                (1, _) => true,
                (0, true) => max[axis] - centre[axis] <= reach,
                (2, true) => centre[axis] - min[axis] <= reach,
                _ => false,
            });
        wanted.then(|| (code, centre + Vector3::from(shifts[code as usize])))
    })
}
