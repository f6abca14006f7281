//! Smooth pieces of a boundary: the walls that mirror charges.

use super::boundary::{BoundaryFace, BoundaryFaces, Condition};
use super::creases;
use super::curved::CurvedWall;
use super::edges::Edge;
use super::flat::FlatWall;
use super::mirror::{Ground, Mirror};
use super::patch::half_diagonal;
use super::solid::Surroundings;
use nalgebra::Vector3;

/// Distance of neighbouring faces' centres over their half diagonals.
const NEIGHBOURS: f64 = 1.2;

/// A boundary, as walls are made of it.
#[derive(Clone, Copy)]
pub(super) struct Surface<'a> {
    pub(super) boundary: &'a dyn BoundaryFaces,
    pub(super) edges: &'a [Edge],
    pub(super) around: &'a [Surroundings],
    /// Factor of the ghosts' radii.
    pub(super) ghost_scale: f64,
    /// Factor of the distance up to which an edge takes the place of the planes beside it.
    pub(super) edge_scale: f64,
    /// Distance up to which edges matter [m].
    pub(super) reach: f64,
}

impl Surface<'_> {
    pub(super) fn ground(&self, face: u32) -> Ground {
        let around = &self.around[face as usize];
        Ground::new(around, self.boundary.carrier(), self.ghost_scale, self.edge_scale)
    }

    fn sign(&self, face: u32) -> f64 {
        match self.boundary.faces()[face as usize].condition {
            Condition::Potential(_) => -1.0,
            Condition::Slope(_) => 1.0,
        }
    }
}

/// Shape of a wall.
#[derive(Debug)]
pub(super) enum Shape {
    Flat(FlatWall),
    Curved(CurvedWall),
}

/// A wall and what its images' charges are multiplied with.
#[derive(Debug)]
pub(super) struct Wall {
    pub(super) shape: Shape,
    pub(super) sign: f64,
}

/// A wall, and the faces that it is made of, in ascending order.
#[derive(Debug)]
pub(super) struct WallOfFaces {
    pub(super) wall: Wall,
    pub(super) faces: Vec<u32>,
}

impl Surface<'_> {
    /// All walls, curved ones first.
    pub(super) fn walls(&self) -> Vec<WallOfFaces> {
        let beside = neighbours(self.boundary.faces(), self.edges);
        let mut walls: Vec<_> =
            connected(&beside).into_iter().map(|faces| self.wall_of(faces, &beside)).collect();
        walls.sort_by_key(|made| matches!(made.wall.shape, Shape::Flat(_)));
        walls
    }

    /// A wall of faces, each with its neighbours.
    fn wall_of(&self, faces: Vec<u32>, beside: &[Vec<u32>]) -> WallOfFaces {
        let shape = match FlatWall::new(self, &faces) {
            Some(wall) => Shape::Flat(wall),
            None => {
                let number = |face: &u32| faces.binary_search(face).expect("connected") as u32;
                let within: Vec<Vec<u32>> =
                    faces.iter().map(|&face| beside[face as usize].iter().map(number).collect()).collect();
                Shape::Curved(CurvedWall::new(self, &faces, &within))
            }
        };
        WallOfFaces { wall: Wall { shape, sign: self.sign(faces[0]) }, faces }
    }
}

impl Wall {
    /// Mirrors a charge at a point, with depths scaled.
    pub(super) fn mirror(&self, point: &Vector3<f64>, depth_scale: f64) -> Option<Mirror> {
        match &self.shape {
            Shape::Flat(flat) => flat.mirror(point, depth_scale),
            Shape::Curved(curved) => curved.mirror(point, depth_scale),
        }
    }
}

/// Each boundary face's neighbours that go on smoothly, with a condition of the same kind: those across an
/// edge, and those across one of theirs that are as near.
fn neighbours(boundary: &[BoundaryFace], edges: &[Edge]) -> Vec<Vec<u32>> {
    let kind = |face: u32| boundary[face as usize].gives_potential();
    let mut across = vec![Vec::new(); boundary.len()];
    for edge in edges.iter().filter(|edge| edge.bend().abs() < creases::LEAST_BEND) {
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
