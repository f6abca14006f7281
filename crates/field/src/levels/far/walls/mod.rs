//! Charges that walls are replaced by, which make the far level's boundary data smooth.
//!
//! The field is exact whatever they are. A charge at distance δ from a wall is mirrored in it with the charge
//! −q f(δ) (potential prescribed) or +q f(δ) (slope prescribed): f is 1 up to half the depth D = 4h, h the
//! size of the cells there, and falls to 0 at D as 1 − u³(10 − 15u + 6u²), u = 2δ/D − 1. In a conductor of
//! mean curvature κ it is the image of the sphere of that curvature, −q/(1 − κδ) at δ/(1 − κδ) (Jackson,
//! Classical Electrodynamics, 3rd ed., §2.2). Walls at an angle mirror each other's images, and so do two
//! walls that face each other.
//!
//! Where the solid behind a wall is thick enough, these are plain image charges, felt by every place. Where
//! an image would lie in the mesh behind a sheet or a plate, or beside the edge of a body, they are ghosts,
//! felt only by the places that the wall hides from them ([`ghosts`]).

mod buckets;
mod curved;
mod edges;
mod flat;
mod ghosts;
mod images;
mod mirror;
mod patch;
mod rims;
mod screen;
mod solid;

pub(super) use ghosts::Ghosts;
pub(super) use images::Images;
pub(super) use screen::Place;

use super::mesh::{Condition, FarMesh};
use curved::CurvedWall;
use edges::{Edge, edges};
use flat::FlatWall;
use images::Reflection;
use mirror::{Ground, Mirror, RADIUS_AT_RIM_OF_CELL};
use nalgebra::Vector3;
use patch::half_diagonal;
use rims::Rims;
use solid::{Surroundings, surroundings};

/// Faces whose normals and planes differ by less are flat, over one and over the face's size.
const FLAT: f64 = 1e-6;
/// Distance of neighbouring faces' centres over their half diagonals.
const NEIGHBOURS: f64 = 1.2;
/// Distance into the mesh from which a place on a wall is seen, over the cell's size.
const SEEN_FROM: f64 = 0.1;

/// Largest factor of the depth up to which walls mirror charges.
pub(super) const DEEPEST: f64 = 1.4;

/// Edges and surroundings of a mesh's boundary faces: what walls know of the mesh whatever their depth.
#[derive(Debug)]
pub(super) struct Outline {
    edges: Vec<Edge>,
    around: Vec<Surroundings>,
}

impl Outline {
    pub(super) fn new(mesh: &FarMesh) -> Self {
        Self { edges: edges(mesh), around: surroundings(mesh) }
    }
}

/// The boundary of a mesh, as walls are made of it.
#[derive(Clone, Copy)]
struct Surface<'a> {
    mesh: &'a FarMesh,
    edges: &'a [Edge],
    around: &'a [Surroundings],
    /// Factor of the ghosts' radii.
    ghost_scale: f64,
    /// Distance up to which rims matter [m].
    reach: f64,
}

impl Surface<'_> {
    fn ground(&self, face: u32) -> Ground {
        Ground::new(&self.around[face as usize], self.ghost_scale)
    }

    fn sign(&self, face: u32) -> f64 {
        match self.mesh.boundary()[face as usize].condition {
            Condition::Potential(_) => -1.0,
            Condition::Slope(_) => 1.0,
        }
    }
}

#[derive(Debug)]
enum Shape {
    Flat(FlatWall),
    Curved(CurvedWall),
}

/// A wall and what its images' charges are multiplied with.
#[derive(Debug)]
struct Wall {
    shape: Shape,
    sign: f64,
}

/// The walls of a mesh.
#[derive(Debug)]
pub(super) struct Walls {
    /// Curved ones first.
    walls: Vec<Wall>,
    /// Point of the wall at which each boundary face's condition holds [m].
    places: Vec<Place>,
    /// All rims, with the ground and the sign of each boundary face.
    rims: Rims,
    ground: Vec<Ground>,
    signs: Vec<f64>,
    deepest: f64,
    /// Factor of all depths.
    depth_scale: f64,
}

