//! Trade of grains with each other.

use super::around::Toucher;
use super::{Charging, LAG_SEEN, Traders};
use crate::contacts::memory::Grown;
use crate::contacts::neighbours::{ChunkList, Listed, Neighbours};
use crate::motion::chunks::CHUNK;
use amberfield_core::Vector3;
use amberfield_laws::charge_transfer::{ChargedSphere, Drive, between_grains};
use rayon::prelude::*;

impl ChunkList {
    /// Lists the entries whose growth is due.
    fn list_grown(&mut self) {
        self.grown.clear();
        for (local, range) in self.start.windows(2).enumerate() {
            let due = (range[0]..range[1]).filter(|&entry| self.growth[entry as usize].due() > 0.0);
            self.grown.extend(due.map(|entry| Grown { entry, local: local as u32 }));
        }
    }
}

/// Sums over pairs that traded.
#[derive(Clone, Copy, Debug, Default)]
struct Traded {
    /// Σ of the sizes of the charges [C].
    moved: f64,
    /// Largest αΔA.
    largest: f64,
}

impl Traded {
    fn and(self, other: Self) -> Self {
        Self { moved: self.moved + other.moved, largest: self.largest.max(other.largest) }
    }
}

/// Charge of a grain [C]; `None` where it takes no part.
pub(super) type MemberCharge = Option<f64>;

/// A pair about to trade.
struct Trading {
    drive: Drive,
    work: f64,
    /// Growth of the area [m²], corrected.
    growth: f64,
}

impl Trading {
    /// αΔA.
    fn relaxes(&self) -> f64 {
        self.drive.decay * self.growth
    }
}

impl Charging {
    /// Moves what is due between pairs of grains. `charge` is by the set-up's order [C].
    pub(super) fn trade_pairs(
        &mut self,
        traders: Traders<'_>,
        neighbours: &mut Neighbours,
        charge: &mut [f64],
    ) {
        neighbours.lists.par_iter_mut().for_each(ChunkList::list_grown);
        if neighbours.lists.iter().all(|list| list.grown.is_empty()) {
            self.gathered = 0;
            return;
        }
        let original = &traders.grains.original;
        let mut held = std::mem::take(&mut self.held);
        held.clear();
        held.extend((0..original.len()).map(|i| traders.member(i).map(|original| charge[original])));
        let mut traded = Traded::default();
        if self.lag <= LAG_SEEN {
            let shifts = &neighbours.shifts;
            traded = self.trade_mild(traders, shifts, 0, &mut neighbours.lists, &mut held);
        }
        traded = traded.and(self.trade_stiff(traders, neighbours, &mut held));
        for ((held, &original), material) in held.iter().zip(original).zip(&traders.grains.material) {
            if let Some(held) = held {
                let charge = &mut charge[original.index()];
                self.ledger.gained[usize::from(*material)] += *held - *charge;
                *charge = *held;
            }
        }
        self.held = held;
        self.backwards = !self.backwards;
        self.gathered = 0;
        self.lag += traded.largest;
        self.ledger.moved += traded.moved;
    }

    /// Trades the pairs of chunks from `first` on that barely relax: first those with both grains in the same
    /// half of the chunks, the halves side by side, then the others. The halves depend on the number of
    /// chunks alone. Pairs that relax more stay listed as grown.
    fn trade_mild(
        &self,
        traders: Traders<'_>,
        shifts: &[[f64; 3]; 32],
        first: usize,
        lists: &mut [ChunkList],
        held: &mut [MemberCharge],
    ) -> Traded {
        let mut traded = Traded::default();
        if lists.len() > 1 {
            let half = lists.len() / 2;
            let (left, right) = lists.split_at_mut(half);
            let (of_left, of_right) = held.split_at_mut(half * CHUNK);
            let (left, right) = rayon::join(
                || self.trade_mild(traders, shifts, first, left, of_left),
                || self.trade_mild(traders, shifts, first + half, right, of_right),
            );
            traded = left.and(right);
        }
        let from = first * CHUNK;
        for (k, list) in (first..).zip(lists) {
            let mut grown = std::mem::take(&mut list.grown);
            grown.retain(|&Grown { entry, local }| {
                let pair = list.listed(k, local, entry);
                let (i, j) = (pair.i - from, pair.j.wrapping_sub(from));
                // The partner is outside this part of the chunks: the pair waits for a larger part.
                if j >= held.len() {
                    return true;
                }
                let Some(trading) = self.trading(traders, shifts, pair, list, [held[i], held[j]]) else {
                    list.growth[pair.entry].settle();
                    return false;
                };
                if self.lag + trading.relaxes() > LAG_SEEN {
                    return true;
                }
                list.growth[pair.entry].settle();
                traded = traded.and(self.carry_out(&trading, held, i, j));
                false
            });
            list.grown = grown;
        }
        traded
    }

