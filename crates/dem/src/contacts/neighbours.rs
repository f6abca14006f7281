//! Verlet lists by chunk, and the contact histories that live in them.

use crate::contacts::cells::{INDEX_BITS, INDEX_MASK, LinkedCells};
use crate::contacts::material_pairs::Features;
use crate::contacts::memory::{CarriedPair, Follow, Foreseen, Grown, Growth, PairHistory, Spring};
use crate::motion::chunks::{CHUNK, NO_PUSH, Push, chunk_count, for_each_chunk, is_parallel};
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Vector3};

/// A touching entry found by the distance test of the step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Hit {
    pub(crate) entry: u32,
    pub(crate) local: u32,
    /// Outbox slot; only meaningful when the partner is in another chunk.
    pub(crate) slot: u32,
}

/// Lists of the grains of one chunk: each pair is in one list only.
#[derive(Debug, Default)]
pub(crate) struct ChunkList {
    /// First entry of each grain, and the end.
    pub(crate) start: Vec<u32>,
    /// Partner index and shift code.
    pub(crate) partner: Vec<u32>,
    /// Whether the entry touched at the last evaluation.
    pub(crate) touching: Vec<bool>,
    /// Tangential springs; empty without friction.
    pub(crate) spring: Vec<Spring>,
    /// Rolling spring torque [N·m]; empty without rolling friction.
    pub(crate) rolling: Vec<[f64; 3]>,
    /// Charging of the entries; empty without charge transfer.
    pub(crate) growth: Vec<Growth>,
    /// E_x·n of the entries by evaluations of the field; empty without charge transfer.
    pub(crate) foreseen: Vec<Foreseen>,
    /// Entries whose growth is due, in the making of a trade.
    pub(crate) grown: Vec<Grown>,
    /// Contacts that began at the last evaluation.
    pub(crate) met: Vec<Hit>,
    /// Scratch of the step.
    pub(crate) hits: Vec<Hit>,
    /// Pushes of this chunk on grains of others.
    pub(crate) outbox: Vec<Push>,
    /// Marks of the outbox's slots that hold something in this step.
    pub(crate) filled: Vec<bool>,
    /// Touching pairs of the last evaluation.
    pub(crate) contacts: usize,
    /// Largest overlap of them over the smaller radius.
    pub(crate) deepest: f64,
}

/// A listed pair.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Listed {
    /// Chunk whose list holds it, and entry there.
    pub(crate) chunk: usize,
    pub(crate) entry: usize,
    /// Sorted indices.
    pub(crate) i: usize,
    pub(crate) j: usize,
    code: u32,
}

impl Listed {
    /// Offset from the centre of i to that of j, or to its image [m].
    pub(crate) fn offset(&self, grains: &Grains, shifts: &[[f64; 3]; 32]) -> Vector3<f64> {
        let shift = Vector3::from(shifts[(self.code >> INDEX_BITS) as usize]);
        grains.position(self.j) - grains.position(self.i) + shift
    }

    /// Distance of the centres, or of that of i from j's image [m].
    pub(crate) fn distance(&self, grains: &Grains, shifts: &[[f64; 3]; 32]) -> f64 {
        let shift = shifts[(self.code >> INDEX_BITS) as usize];
        let (a, b) = (&grains.centre[self.i], &grains.centre[self.j]);
        // The shift is added before the other centre is subtracted, as where the lists inherit.
        (0..3).map(|x| (b[x] + shift[x] - a[x]).powi(2)).sum::<f64>().sqrt()
    }
}

/// Place in which a grain finds another chunk's push on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Inbound {
    pub(crate) chunk: u32,
    pub(crate) slot: u32,
    pub(crate) local: u32,
}

/// All lists.
#[derive(Debug)]
pub(crate) struct Neighbours {
    pub(super) cells: LinkedCells,
    pub(crate) shifts: [[f64; 3]; 32],
    pub(crate) features: Features,
    pub(crate) lists: Vec<ChunkList>,
    previous: Vec<ChunkList>,
    pub(crate) inbox: Vec<Vec<Inbound>>,
    /// Centres at the last build, and those of loose grains when they were alone last [m].
    pub(crate) reference: Vec<Vector3<f64>>,
    /// Number of grains that were there at the last build; the others after them are loose.
    pub(crate) listed: usize,
}

