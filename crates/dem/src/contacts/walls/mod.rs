//! Contacts with plane and mesh walls.

pub(crate) mod mesh;
mod near;
mod touches;

pub(crate) use touches::{Surface, Touch};

use crate::contacts::law::{Contact, History, respond};
use crate::contacts::material_pairs::{Features, PairTable};
use crate::contacts::memory::{Memory, WallHistory};
use crate::contacts::walls::mesh::{Candidate, Found, MOST_CONTACTS, MeshWall};
use crate::motion::chunks::{CHUNK, chunk_count, for_each_chunk, is_parallel};
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Vector3, Wall, WallCharging, WallShape};
use std::ops::Range;

/// Cosine of the largest turn between two steps for which a contact is still the same (60°).
const SAME_CONTACT: f64 = 0.5;

#[derive(Debug)]
enum Shape {
    Plane { point: Vector3<f64>, normal: Vector3<f64> },
    Mesh(Box<MeshWall>),
}

#[derive(Debug)]
struct Solid {
    name: String,
    material: u16,
    charging: WallCharging,
    bounds_field: bool,
    shape: Shape,
}

/// A grain that overlaps a wall too much.
#[derive(Debug)]
pub(crate) struct TooDeep {
    /// Sorted index of the grain.
    pub(crate) grain: usize,
    /// Name of the wall.
    pub(crate) wall: String,
    /// Overlap [m].
    pub(crate) overlap: f64,
    /// Largest overlap accepted [m].
    pub(crate) limit: f64,
}

/// A contact with its history.
#[derive(Clone, Copy, Debug, Default)]
struct WallContact {
    normal: Vector3<f64>,
    overlap: f64,
    triangle: u32,
    spring: [f64; 4],
    rolling: [f64; 3],
}

/// A grain near a wall.
#[derive(Clone, Debug)]
struct Entry {
    local: u32,
    wall: u32,
    /// Triangles near the grain, with shift codes.
    triangles: Range<u32>,
    /// First of the entry's contacts.
    contacts: u32,
    /// Contacts that touch.
    count: u32,
}

/// Grains of one chunk that are near walls.
#[derive(Debug, Default)]
pub(crate) struct ChunkWalls {
    entries: Vec<Entry>,
    triangles: Vec<(u32, u32)>,
    contacts: Vec<WallContact>,
    /// Charging of the contacts; empty without charge transfer.
    charging: Vec<Memory>,
    scratch: Vec<Candidate>,
}

/// All walls and what is near them.
#[derive(Debug)]
pub(crate) struct Walls {
    solids: Vec<Solid>,
    shifts: [[f64; 3]; 32],
    /// Whether contacts move charge.
    charge: bool,
    chunks: Vec<ChunkWalls>,
}

impl Walls {
    pub(crate) fn new(walls: &[Wall], shifts: [[f64; 3]; 32], charge: bool) -> Result<Self, String> {
        let mut solids = Vec::new();
        for wall in walls {
            let shape = match &wall.shape {
                WallShape::Plane { point, normal } => {
                    let size = normal.norm();
                    let good = point.iter().all(|x| x.is_finite()) && size.is_finite() && size > 0.0;
                    if !good {
                        return Err(format!(
                            "wall '{}' needs a finite point and a normal that is not zero",
                            wall.name
                        ));
                    }
                    Shape::Plane { point: *point, normal: normal / size }
                }
                WallShape::Mesh(mesh) => {
                    let known = mesh.triangles.iter().flatten().all(|&v| (v as usize) < mesh.vertices.len());
                    let finite = mesh.vertices.iter().all(|v| v.iter().all(|x| x.is_finite()));
                    if !(known && finite) {
                        return Err(format!(
                            "wall '{}' has a triangle with an unknown vertex or a vertex that is not finite",
                            wall.name
                        ));
                    }
                    let mesh = MeshWall::new(mesh);
                    if mesh.is_empty() {
                        return Err(format!(
                            "wall '{}' has no triangle with an area; check its file and scale",
                            wall.name
                        ));
                    }
                    Shape::Mesh(Box::new(mesh))
                }
            };
            let Wall { charging, bounds_field, .. } = *wall;
            let (name, material) = (wall.name.clone(), wall.material.0);
            solids.push(Solid { name, material, charging, bounds_field, shape });
        }
        Ok(Self { solids, shifts, charge, chunks: Vec::new() })
    }

