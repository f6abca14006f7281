//! Linked cells in levels of size, for any mixture of sizes.

use super::region::Region;
use nalgebra::Vector3;

/// Largest number of levels; each halves the edge of the cells.
const MOST_LEVELS: usize = 12;
/// Largest number of cells of a level for each grain.
const CELLS_PER_GRAIN: f64 = 8.0;
/// Largest number of cells of a level in total.
const MOST_CELLS: f64 = 6.4e7;
/// End of the list of a cell.
const NONE: u32 = u32::MAX;

/// Cells for the grains of one class of size.
///
/// The diameter of a grain is at most the edge of a cell and, on all levels but the last, above half of it.
#[derive(Debug)]
struct SizeLevel {
    /// Edges of a cell [m].
    cell: Vector3<f64>,
    /// Number of cells per axis.
    counts: [usize; 3],
    /// First grain of each cell.
    heads: Vec<u32>,
    /// Flag of a level that holds a grain.
    used: bool,
}

/// Cells that a search visits along an axis.
#[derive(Clone, Copy)]
struct CellRange {
    /// First cell; may lie outside the grid on a periodic axis.
    first: isize,
    /// Number of cells.
    count: isize,
}

/// Grid of cells in which each grain lies on the level of its size.
#[derive(Debug)]
pub(super) struct SizeGrid {
    /// Levels, largest grains first.
    levels: Vec<SizeLevel>,
    /// Next grain in the cell of each grain.
    next: Vec<u32>,
    /// Largest radius [m].
    largest: f64,
    /// Lower corner [m].
    min: Vector3<f64>,
    /// Flag of a periodic axis.
    periodic: [bool; 3],
}

impl SizeGrid {
    /// Empty grid for radii between `smallest` and `largest` [m] and indices below `count`.
    pub(super) fn new(region: &Region, smallest: f64, largest: f64, count: usize) -> Self {
        let extent = region.max - region.min;
        let mut levels = Vec::new();
        // Points have no size from which to make cells.
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
            levels.push(SizeLevel { cell, counts, heads: vec![NONE; counts.iter().product()], used: false });
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

    /// Level of the grains of a radius [m].
    fn level_of(&self, radius: f64) -> usize {
        let mut level = 0;
        let mut half = 0.5 * self.largest;
        while level + 1 < self.levels.len() && radius <= half {
            level += 1;
            half *= 0.5;
        }
        level
    }

    /// Adds a grain at a position [m] with a radius [m].
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

    /// Calls `visit` for each grain that could touch a grain of the given position [m] and radius [m], until
    /// it returns `false`. Returns `true` when all were visited.
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
                let ranges: [CellRange; 3] =
                    std::array::from_fn(|axis| self.cells_within(level, axis, offset[axis], reach));
                if !self.visit_level(level, &ranges, &mut visit) {
                    return false;
                }
            }
            largest_here *= 0.5;
        }
        true
    }

    /// Cells of a level within `reach` [m] of an offset [m] from the lower corner, along an axis.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        reason = "cells per axis are at most MOST_CELLS"
    )]
    fn cells_within(&self, level: &SizeLevel, axis: usize, offset: f64, reach: f64) -> CellRange {
        let count = level.counts[axis] as isize;
        let low = ((offset - reach) / level.cell[axis]).floor() as isize;
        let high = ((offset + reach) / level.cell[axis]).floor() as isize;
        if self.periodic[axis] {
            // A range of a period or more would visit cells twice.
            if high - low + 1 >= count {
                CellRange { first: 0, count }
            } else {
                CellRange { first: low, count: high - low + 1 }
            }
        } else {
            let (low, high) = (low.clamp(0, count - 1), high.clamp(0, count - 1));
            CellRange { first: low, count: high - low + 1 }
        }
    }

    #[expect(clippy::cast_possible_wrap, reason = "cells per axis are at most MOST_CELLS")]
    fn visit_level(
        &self,
        level: &SizeLevel,
        ranges: &[CellRange; 3],
        visit: &mut impl FnMut(usize) -> bool,
    ) -> bool {
        let wrapped =
            |axis: usize, k: isize| (ranges[axis].first + k).rem_euclid(level.counts[axis] as isize) as usize;
        for a in 0..ranges[0].count {
            for b in 0..ranges[1].count {
                for c in 0..ranges[2].count {
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

/// Index of the cell at a coordinate in units of cells, clamped to the grid.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the grid")]
fn coordinate(cell: f64, count: usize) -> usize {
    (cell.max(0.0) as usize).min(count - 1)
}
