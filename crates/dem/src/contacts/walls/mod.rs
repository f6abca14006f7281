//! Contacts with plane and mesh walls.

mod forces;
pub(crate) mod mesh;
mod near;
mod touches;

pub(crate) use touches::{Surface, Touch, WallSlot};

use crate::contacts::material_pairs::{Features, PairTable};
use crate::contacts::memory::{Memory, Spring, WallHistory};
use crate::contacts::walls::mesh::{ClosestPoint, Found, MOST_CONTACTS, MeshWall};
use crate::motion::chunks::{CHUNK, chunk_count, for_each_chunk, is_parallel};
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Vector3, Wall, WallCharging, WallShape};
use std::ops::Range;

/// Shape of a wall.
#[derive(Debug)]
enum Shape {
    Plane { point: Vector3<f64>, normal: Vector3<f64> },
    Mesh(Box<MeshWall>),
}

/// A wall that grains touch.
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

/// A touching contact with a wall, for those who look on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TouchingWall {
    /// Sorted index of the grain.
    pub(crate) grain: usize,
    /// Material of the wall.
    pub(crate) material: u16,
    /// Overlap [m].
    pub(crate) overlap: f64,
    /// Tangential spring.
    pub(crate) spring: Spring,
    /// Rolling torque [N·m].
    pub(crate) rolling: [f64; 3],
}

/// A contact with its history.
#[derive(Clone, Copy, Debug, Default)]
struct WallContact {
    normal: Vector3<f64>,
    overlap: f64,
    triangle: u32,
    spring: Spring,
    rolling: [f64; 3],
}

/// A grain near a wall, and its contacts with it.
#[derive(Clone, Debug)]
struct Entry {
    /// Grain in the chunk.
    local: u32,
    wall: u32,
    /// Triangles near the grain, with shift codes.
    triangles: Range<u32>,
    /// First of the entry's contacts.
    contacts: u32,
    /// Contacts that touch.
    count: u32,
}

/// A triangle near a grain, or near its periodic image.
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
    /// Charging of the contacts; empty without charge transfer.
    charging: Vec<Memory>,
    scratch: Vec<ClosestPoint>,
}

/// All walls and what is near them.
#[derive(Debug)]
pub(crate) struct ContactWalls {
    solids: Vec<Solid>,
    shifts: [[f64; 3]; 32],
    /// Whether contacts move charge.
    charge: bool,
    chunks: Vec<ChunkWalls>,
}

impl ContactWalls {
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
        let Self { solids, shifts, charge, chunks: near } = self;
        let search = near::Search { solids, charge: *charge, shifts, domain, grains, skin, histories };
        let mut marks = vec![(); chunks];
        for_each_chunk!(is_parallel(grains.len()), chunks, (near / 1, marks / 1), |k: usize,
                                                                                   (near, _): (
            &mut [ChunkWalls],
            &mut [()]
        )| {
            near[0].fill(k, &search);
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

    /// Every touching contact, in order.
    pub(crate) fn touching(&self) -> impl Iterator<Item = TouchingWall> + '_ {
        self.chunks.iter().enumerate().flat_map(move |(k, chunk)| {
            chunk.entries.iter().flat_map(move |entry| {
                let first = entry.contacts as usize;
                chunk.contacts[first..first + entry.count as usize].iter().map(move |contact| TouchingWall {
                    grain: k * CHUNK + entry.local as usize,
                    material: self.solids[entry.wall as usize].material,
                    overlap: contact.overlap,
                    spring: contact.spring,
                    rolling: contact.rolling,
                })
            })
        })
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
