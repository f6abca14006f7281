//! Crossings of cuboids: nodes around which up to eight of them meet face to face.
//!
//! A grain smaller than the cells is in those around one node, that of the corner next to its centre. All of
//! its places are given to the 27 nodes of these cells without looking for them.

use super::Nodes;
use super::block::{EVEN, add};
use nalgebra::Vector3;

/// Nodes along the three axes around a crossing, and steps from one to the next.
const AROUND: usize = 27;
pub(super) const STEPS: [usize; 3] = [1, 3, 9];

/// Cuboids around a node.
#[derive(Clone, Debug)]
pub(in super::super) struct Crossing {
    /// Lengths of the cells below and above along each axis [m]; 0 where there are none.
    lengths: [[f64; 2]; 3],
    /// Nodes from below along x, y, z; any where there are none.
    nodes: [u32; AROUND],
}

/// Place from a crossing [m].
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct FromCrossing<'a> {
    crossing: &'a Crossing,
    place: Vector3<f64>,
}

impl Crossing {
    /// Crossing of the cuboids around a node, if they are all that meet there: each cell, with the number of
    /// its corner that is the node.
    fn new(nodes: &Nodes, around: &[(u32, u8)]) -> Option<Self> {
        const NONE: u32 = u32::MAX;
        let (mut lengths, mut numbers) = ([[0.0; 2]; 3], [NONE; AROUND]);
        let mut is_there = [false; 8];
        for &(cell, corner) in around {
            let edges = nodes.blocks[cell as usize].as_ref()?.cuboid()? * 2.0;
            // A cell is above a node that is its lower corner.
            let above = usize::from(7 ^ corner);
            if std::mem::replace(&mut is_there[above], true) {
                return None;
            }
            for (axis, sides) in lengths.iter_mut().enumerate() {
                let length = &mut sides[above >> axis & 1];
                if *length > 0.0 && (*length - edges[axis]).abs() > EVEN * edges[axis] {
                    return None;
                }
                *length = edges[axis];
            }
            for (corner, &node) in nodes.of_cell[nodes.of_cell(cell as usize)].iter().enumerate() {
                let steps = |axis: usize| STEPS[axis] * ((above >> axis & 1) + (corner >> axis & 1));
                let number = &mut numbers[(0..3).map(steps).sum::<usize>()];
                if *number != NONE && *number != node {
                    return None;
                }
                *number = node;
            }
        }
        // All sides with all others: no edge of a wall sticks out here.
        let is_open = |above: usize| (0..3).all(|axis| lengths[axis][above >> axis & 1] > 0.0);
        let is_whole = (0..8).all(|above| is_open(above) == is_there[above]);
        let any = numbers.iter().copied().find(|node| *node != NONE)?;
        let nodes = numbers.map(|node| if node == NONE { any } else { node });
        is_whole.then_some(Self { lengths, nodes })
    }

    /// Crossings by node.
    pub(super) fn of_nodes(nodes: &Nodes, count: usize) -> Vec<Option<Self>> {
        let mut around = vec![Vec::new(); count];
        for cell in 0..nodes.blocks.len() {
            for (corner, &node) in nodes.of_cell[nodes.of_cell(cell)].iter().enumerate() {
                around[node as usize].push((cell as u32, corner as u8));
            }
        }
        around.iter().map(|around| Self::new(nodes, around)).collect()
    }
}

impl Nodes {
    /// Crossing next to a point [m] in a cell, if all that is within a reach [m] along the axes is in its
    /// cells or beyond a wall.
    #[inline(always)]
    pub(in super::super) fn crossing(
        &self,
        cell: u32,
        point: &Vector3<f64>,
        reach: f64,
    ) -> Option<FromCrossing<'_>> {
        let cell = cell as usize;
        let halves = self.blocks[cell].as_ref()?.cuboid()?;
        let from = point - self.centres[cell];
        let above = [0, 1, 2].map(|axis| usize::from(from[axis] > 0.0));
        let corner = above[0] | above[1] << 1 | above[2] << 2;
        let node = self.of_cell[self.of_cell(cell)][corner];
        let crossing = self.crossings[node as usize].as_ref()?;
        let mut place = from;
        let mut is_inside = true;
        for axis in 0..3 {
            place[axis] += halves[axis] * [1.0, -1.0][above[axis]];
            let [below, above] = crossing.lengths[axis];
            is_inside &= (below == 0.0) | (reach - place[axis] <= below);
            is_inside &= (above == 0.0) | (reach + place[axis] <= above);
        }
        is_inside.then_some(FromCrossing { crossing, place })
    }
}

impl FromCrossing<'_> {
    /// Gives the nodes around and their weights for places, as seen from this one [m], times their shares.
    #[inline(always)]
    pub(in super::super) fn give(
        &self,
        places: impl Iterator<Item = (Vector3<f64>, f64)>,
        mut give: impl FnMut(u32, f64),
    ) {
        let mut weights = [0.0; AROUND];
        for (beside, share) in places {
            let mut at = self.place + beside;
            let mut first = 0;
            for axis in 0..3 {
                let [below, above] = self.crossing.lengths[axis];
                // On a wall instead of beyond it.
                let x = at[axis].max(if below == 0.0 { 0.0 } else { -below });
                let x = x.min(above);
                let is_above = (x > 0.0) | (below == 0.0);
                let (length, from) = if is_above { (above, -1.0) } else { (below, 1.0) };
                at[axis] = 2.0 * x / length + from;
                first += if is_above { STEPS[axis] } else { 0 };
            }
            add(&at, share, first, STEPS, &mut weights);
        }
        for (&node, weight) in self.crossing.nodes.iter().zip(weights) {
            if weight != 0.0 {
                give(node, weight);
            }
        }
    }
}
