//! Touching grains of every grain, for contacts that must see each other's charges change.

use crate::contacts::neighbours::{Listed, Neighbours};
use crate::motion::grains::Grains;
use amberfield_core::Vector3;

/// Two places closer than this, over their distance from the grain, are the same grain's.
const SAME: f64 = 1e-9;

/// Index that stands for a wall where a partner's is asked for.
pub(super) const WALL: usize = usize::MAX;

/// A grain that touches another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Toucher {
    pub(super) grain: usize,
    /// Offset from the grain that it touches to it [m].
    pub(super) offset: Vector3<f64>,
}

/// The touching grains of every grain, sorted indices.
#[derive(Debug, Default)]
pub(super) struct Around {
    start: Vec<u32>,
    touchers: Vec<Toucher>,
}

impl Around {
    pub(super) fn build(&mut self, grains: &Grains, neighbours: &Neighbours) {
        self.start.clear();
        self.start.resize(grains.len() + 2, 0);
        for Listed { i, j, .. } in neighbours.touching() {
            self.start[i + 2] += 1;
            self.start[j + 2] += 1;
        }
        for i in 2..self.start.len() {
            self.start[i] += self.start[i - 1];
        }
        let empty = Toucher { grain: 0, offset: Vector3::zeros() };
        self.touchers.clear();
        self.touchers.resize(self.start[grains.len() + 1] as usize, empty);
        for pair in neighbours.touching() {
            let (i, j, offset) = (pair.i, pair.j, pair.offset(grains, &neighbours.shifts));
            for (a, b, offset) in [(i, j, offset), (j, i, -offset)] {
                let slot = &mut self.start[a + 1];
                self.touchers[*slot as usize] = Toucher { grain: b, offset };
                *slot += 1;
            }
        }
    }

    pub(super) fn of(&self, grain: usize) -> &[Toucher] {
        &self.touchers[self.start[grain] as usize..self.start[grain + 1] as usize]
    }

    /// Calls `each` with the grains that touch i or j, once each and neither of the two; offsets are from i.
    pub(super) fn beside(&self, i: usize, j: &Toucher, mut each: impl FnMut(usize, Vector3<f64>)) {
        let same = |a: &Vector3<f64>, b: &Vector3<f64>| {
            (a - b).norm_squared() < SAME * SAME * j.offset.norm_squared()
        };
        let of_i = self.of(i);
        for toucher in of_i.iter().filter(|t| t.grain != j.grain || !same(&t.offset, &j.offset)) {
            each(toucher.grain, toucher.offset);
        }
        if j.grain == WALL {
            return;
        }
        for toucher in self.of(j.grain) {
            let offset = j.offset + toucher.offset;
            let known = of_i.iter().any(|t| t.grain == toucher.grain && same(&t.offset, &offset));
            let itself = toucher.grain == i && same(&offset, &Vector3::zeros());
            if !(known || itself) {
                each(toucher.grain, offset);
            }
        }
    }
}
