//! The sources around a group of targets, side by side, in units of the cut-off radius.

use crate::numerics::processor::{BLOCK, PADDING, Real, Vector};
use std::ops::Range;

/// Place to which a candidate that must not count is put: beyond the cut-off of every target of a group,
/// and near enough for no power of its distance to overflow.
const FAR: f64 = 8.0;

/// Sources in separate arrays, with [`PADDING`] more values behind the last: coordinates over the cut-off
/// radius, charges over the largest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sources<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) z: &'a [f64],
    pub(crate) charge: &'a [f64],
}

/// Candidates for partners: coordinates and charges.
#[derive(Debug, Default)]
pub(crate) struct NearSources<T> {
    pub(crate) x: Vec<T>,
    pub(crate) y: Vec<T>,
    pub(crate) z: Vec<T>,
    pub(crate) charge: Vec<T>,
    /// Zeros on either side of one square of a distance beyond the cut-off.
    apart: Vec<T>,
    /// Lanes of each vector that stayed, and the number of those that did before; made before [`Self::cull`].
    stayed: Vec<[u32; 2]>,
    len: usize,
}

impl<T: Real> NearSources<T> {
    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Number of candidates; [`Self::finish`] makes it a multiple of [`PADDING`].
    pub(crate) fn len(&self) -> usize {
        self.len
    }

    /// x, y, z and charge, each of length [`Self::len`].
    #[inline(always)]
    pub(crate) fn arrays(&self) -> [&[T]; 4] {
        [&self.x[..self.len], &self.y[..self.len], &self.z[..self.len], &self.charge[..self.len]]
    }

    /// Appends a run of sources, their places relative to `reference`.
    #[inline(always)]
    pub(crate) fn append<V: Vector<Number = T>>(
        &mut self,
        sources: Sources<'_>,
        run: Range<usize>,
        reference: [f64; 3],
    ) {
        self.make_room(run.len() + 2 * PADDING);
        let (mut from, mut to) = (run.start, self.len);
        // Whole blocks: what is written beyond the run's end is overwritten by the next run.
        while from < run.end {
            V::narrow(&sources.x[from..], reference[0], &mut self.x[to..]);
            V::narrow(&sources.y[from..], reference[1], &mut self.y[to..]);
            V::narrow(&sources.z[from..], reference[2], &mut self.z[to..]);
            V::narrow(&sources.charge[from..], 0.0, &mut self.charge[to..]);
            (from, to) = (from + BLOCK, to + BLOCK);
        }
        self.len += run.len();
    }

    /// Completes the last lanes with candidates that do not count.
    #[inline(always)]
    pub(crate) fn finish(&mut self) {
        self.make_room(PADDING);
        let whole = self.len.next_multiple_of(PADDING);
        for at in self.len..whole {
            self.x[at] = T::narrow(FAR);
            (self.y[at], self.z[at], self.charge[at]) = (T::zero(), T::zero(), T::zero());
        }
        self.len = whole;
    }

    /// Vectors of x, y, z and charge from number `at` on.
    #[inline(always)]
    pub(crate) fn load<V: Vector<Number = T>>(&self, at: usize) -> [V; 4] {
        let [x, y, z, charge] = self.arrays();
        [V::load(&x[at..]), V::load(&y[at..]), V::load(&z[at..]), V::load(&charge[at..])]
    }

    /// Drops candidates beyond the cut-off of a box and those without charge, no others.
    #[inline(always)]
    pub(crate) fn cull<V: Vector<Number = T>>(&mut self, [low, high]: [[T; 3]; 2]) {
        /// A bound above 1 by more than single precision rounds at such distances.
        const BOUND: f64 = 1.00001;
        let (zero, bound) = (V::splat(T::zero()), V::splat(T::narrow(BOUND)));
        let [low_x, low_y, low_z] = low;
        let [high_x, high_y, high_z] = high;
        let (low_x, low_y, low_z) = (V::splat(low_x), V::splat(low_y), V::splat(low_z));
        let (high_x, high_y, high_z) = (V::splat(high_x), V::splat(high_y), V::splat(high_z));
        self.stayed.clear();
        let mut kept = 0;
        for at in (0..self.len).step_by(V::LANES) {
            let [x, y, z, charge] = self.load::<V>(at);
            let dx = low_x.sub(x).max(x.sub(high_x)).max(zero);
            let dy = low_y.sub(y).max(y.sub(high_y)).max(zero);
            let dz = low_z.sub(z).max(z.sub(high_z)).max(zero);
            let near = dx.mul_add(dx, dy.mul_add(dy, dz.mul(dz))).below(bound);
            let lanes = near & zero.below(charge.max(zero.sub(charge)));
            self.stayed.push([lanes, kept]);
            // In place: never ahead of what is read.
            let to = kept as usize;
            x.pack(lanes, &mut self.x[to..]);
            y.pack(lanes, &mut self.y[to..]);
            z.pack(lanes, &mut self.z[to..]);
            charge.pack(lanes, &mut self.charge[to..]);
            kept += lanes.count_ones();
        }
        self.len = kept as usize;
        self.finish();
    }

    /// The number now of the candidate that had number `before` when [`Self::cull`] left it in.
    #[inline(always)]
    pub(crate) fn number<V: Vector<Number = T>>(&self, before: usize) -> usize {
        let [lanes, kept] = self.stayed[before / V::LANES];
        (kept + (lanes & ((1 << (before % V::LANES)) - 1)).count_ones()) as usize
    }

    /// Summands to the squares of the candidates' distances, so that `own` does not count; [`Self::len`]
    /// for nobody.
    #[inline(always)]
    pub(crate) fn apart(&self, own: usize) -> &[T] {
        &self.apart[self.apart.len() / 2 - own..][..self.len]
    }

    #[inline(always)]
    fn make_room(&mut self, more: usize) {
        let least = self.len + more;
        if self.x.len() < least {
            for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.charge] {
                array.resize(2 * least, T::zero());
            }
            self.apart = vec![T::zero(); 8 * least];
            self.apart[4 * least] = T::narrow(FAR);
        }
    }
}
