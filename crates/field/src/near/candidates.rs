//! The sources around a group of targets, side by side, in units of the cut-off radius.

use crate::processor::{BLOCK, PADDING, Real, Vector};
use std::ops::Range;

/// Where a candidate that must not count is put: beyond the cut-off of every target of a group, and near enough for
/// no power of its distance to overflow.
const FAR: f64 = 8.0;

/// Sources in separate arrays, with [`PADDING`] more values behind the last: coordinates over the cut-off radius,
/// charges over the largest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sources<'a> {
    pub(crate) x: &'a [f64],
    pub(crate) y: &'a [f64],
    pub(crate) z: &'a [f64],
    pub(crate) charge: &'a [f64],
}

/// Candidates for partners: coordinates and charges.
#[derive(Debug, Default)]
pub(crate) struct Candidates<T> {
    pub(crate) x: Vec<T>,
    pub(crate) y: Vec<T>,
    pub(crate) z: Vec<T>,
    pub(crate) charge: Vec<T>,
    len: usize,
}

impl<T: Real> Candidates<T> {
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

    /// Takes a candidate out of the sums, and tells where it is.
    #[inline(always)]
    pub(crate) fn hide(&mut self, own: usize) -> [T; 3] {
        let place = [self.x[own], self.y[own], self.z[own]];
        self.x[own] = T::narrow(FAR);
        place
    }

    /// Undoes [`Self::hide`].
    #[inline(always)]
    pub(crate) fn show(&mut self, own: usize, place: [T; 3]) {
        self.x[own] = place[0];
    }

    #[inline(always)]
    fn make_room(&mut self, more: usize) {
        let least = self.len + more;
        if self.x.len() < least {
            for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.charge] {
                array.resize(2 * least, T::zero());
            }
        }
    }
}