impl Neighbours {
    pub(crate) fn new(cells: LinkedCells, shifts: [[f64; 3]; 32], features: Features) -> Self {
        Self {
            cells,
            shifts,
            features,
            lists: Vec::new(),
            previous: Vec::new(),
            inbox: Vec::new(),
            reference: Vec::new(),
            listed: 0,
        }
    }

    pub(crate) fn level_count(&self) -> usize {
        self.cells.level_count()
    }

    /// Builds all lists from the grains' present centres; those after the first `listed` are loose.
    /// `order[new] = old` tells where each grain was when the present lists were built, so that histories
    /// move along.
    pub(crate) fn build(&mut self, domain: &Domain, grains: &Grains, listed: usize, order: &[u32]) {
        self.reference.clear();
        self.reference.extend((0..grains.len()).map(|i| grains.position(i)));
        self.listed = listed;
        self.cells.fill(domain, &self.shifts, &grains.centre[..listed], |i| grains.level[i]);
        std::mem::swap(&mut self.lists, &mut self.previous);
        let chunks = chunk_count(grains.len());
        self.lists.resize_with(chunks, ChunkList::default);
        let (cells, features, shifts, previous) = (&self.cells, self.features, &self.shifts, &self.previous);
        let lists = &mut self.lists;
        let mut marks = vec![(); chunks];
        for_each_chunk!(is_parallel(grains.len()), chunks, (lists / 1, marks / 1), |k: usize,
                                                                                    (list, _): (
            &mut [ChunkList],
            &mut [()]
        )| {
            let list = &mut list[0];
            list.fill(k, cells, grains, listed, features);
            // Cohesive contacts, which may be stretched, have tangential history too.
            if (features.rotation() || features.charging) && !previous.is_empty() {
                list.inherit(k, grains, shifts, previous, order, features);
            }
        });
        self.connect(grains.len());
    }

    /// Gives every entry that crosses chunks a slot, and tells the other chunk about it.
    fn connect(&mut self, count: usize) {
        let chunks = chunk_count(count);
        self.inbox.resize_with(chunks, Vec::new);
        for inbox in &mut self.inbox {
            inbox.clear();
        }
        for (k, list) in self.lists.iter_mut().enumerate() {
            let mut slots = 0;
            for partner in &list.partner {
                let j = (partner & INDEX_MASK) as usize;
                if j / CHUNK != k {
                    self.inbox[j / CHUNK].push(Inbound {
                        chunk: k as u32,
                        slot: slots,
                        local: (j % CHUNK) as u32,
                    });
                    slots += 1;
                }
            }
            list.outbox.clear();
            list.outbox.resize(slots as usize, NO_PUSH);
            list.filled.clear();
            list.filled.resize(slots as usize, false);
        }
    }

    /// Pushes of other chunks on chunk `k` in this step: index in the chunk, and push.
    #[inline]
    pub(crate) fn pushes(&self, k: usize) -> impl Iterator<Item = (usize, &Push)> {
        self.inbox[k].iter().filter_map(|inbound| {
            let (list, slot) = (&self.lists[inbound.chunk as usize], inbound.slot as usize);
            list.filled[slot].then(|| (inbound.local as usize, &list.outbox[slot]))
        })
    }

    /// Histories of the touching pairs, with indices of the set-up's order.
    pub(crate) fn histories(&self, grains: &Grains) -> Vec<PairHistory> {
        let history = |pair: Listed| {
            let (list, entry) = (&self.lists[pair.chunk], pair.entry);
            PairHistory {
                i: pair.i as u32,
                entry: entry as u32 - list.start[pair.i % CHUNK],
                partner: grains.original[pair.j],
                spring: list.spring.get(entry).copied().unwrap_or_default(),
                rolling: list.rolling.get(entry).copied().unwrap_or_default(),
            }
        };
        self.touching().map(history).collect()
    }

