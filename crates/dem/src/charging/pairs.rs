//! Grain with grain.

use super::around::{Toucher, offset};
use super::{Charging, Grown, LAG_SEEN, Traders, sorted};
use crate::cells::INDEX_MASK;
use crate::chunks::{CHUNK, is_parallel};
use crate::grains::Grains;
use crate::neighbours::{ChunkList, Hit, Neighbours};
use amberfield_core::Vector3;
use amberfield_laws::charge_transfer::{Grain, between_grains};
use amberfield_laws::contact_area;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Follows the areas of all touching pairs at a step; how many begin.
pub(crate) fn follow(grains: &Grains, neighbours: &mut Neighbours, step: u64, beyond: bool) -> u64 {
    let shifts = &neighbours.shifts;
    let each = |(k, list): (usize, &mut ChunkList)| {
        let mut begun = 0_u64;
        let ChunkList { hits, contacts, spring, growth, grown, partner, .. } = list;
        for &Hit { entry, local, .. } in &hits[..*contacts] {
            let at = entry as usize;
            let area = match spring.get(at) {
                // Its square is R*δ.
                Some([.., contact_radius]) => PI * contact_radius * contact_radius,
                None => {
                    let code = partner[at];
                    let (a, b) =
                        (&grains.centre[sorted(k, local)], &grains.centre[(code & INDEX_MASK) as usize]);
                    let shift = &shifts[(code >> crate::cells::INDEX_BITS) as usize];
                    let distance2: f64 = (0..3).map(|x| (b[x] + shift[x] - a[x]).powi(2)).sum();
                    contact_area::hertz(a[3] * b[3] / (a[3] + b[3]), a[3] + b[3] - distance2.sqrt())
                }
            };
            let [begins, is_due] = growth[at].follow(area, step, beyond);
            begun += u64::from(begins);
            if is_due {
                grown.push(Grown { entry, local });
            }
        }
        begun
    };
    if is_parallel(grains.len()) {
        neighbours.lists.par_iter_mut().enumerate().map(each).sum()
    } else {
        neighbours.lists.iter_mut().enumerate().map(each).sum()
    }
}

/// A listed pair: sorted indices, and where it is listed.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    pub(super) chunk: usize,
    pub(super) entry: usize,
    pub(super) i: usize,
    pub(super) j: usize,
    code: u32,
}

impl Pair {
    pub(super) fn new(neighbours: &Neighbours, chunk: usize, grown: Grown) -> Self {
        let entry = grown.entry as usize;
        let code = neighbours.lists[chunk].partner[entry];
        Self { chunk, entry, i: sorted(chunk, grown.local), j: (code & INDEX_MASK) as usize, code }
    }

    /// From i to j [m].
    pub(super) fn offset(&self, grains: &Grains, neighbours: &Neighbours) -> Vector3<f64> {
        offset(grains, neighbours, self.i, self.code)
    }
}

impl Charging {
    /// Moves what is due between pairs of grains. `charge` is by the set-up's order [C].
    pub(crate) fn trade_pairs(
        &mut self,
        traders: Traders<'_>,
        neighbours: &mut Neighbours,
        charge: &mut [f64],
    ) {
        if neighbours.lists.iter().all(|list| list.grown.is_empty()) {
            return;
        }
        // Grains have moved since.
        self.around_is_built = false;
        let mut largest = 0.0_f64;
        let chunks = neighbours.lists.len();
        for k in 0..chunks {
            let k = if self.backwards { chunks - 1 - k } else { k };
            let mut grown = std::mem::take(&mut neighbours.lists[k].grown);
            let count = grown.len();
            for n in 0..count {
                let n = if self.backwards { count - 1 - n } else { n };
                let pair = Pair::new(neighbours, k, grown[n]);
                let due = neighbours.lists[k].growth[pair.entry].take_due();
                largest = largest.max(self.trade_pair(traders, neighbours, pair, due, charge));
            }
            grown.clear();
            neighbours.lists[k].grown = grown;
        }
        self.backwards = !self.backwards;
        self.lag += largest;
    }

    /// Returns αΔA.
    fn trade_pair(
        &mut self,
        traders: Traders<'_>,
        neighbours: &Neighbours,
        pair: Pair,
        due: f64,
        charge: &mut [f64],
    ) -> f64 {
        let Pair { i, j, .. } = pair;
        let (Some(a), Some(b)) = (traders.member(i), traders.member(j)) else { return 0.0 };
        let grains = traders.grains;
        let materials = self.table.get(grains.material[i], grains.material[j]);
        let growth = due * materials.area_factor;
        let of = |grain: usize, original: usize| Grain {
            charge: charge[original],
            radius: grains.centre[grain][3],
        };
        let known = neighbours.lists[pair.chunk].growth[pair.entry].field();
        let field = known.unwrap_or_else(|| self.unforeseen(traders, neighbours, pair, charge));
        let colliders = [of(i, a), of(j, b)];
        let mut drive = between_grains(self.permittivity, materials.work, colliders, field);
        if self.lag + drive.decay * growth > LAG_SEEN {
            if !self.around_is_built {
                self.around.build(grains, neighbours);
                self.around_is_built = true;
            }
            let offset = pair.offset(grains, neighbours);
            let [one, other] = colliders.map(|grain| grain.radius);
            let reach = one - 0.5 * (one + other - offset.norm());
            let partner = Toucher { grain: j, offset };
            let gained = self.gained_beside(grains, i, &partner, offset.normalize(), reach, charge);
            drive.drive += self.permittivity * gained;
        }
        let moved = self.allowed(drive, materials.work, drive.transfer(growth));
        charge[a] -= moved;
        charge[b] += moved;
        self.ledger.moved += moved.abs();
        self.changed.extend([i as u32, j as u32]);
        drive.decay * growth
    }

    /// Every listed pair of members that touches or is nearer than `margin` [m].
    pub(super) fn pairs_within(
        traders: Traders<'_>,
        neighbours: &Neighbours,
        margin: f64,
        mut each: impl FnMut(Pair, Vector3<f64>),
    ) {
        for (k, list) in neighbours.lists.iter().enumerate() {
            for local in 0..list.start.len() - 1 {
                let i = k * CHUNK + local;
                if traders.member(i).is_none() {
                    continue;
                }
                for entry in list.start[local]..list.start[local + 1] {
                    let pair = Pair::new(neighbours, k, Grown { entry, local: local as u32 });
                    let offset = pair.offset(traders.grains, neighbours);
                    let reach = traders.grains.centre[i][3] + traders.grains.centre[pair.j][3] + margin;
                    if offset.norm_squared() < reach * reach && traders.member(pair.j).is_some() {
                        each(pair, offset);
                    }
                }
            }
        }
    }
}
