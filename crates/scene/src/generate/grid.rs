//! Linked cells in levels of size, for grains of any size mix.

use super::region::Region;
use nalgebra::Vector3;

/// Most levels; each halves the cell.
const MOST_LEVELS: usize = 12;
/// Most cells of a level, for each grain and at all.
const CELLS_PER_GRAIN: f64 = 8.0;
/// Most cells of a level at all.
const MOST_CELLS: f64 = 6.4e7;
/// End of a cell's list.
const NONE: u32 = u32::MAX;

/// Cells of one level: grains with a diameter of at most the cell and, but for the last level, above half of it.
#[derive(Debug)]
struct Level {
    cell: Vector3<f64>,
    counts: [usize; 3],
    heads: Vec<u32>,
    used: bool,
}

/// Grains in cells of their own size.
#[derive(Debug)]
pub(super) struct SizeGrid {
    levels: Vec<Level>,
    next: Vec<u32>,
    largest: f64,
    min: Vector3<f64>,
    periodic: [bool; 3],
}

impl SizeGrid {
    /// An empty grid for radii between `smallest` and `largest` [m] and indices below `count`.
    pub(super) fn new(region: &Region, smallest: f64, largest: f64, count: usize) -> Self {
        let extent = region.max - region.min;
        let mut levels = Vec::new();
        // Points have no size to make cells of.
        let mut edge = if largest > 0.0 { 2.0 * largest } else { extent.max() };
        #[expect(clippy::cast_precision_loss, reason = "a generator makes at most 1e8 grains")]
        let most_cells = (64.0 + CELLS_PER_GRAIN * count as f64).min(MOST_CELLS);
        loop {
            let fits = |edge: f64| {
                extent.iter().map(|length| (length / edge).floor().max(1.0)).product::<f64>() <= most_cells
            };
            while !fits(edge) {
                edge *= 1.5;
            }
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "bounded by MOST_CELLS"
            )]
            let counts: [usize; 3] =
                std::array::from_fn(|axis| (extent[axis] / edge).floor().max(1.0) as usize);
            #[expect(clippy::cast_precision_loss, reason = "bounded by MOST_CELLS")]
            let cell = Vector3::from_fn(|axis, _| extent[axis] / counts[axis] as f64);
            levels.push(Level { cell, counts, heads: vec![NONE; counts.iter().product()], used: false });
            edge *= 0.5;
            if edge < 2.0 * smallest || levels.len() == MOST_LEVELS || !fits(edge) {
                break;
            }
        }
        Self { levels, next: vec![NONE; count], largest, min: region.min, periodic: region.periodic }
    }

    /// Forgets all grains.
    pub(super) fn clear(&mut self) {
        for level in &mut self.levels {
            level.heads.fill(NONE);
            level.used = false;
        }
    }

    fn level_of(&self, radius: f64) -> usize {
        let mut level = 0;
        let mut half = 0.5 * self.largest;
        while level + 1 < self.levels.len() && radius <= half {
            level += 1;
            half *= 0.5;
        }
        level
    }

    /// Adds a grain.
    pub(super) fn insert(&mut self, index: usize, position: &Vector3<f64>, radius: f64) {
        let level = self.level_of(radius);
        let offset = position - self.min;
        let level = &mut self.levels[level];
        let cell: [usize; 3] =
            std::array::from_fn(|axis| coordinate(offset[axis] / level.cell[axis], level.counts[axis]));
        let head = &mut level.heads[(cell[0] * level.counts[1] + cell[1]) * level.counts[2] + cell[2]];
        self.next[index] = *head;
        *head = u32::try_from(index).expect("a generator makes at most 1e8 grains");
        level.used = true;
    }

    /// Calls `visit` for every grain that could touch a grain of the given place and size, until it returns
    /// `false`. Returns whether all were visited.
    pub(super) fn visit_near(
        &self,
        position: &Vector3<f64>,
        radius: f64,
        mut visit: impl FnMut(usize) -> bool,
    ) -> bool {
        let offset = position - self.min;
        let mut largest_here = self.largest;
        for level in &self.levels {
            if level.used {
                let reach = radius + largest_here;
                let ranges: [(isize, isize); 3] =
                    std::array::from_fn(|axis| self.cells_within(level, axis, offset[axis], reach));
                if !self.visit_level(level, &ranges, &mut visit) {
                    return false;
                }
            }
            largest_here *= 0.5;
        }
        true
    }

    /// First cell and number of cells within reach along an axis.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        reason = "cells per axis are at most MOST_CELLS"
    )]
    fn cells_within(&self, level: &Level, axis: usize, offset: f64, reach: f64) -> (isize, isize) {
        let count = level.counts[axis] as isize;
        let low = ((offset - reach) / level.cell[axis]).floor() as isize;
        let high = ((offset + reach) / level.cell[axis]).floor() as isize;
        if self.periodic[axis] {
            if high - low + 1 >= count { (0, count) } else { (low, high - low + 1) }
        } else {
            let (low, high) = (low.clamp(0, count - 1), high.clamp(0, count - 1));
            (low, high - low + 1)
        }
    }

    #[expect(clippy::cast_possible_wrap, reason = "cells per axis are at most MOST_CELLS")]
    fn visit_level(
        &self,
        level: &Level,
        ranges: &[(isize, isize); 3],
        visit: &mut impl FnMut(usize) -> bool,
    ) -> bool {
        let wrapped =
            |axis: usize, k: isize| (ranges[axis].0 + k).rem_euclid(level.counts[axis] as isize) as usize;
        for a in 0..ranges[0].1 {
            for b in 0..ranges[1].1 {
                for c in 0..ranges[2].1 {
                    let row = wrapped(0, a) * level.counts[1] + wrapped(1, b);
                    let mut index = level.heads[row * level.counts[2] + wrapped(2, c)];
                    while index != NONE {
                        if !visit(index as usize) {
                            return false;
                        }
                        index = self.next[index as usize];
                    }
                }
            }
        }
        true
    }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the grid")]
fn coordinate(cell: f64, count: usize) -> usize {
    (cell.max(0.0) as usize).min(count - 1)
}