    /// Puts saved histories back; `Err` names the first that finds no entry.
    pub(crate) fn restore(&mut self, grains: &Grains, histories: &[PairHistory]) -> Result<(), String> {
        for h in histories {
            let (k, local) = (h.i as usize / CHUNK, h.i as usize % CHUNK);
            let list = self.lists.get_mut(k).filter(|list| local + 1 < list.start.len());
            let list = list.ok_or_else(|| format!("contact of unknown grain index {}", h.i))?;
            let entry = (list.start[local] + h.entry) as usize;
            let known = entry < list.start[local + 1] as usize
                && grains.original[(list.partner[entry] & INDEX_MASK) as usize] == h.partner;
            if !known {
                return Err(format!("contact {} of grain index {} has another partner", h.entry, h.i));
            }
            list.touching[entry] = true;
            list.contacts += 1;
            if let Some(spring) = list.spring.get_mut(entry) {
                *spring = h.spring;
            }
            if let Some(rolling) = list.rolling.get_mut(entry) {
                *rolling = h.rolling;
            }
        }
        Ok(())
    }

    /// Gives pairs the memory that they had in another run; `carried` are sorted by [`CarriedPair::key`].
    pub(crate) fn carry(&mut self, grains: &Grains, carried: &[CarriedPair]) {
        for k in 0..self.lists.len() {
            let list = &mut self.lists[k];
            for local in 0..list.start.len() - 1 {
                for entry in list.start[local] as usize..list.start[local + 1] as usize {
                    let i = grains.original[k * CHUNK + local];
                    let j = grains.original[(list.partner[entry] & INDEX_MASK) as usize];
                    let key = CarriedPair::key([i, j]);
                    let found = carried.binary_search_by_key(&key, |pair| CarriedPair::key(pair.grains));
                    let Ok(found) = found else { continue };
                    let CarriedPair { grains: [first, _], spring, rolling } = carried[found];
                    let sign = if first == i { 1.0 } else { -1.0 };
                    list.touching[entry] = true;
                    if let Some(kept) = list.spring.get_mut(entry) {
                        *kept = Spring { force: spring.force.map(|f| sign * f), ..spring };
                    }
                    if let Some(kept) = list.rolling.get_mut(entry) {
                        *kept = rolling.map(|torque| sign * torque);
                    }
                }
            }
        }
    }

    /// All listed pairs.
    pub(crate) fn pairs(&self) -> impl Iterator<Item = Listed> + '_ {
        self.lists.iter().enumerate().flat_map(|(k, list)| {
            (0..list.start.len() as u32 - 1).flat_map(move |local| {
                let range = list.start[local as usize]..list.start[local as usize + 1];
                range.map(move |entry| list.listed(k, local, entry))
            })
        })
    }

    /// Touching pairs.
    pub(crate) fn touching(&self) -> impl Iterator<Item = Listed> + '_ {
        self.pairs().filter(|pair| self.lists[pair.chunk].touching[pair.entry])
    }

    /// Pairs that began to touch at the last evaluation, in order.
    pub(crate) fn met(&self) -> impl Iterator<Item = Listed> + '_ {
        let lists = self.lists.iter().enumerate();
        lists.flat_map(|(k, list)| list.met.iter().map(move |hit| list.listed(k, hit.local, hit.entry)))
    }

    /// Number of touching pairs.
    pub(crate) fn contacts(&self) -> usize {
        self.lists.iter().map(|list| list.contacts).sum()
    }
}

impl ChunkList {
    /// A pair of this list, which is chunk k's.
    #[inline(always)]
    pub(crate) fn listed(&self, k: usize, local: u32, entry: u32) -> Listed {
        let code = self.partner[entry as usize];
        let (i, j) = (k * CHUNK + local as usize, (code & INDEX_MASK) as usize);
        Listed { chunk: k, entry: entry as usize, i, j, code }
    }

    /// Follows the contact area [m²] of a touching entry, before the list takes note that it touches.
    #[inline(always)]
    pub(crate) fn follow_area(&mut self, entry: u32, area: f64, follow: Follow) {
        let entry = entry as usize;
        self.growth[entry].follow(area, self.touching[entry], follow);
    }

