//! Grain with grain.

use super::around::Toucher;
use super::{Charging, Grown, LAG_SEEN, Traders};
use crate::chunks::is_parallel;
use crate::grains::Grains;
use crate::neighbours::{ChunkList, Hit, Listed, Neighbours};
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
        for hit in 0..list.contacts {
            let Hit { entry, local, .. } = list.hits[hit];
            let at = entry as usize;
            let area = match list.spring.get(at) {
                // Its square is R*δ.
                Some([.., contact_radius]) => PI * contact_radius * contact_radius,
                None => {
                    let pair = list.listed(k, local, entry);
                    let (a, b) = (grains.centre[pair.i][3], grains.centre[pair.j][3]);
                    contact_area::hertz(a * b / (a + b), a + b - pair.offset(grains, shifts).norm())
                }
            };
            let [begins, is_due] = list.growth[at].follow(area, step, beyond);
            begun += u64::from(begins);
            if is_due {
                list.grown.push(Grown { entry, local });
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
        self.around.forget();
        let mut largest = 0.0_f64;
        let chunks = neighbours.lists.len();
        for k in 0..chunks {
            let k = if self.backwards { chunks - 1 - k } else { k };
            let mut grown = std::mem::take(&mut neighbours.lists[k].grown);
            let count = grown.len();
            for n in 0..count {
                let n = if self.backwards { count - 1 - n } else { n };
                let Grown { entry, local } = grown[n];
                let pair = neighbours.lists[k].listed(k, local, entry);
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
        pair: Listed,
        due: f64,
        charge: &mut [f64],
    ) -> f64 {
        let Listed { i, j, .. } = pair;
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
            if !self.around.is_known() {
                self.around.build(grains, neighbours);
            }
            let offset = pair.offset(grains, &neighbours.shifts);
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
        mut each: impl FnMut(Listed, Vector3<f64>),
    ) {
        let grains = traders.grains;
        for pair in neighbours.pairs() {
            let offset = pair.offset(grains, &neighbours.shifts);
            let reach = grains.centre[pair.i][3] + grains.centre[pair.j][3] + margin;
            let both = || [pair.i, pair.j].into_iter().all(|grain| traders.member(grain).is_some());
            if offset.norm_squared() < reach * reach && both() {
                each(pair, offset);
            }
        }
    }
}