impl Walls {
    /// Walls of a mesh, with the radii of ghosts scaled.
    pub(super) fn new(mesh: &FarMesh, outline: &Outline, ghost_scale: f64) -> Self {
        let boundary = mesh.boundary();
        let Outline { edges, around } = outline;
        let largest = around.iter().map(|face| face.cell).fold(0.0, f64::max);
        let reach = ghost_scale * RADIUS_AT_RIM_OF_CELL * largest;
        let surface = Surface { mesh, edges, around, ghost_scale, reach };
        let mut at: Vec<_> = boundary.iter().map(|face| mesh.place_of_condition(face)).collect();
        let beside = neighbours(mesh, edges);
        let mut walls = Vec::new();
        for faces in connected(&beside) {
            let shape = match FlatWall::new(&surface, &faces) {
                Some(wall) => Shape::Flat(wall),
                None => {
                    let number = |face: &u32| faces.binary_search(face).expect("connected") as u32;
                    let within: Vec<Vec<u32>> = faces
                        .iter()
                        .map(|&face| beside[face as usize].iter().map(number).collect())
                        .collect();
                    let wall = CurvedWall::new(&surface, &faces, &within);
                    for (index, &face) in faces.iter().enumerate() {
                        at[face as usize] = wall.place(index, &at[face as usize]);
                    }
                    Shape::Curved(wall)
                }
            };
            walls.push(Wall { shape, sign: surface.sign(faces[0]) });
        }
        walls.sort_by_key(|wall| matches!(wall.shape, Shape::Flat(_)));
        let place = |(at, face): (&Vector3<f64>, usize)| {
            let into = SEEN_FROM * mesh.volumes()[boundary[face].cell as usize].cbrt();
            Place { at: *at, seen_from: at - boundary[face].normal * into }
        };
        let faces = 0..boundary.len() as u32;
        let ground: Vec<Ground> = faces.clone().map(|face| surface.ground(face)).collect();
        Self {
            walls,
            places: at.iter().zip(0..).map(place).collect(),
            rims: Rims::new(mesh, edges, None, reach),
            deepest: ground.iter().map(|ground| ground.depth).fold(0.0, f64::max),
            ground,
            signs: faces.map(|face| surface.sign(face)).collect(),
            depth_scale: 1.0,
        }
    }

    /// Point of the wall at which each boundary face's condition holds [m].
    pub(super) fn places(&self) -> &[Place] {
        &self.places
    }

    /// Mirrors charges up to so much of the usual depth, at most [`DEEPEST`].
    pub(super) fn scale_depth(&mut self, scale: f64) {
        self.depth_scale = scale;
    }

    /// Depth up to which some wall mirrors charges [m].
    pub(super) fn deepest(&self) -> f64 {
        self.depth_scale * self.deepest
    }

    /// Finds what the walls make of a unit charge at a point: images and ghosts.
    pub(super) fn reflect(&self, point: &Vector3<f64>, images: &mut Images) {
        let of_walls = self.walls.iter().filter_map(|wall| {
            let mirror = match &wall.shape {
                Shape::Flat(flat) => flat.mirror(point, self.depth_scale)?,
                Shape::Curved(curved) => curved.mirror(point, self.depth_scale)?,
            };
            Some(Reflection { mirror, sign: wall.sign })
        });
        images.take(point, of_walls.chain(self.beyond_rim(point)));
    }

    /// The half plane that a charge beyond a rim has beside it.
    fn beyond_rim(&self, point: &Vector3<f64>) -> Option<Reflection> {
        if self.rims.is_empty() {
            return None;
        }
        let rim = self.rims.nearest(point)?;
        let ground = self.ground[rim.face() as usize].deeper(self.depth_scale);
        if rim.distance >= ground.depth {
            return None;
        }
        let half = rim.between_faces(point)?;
        let left = mirror::left_beside(self.rims.other(point, &rim), rim.distance);
        let mirror = Mirror::beyond_rim(half, point, rim.distance, &ground, left);
        Some(Reflection { mirror, sign: self.signs[rim.face() as usize] })
    }
}

/// Each boundary face's neighbours that go on smoothly, with a condition of the same kind: those across an
/// edge, and those across one of theirs that are as near.
fn neighbours(mesh: &FarMesh, edges: &[Edge]) -> Vec<Vec<u32>> {
    let boundary = mesh.boundary();
    let kind = |face: u32| matches!(boundary[face as usize].condition, Condition::Potential(_));
    let mut across = vec![Vec::new(); boundary.len()];
    for edge in edges.iter().filter(|edge| edge.bend().abs() < rims::LEAST_BEND) {
        let [first, second] = edge.faces;
        if first != second && kind(first) == kind(second) {
            across[first as usize].push(second);
            across[second as usize].push(first);
        }
    }
    let is_near = |face: u32, other: u32| {
        let (first, second) = (&boundary[face as usize], &boundary[other as usize]);
        // Faces that only a period joins are two walls.
        (first.centre - second.centre).norm() < NEIGHBOURS * (half_diagonal(first) + half_diagonal(second))
    };
    let of = |face: u32| {
        let direct = &across[face as usize];
        let further = direct.iter().flat_map(|&next| across[next as usize].iter().copied());
        let all = direct.iter().copied().chain(further);
        let mut found: Vec<u32> = all.filter(|&other| other != face && is_near(face, other)).collect();
        found.sort_unstable();
        found.dedup();
        found
    };
    (0..boundary.len() as u32).map(of).collect()
}

/// Sets of faces that are connected, each in ascending order.
fn connected(around: &[Vec<u32>]) -> Vec<Vec<u32>> {
    let mut seen = vec![false; around.len()];
    let mut sets = Vec::new();
    for first in 0..around.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let mut set = vec![first as u32];
        let mut next = 0;
        while let Some(&face) = set.get(next) {
            next += 1;
            for &other in &around[face as usize] {
                if !std::mem::replace(&mut seen[other as usize], true) {
                    set.push(other);
                }
            }
        }
        set.sort_unstable();
        sets.push(set);
    }
    sets
}

#[cfg(test)]
mod tests;