    fn fill(&mut self, k: usize, cells: &LinkedCells, grains: &Grains, listed: usize, features: Features) {
        self.start.clear();
        self.partner.clear();
        let (first, last) = (k * CHUNK, grains.len().min((k + 1) * CHUNK));
        for i in first..last {
            let begin = self.partner.len();
            self.start.push(begin as u32);
            if i >= listed {
                continue;
            }
            cells.partners(i as u32, grains.level[i], &grains.centre[i], &mut self.partner);
            if grains.some_fixed && grains.is_fixed(i) {
                drop_fixed(&mut self.partner, begin, grains);
            }
        }
        let entries = self.partner.len();
        self.start.push(entries as u32);
        self.touching.clear();
        self.touching.resize(entries, false);
        self.spring.clear();
        self.spring.resize(if features.friction { entries } else { 0 }, Spring::default());
        self.rolling.clear();
        self.rolling.resize(if features.rolling { entries } else { 0 }, [0.0; 3]);
        self.growth.clear();
        self.growth.resize(if features.charging { entries } else { 0 }, Growth::default());
        self.foreseen.clear();
        self.foreseen.resize(self.growth.len(), Foreseen::default());
        self.grown.clear();
        self.grown.reserve(self.growth.len());
        self.met.clear();
        self.met.reserve(entries);
        self.hits.resize(entries + 1, Hit::default());
        self.contacts = 0;
    }

    /// Takes the histories of pairs that overlap now from the lists before, and the fields foreseen of all.
    fn inherit(
        &mut self,
        k: usize,
        grains: &Grains,
        shifts: &[[f64; 3]; 32],
        previous: &[Self],
        order: &[u32],
        features: Features,
    ) {
        for local in 0..self.start.len() - 1 {
            let i = k * CHUNK + local;
            for entry in self.start[local] as usize..self.start[local + 1] as usize {
                let partner = self.partner[entry];
                let j = (partner & INDEX_MASK) as usize;
                let shift = shifts[(partner >> INDEX_BITS) as usize];
                let (a, b) = (&grains.centre[i], &grains.centre[j]);
                let d2: f64 = (0..3).map(|x| (b[x] + shift[x] - a[x]).powi(2)).sum();
                // A stretched contact is none by its overlap; the next evaluation ends it where it breaks.
                let overlaps = d2 < (a[3] + b[3]).powi(2) || features.stretches();
                if !(overlaps || features.charging) {
                    continue;
                }
                let (old_i, old_j) = (order[i], order[j]);
                let found = find(previous, old_i, old_j)
                    .map(|(list, e)| (list, e, 1.0))
                    .or_else(|| find(previous, old_j, old_i).map(|(list, e)| (list, e, -1.0)));
                let Some((list, old, sign)) = found else { continue };
                if features.charging {
                    self.foreseen[entry] = list.foreseen[old].times(sign);
                }
                if overlaps && list.touching[old] {
                    self.touching[entry] = true;
                    if features.friction {
                        let Spring { force, contact_radius } = list.spring[old];
                        self.spring[entry] = Spring { force: force.map(|f| sign * f), contact_radius };
                    }
                    if features.rolling {
                        self.rolling[entry] = list.rolling[old].map(|c| sign * c);
                    }
                    if features.charging {
                        self.growth[entry] = list.growth[old];
                    }
                }
            }
        }
    }
}

/// Drops the partners from index `first` on that never move: two such grains do nothing to each other.
fn drop_fixed(partners: &mut Vec<u32>, first: usize, grains: &Grains) {
    let mut kept = first;
    for n in first..partners.len() {
        if !grains.is_fixed((partners[n] & INDEX_MASK) as usize) {
            partners[kept] = partners[n];
            kept += 1;
        }
    }
    partners.truncate(kept);
}

/// Entry of `j` in the list of `i`; none of a grain that came after the lists were built.
fn find(lists: &[ChunkList], i: u32, j: u32) -> Option<(&ChunkList, usize)> {
    let list = lists.get(i as usize / CHUNK)?;
    let local = i as usize % CHUNK;
    let (first, end) = (*list.start.get(local)?, *list.start.get(local + 1)?);
    (first as usize..end as usize)
        .find(|&entry| list.partner[entry] & INDEX_MASK == j)
        .map(|entry| (list, entry))
}
