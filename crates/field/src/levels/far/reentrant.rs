//! Walls that meet in a re-entrant edge within one cell, as around the trailing edge of a wing.
//!
//! A point is outside such a cell only where it is beyond both walls; beyond one of them it may be beside the
//! wing.

use super::mesh::{FarMeshParts, Neighbour};

/// Distance of a face's centre beyond another face from which on the edge between is re-entrant, over the
/// cell's size.
const BEYOND: f64 = 1e-6;

/// Two faces of a cell, by their numbers in it, that only together bound it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FacePair {
    pub(super) one: u32,
    pub(super) other: u32,
}

impl FacePair {
    /// The face that stands beside a face of the pair; `None` for a face that is not in it.
    pub(super) fn beside(self, face: usize) -> Option<usize> {
        let (one, other) = (self.one as usize, self.other as usize);
        if face == one { Some(other) } else { (face == other).then_some(one) }
    }
}

/// Pairs of walls that meet in re-entrant edges, cell by cell.
#[derive(Clone, Debug)]
pub(super) struct ReentrantEdges {
    first: Vec<u32>,
    pairs: Vec<FacePair>,
}

impl ReentrantEdges {
    pub(super) fn new(parts: &FarMeshParts) -> Self {
        let mut edges = Self { first: vec![0], pairs: Vec::new() };
        let mut walls = Vec::new();
        for (cell, ends) in parts.first_face.windows(2).enumerate() {
            let faces = &parts.faces[ends[0] as usize..ends[1] as usize];
            walls.clear();
            walls.extend(faces.iter().enumerate().filter_map(|(number, face)| match face.neighbour {
                Neighbour::Boundary(index) => Some((number, face, parts.boundary[index as usize].centre)),
                Neighbour::Cell { .. } => None,
            }));
            let least = BEYOND * parts.volumes[cell].cbrt();
            for (place, (one, a, of_a)) in walls.iter().enumerate() {
                for (other, b, of_b) in &walls[place + 1..] {
                    // Beyond each other: at an edge that is not re-entrant both are on their inner sides.
                    if a.beyond(of_b) > least && b.beyond(of_a) > least {
                        edges.pairs.push(FacePair { one: *one as u32, other: *other as u32 });
                    }
                }
            }
            edges.first.push(edges.pairs.len() as u32);
        }
        edges
    }

    /// Pairs of a cell.
    pub(super) fn of(&self, cell: usize) -> &[FacePair] {
        &self.pairs[self.first[cell] as usize..self.first[cell + 1] as usize]
    }
}