    /// Trades the pairs that are left, one after another, each with the present charges of the grains that
    /// touch its own; first to last and last to first in turn.
    fn trade_stiff(
        &mut self,
        traders: Traders<'_>,
        neighbours: &mut Neighbours,
        held: &mut [MemberCharge],
    ) -> Traded {
        let mut traded = Traded::default();
        if neighbours.lists.iter().all(|list| list.grown.is_empty()) {
            return traded;
        }
        let grains = traders.grains;
        self.around.build(grains, neighbours);
        let chunks = neighbours.lists.len();
        for k in 0..chunks {
            let k = if self.backwards { chunks - 1 - k } else { k };
            let mut grown = std::mem::take(&mut neighbours.lists[k].grown);
            let count = grown.len();
            for n in 0..count {
                let Grown { entry, local } = grown[if self.backwards { count - 1 - n } else { n }];
                let pair = neighbours.lists[k].listed(k, local, entry);
                let Listed { i, j, .. } = pair;
                let list = &mut neighbours.lists[k];
                let trading = self.trading(traders, &neighbours.shifts, pair, list, [held[i], held[j]]);
                // A pair of which one grain takes no part does not trade, and is settled too.
                list.growth[pair.entry].settle();
                let Some(mut trading) = trading else { continue };
                let offset = pair.offset(grains, &neighbours.shifts);
                let [one, other] = [i, j].map(|grain| grains.centre[grain][3]);
                // The contact lies in the middle of the overlap.
                let reach = one - 0.5 * (one + other - offset.norm());
                let partner = Toucher { grain: j, offset };
                let charges = |grain: usize| held[grain].unwrap_or(0.0);
                let gained = self.gained_beside(grains, i, &partner, offset.normalize(), reach, charges);
                trading.drive.drive += self.permittivity * gained;
                traded = traded.and(self.carry_out(&trading, held, i, j));
            }
            grown.clear();
            neighbours.lists[k].grown = grown;
        }
        traded
    }

    /// Drive of the charge through a pair with the field of the last evaluation; `None` if one of the two
    /// takes no part.
    #[inline(always)]
    fn trading(
        &self,
        traders: Traders<'_>,
        shifts: &[[f64; 3]; 32],
        pair: Listed,
        list: &ChunkList,
        held: [MemberCharge; 2],
    ) -> Option<Trading> {
        let [Some(of_i), Some(of_j)] = held else { return None };
        let Listed { i, j, .. } = pair;
        let grains = traders.grains;
        let materials = self.table.get(grains.material[i], grains.material[j]);
        // Half of the growth came earlier.
        let half = 0.5 * self.gathered as f64;
        let foreseen = list.foreseen[pair.entry].at(self.evaluation, self.age as f64 - half);
        let field = match (foreseen, traders.field.changing_uniform_before(half)) {
            (Some(field), Some(changing)) => field + changing.dot(&pair.offset(grains, shifts).normalize()),
            (Some(field), None) => field,
            (None, _) => self.unforeseen(traders, shifts, pair, [of_i, of_j]),
        };
        let colliders = [(of_i, i), (of_j, j)]
            .map(|(charge, grain)| ChargedSphere { charge, radius: grains.centre[grain][3] });
        let drive = between_grains(self.permittivity, materials.work, colliders, field);
        Some(Trading {
            drive,
            work: materials.work,
            growth: list.growth[pair.entry].due() * materials.area_factor,
        })
    }

    /// Moves charge from i to j.
    #[inline(always)]
    fn carry_out(&self, trading: &Trading, held: &mut [MemberCharge], i: usize, j: usize) -> Traded {
        let moved = self.allowed(trading.drive, trading.work, trading.drive.transfer(trading.growth));
        held[i] = held[i].map(|charge| charge - moved);
        held[j] = held[j].map(|charge| charge + moved);
        Traded { moved: moved.abs(), largest: trading.relaxes() }
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