    /// Finds the grains near walls; histories stay with their grain and wall.
    pub(crate) fn build(&mut self, domain: &Domain, grains: &Grains, skin: f64, histories: &[WallHistory]) {
        let chunks = chunk_count(grains.len());
        self.chunks.resize_with(chunks, ChunkWalls::default);
        let (solids, shifts, charge, near) = (&self.solids, &self.shifts, self.charge, &mut self.chunks);
        let mut marks = vec![(); chunks];
        for_each_chunk!(is_parallel(grains.len()), chunks, (near / 1, marks / 1), |k: usize,
                                                                                   (near, _): (
            &mut [ChunkWalls],
            &mut [()]
        )| {
            near[0].fill(k, (solids, charge), shifts, domain, grains, skin, histories);
        });
    }

    /// Histories of touching contacts, sorted by grain and wall.
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
                        wall: entry.wall,
                        normal: contact.normal.into(),
                        overlap: contact.overlap,
                        triangle: contact.triangle,
                        spring: contact.spring,
                        rolling: contact.rolling,
                        charging: chunk.charging.get(number).copied().unwrap_or_default(),
                    }
                }));
            }
        }
        // Stable: several contacts of one grain with one wall keep their order.
        out.sort_by_key(|h| (h.grain, h.wall));
        out
    }

    /// Adds the walls' forces and torques.
    pub(crate) fn forces(
        &mut self,
        grains: &Grains,
        table: &PairTable,
        features: Features,
        step: f64,
        force: &mut [Vector3<f64>],
        torque: &mut [Vector3<f64>],
    ) {
        let near = &mut self.chunks;
        let (solids, shifts) = (&self.solids[..], &self.shifts);
        macro_rules! run {
            ($f:literal, $r:literal, $d:literal) => {{
                let body = |k: usize, near: &mut ChunkWalls, force: &mut [_], torque: &mut [_]| {
                    near.forces::<$f, $r, $d>(k, solids, shifts, grains, table, step, force, torque);
                };
                let (parallel, chunks) = (is_parallel(grains.len()), chunk_count(grains.len()));
                if $f || $r {
                    for_each_chunk!(
                        parallel,
                        chunks,
                        (near / 1, force / CHUNK, torque / CHUNK),
                        |k: usize,
                         (near, force, torque): (
                            &mut [ChunkWalls],
                            &mut [Vector3<f64>],
                            &mut [Vector3<f64>]
                        )| body(k, &mut near[0], force, torque)
                    );
                } else {
                    for_each_chunk!(parallel, chunks, (near / 1, force / CHUNK), |k: usize,
                                                                                  (near, force): (
                        &mut [ChunkWalls],
                        &mut [Vector3<f64>]
                    )| body(
                        k,
                        &mut near[0],
                        force,
                        &mut []
                    ));
                }
            }};
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

    /// Number of touching contacts.
    pub(crate) fn contacts(&self) -> usize {
        self.chunks.iter().flat_map(|c| &c.entries).map(|e| e.count as usize).sum()
    }

    /// Calls `each(grain index, wall material, overlap, spring, rolling)` for every touching contact.
    pub(crate) fn each_contact(&self, mut each: impl FnMut(usize, u16, f64, &[f64; 4], &[f64; 3])) {
        for (k, chunk) in self.chunks.iter().enumerate() {
            for entry in &chunk.entries {
                let first = entry.contacts as usize;
                for c in &chunk.contacts[first..first + entry.count as usize] {
                    let material = self.solids[entry.wall as usize].material;
                    each(k * CHUNK + entry.local as usize, material, c.overlap, &c.spring, &c.rolling);
                }
            }
        }
    }

    /// The first grain that overlaps a wall by more than half its radius.
    pub(crate) fn too_deep(&self, grains: &Grains) -> Option<TooDeep> {
        (0..grains.len()).find_map(|grain| {
            let (centre, radius) = (grains.position(grain), grains.centre[grain][3]);
            let limit = 0.5 * radius;
            self.solids.iter().find_map(|solid| {
                let overlap = solid.overlap(centre, radius);
                (overlap > limit).then(|| TooDeep { grain, wall: solid.name.clone(), overlap, limit })
            })
        })
    }
}

impl Solid {
    /// Largest overlap [m] with a grain at `centre` [m]; zero or negative where it does not touch.
    fn overlap(&self, centre: Vector3<f64>, radius: f64) -> f64 {
        match &self.shape {
            Shape::Plane { point, normal } => radius - (centre - point).dot(normal),
            Shape::Mesh(mesh) => {
                let mut near = Vec::new();
                mesh.within(centre, radius, &mut near);
                let mut found = [Found::default(); MOST_CONTACTS];
                let pairs = near.iter().map(|&t| (t, centre));
                let count = mesh.contacts(radius, pairs, &mut Vec::new(), &mut found);
                found[..count].iter().map(|f| f.overlap).fold(0.0, f64::max)
            }
        }
    }
}

impl ChunkWalls {
    #[expect(clippy::too_many_arguments, reason = "the arrays of one chunk, split for the borrow checker")]
    fn forces<const FRICTION: bool, const ROLLING: bool, const DAMPING: bool>(
        &mut self,
        k: usize,
        solids: &[Solid],
        shifts: &[[f64; 3]; 32],
        grains: &Grains,
        table: &PairTable,
        step: f64,
        force: &mut [Vector3<f64>],
        torque: &mut [Vector3<f64>],
    ) {
        let Self { entries, triangles, contacts, charging: memory, scratch } = self;
        for entry in entries {
            let local = entry.local as usize;
            let i = k * CHUNK + local;
            let (centre, radius) = (grains.position(i), grains.centre[i][3]);
            let solid = &solids[entry.wall as usize];
            let mut found = [Found::default(); MOST_CONTACTS];
            let count = match &solid.shape {
                Shape::Plane { point, normal } => {
                    let overlap = radius - (centre - point).dot(normal);
                    found[0] = Found { normal: -normal, overlap, triangle: 0 };
                    usize::from(overlap > 0.0)
                }
                Shape::Mesh(mesh) => {
                    let range = entry.triangles.start as usize..entry.triangles.end as usize;
                    let pairs = triangles[range]
                        .iter()
                        .map(|&(t, code)| (t, centre + Vector3::from(shifts[code as usize])));
                    mesh.contacts(radius, pairs, scratch, &mut found)
                }
            };
            let kept = &mut contacts[entry.contacts as usize..];
            let from = renew(kept, entry.count as usize, &found[..count]);
            if !memory.is_empty() {
                touches::renew(&mut memory[entry.contacts as usize..], &from[..count]);
            }
            entry.count = count as u32;
            let pair = table.get(grains.material[i], solid.material);
            for wall_contact in &mut kept[..count] {
                let (contact, arm) = contact_of::<FRICTION, ROLLING>(grains, i, wall_contact);
                let mut history = History::stored(wall_contact.spring, wall_contact.rolling);
                let response = respond::<_, FRICTION, ROLLING, DAMPING>(&contact, pair, step, &mut history);
                (wall_contact.spring, wall_contact.rolling) = history.to_store();
                force[local] += response.force;
                if FRICTION || ROLLING {
                    torque[local] += response.twist * arm + response.rolling;
                }
            }
        }
    }
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
        overlap: found.overlap,
        normal: found.normal,
        velocity: grains.velocity[i],
        spin: turning * arm,
        turning,
        radius,
        inverse_mass,
        inverse_moment: inverse_mass / (radius * radius),
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
        let Found { normal, overlap, triangle } = *found;
        *kept = WallContact { normal, overlap, triangle, ..WallContact::default() };
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
