//! Charges and those of their images that lie near, sorted into long cells, in units of the cut-off radius.

use super::candidates::Sources;
use crate::geometry::images::{BoundingBox, ImageLattice, without_images};
use crate::numerics::processor::PADDING;
use amberfield_core::Domain;
use nalgebra::Vector3;
use std::ops::Range;

/// Edge of a cell along x, where runs of cells begin and end, in mean distances of the sources.
const ALONG: f64 = 0.5;
/// Longest and shortest edge along x over the cut-off radius.
const LONGEST: f64 = 0.7;
const SHORTEST: f64 = 0.1;
/// Edges across are the cut-off radius over a whole number, so that no row is reached in vain; the number
/// is this share of the root of the number of sources in a cube of that radius: some ten sources in a run
/// pay for finding it.
const ROWS_PER_ROOT: f64 = 0.6;
/// Most rows within a cut-off radius: looking at more of them would take longer than summing.
const MOST_ROWS: f64 = 5.0;
/// Cells at most, per source; more would be empty.
const CELLS_PER_SOURCE: usize = 4;
/// Sources on the edge of the cut-off are found by rounding: a sliver more makes sure of them.
const SLIVER: f64 = 1e-9;
/// `real` of a source that is an image.
pub(super) const IMAGE: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct Entry {
    place: [f64; 3],
    charge: f64,
    real: u32,
    cell: u32,
}

/// A row of cells around another, and how far along x the cut-off reaches into it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    across: [isize; 2],
    reach: f64,
}

/// Charges whose sum is wanted at the first ones.
#[derive(Clone, Copy, Debug)]
pub(super) struct Charges<'a> {
    /// Places [m], inside the domain or within a period of it.
    pub(super) positions: &'a [Vector3<f64>],
    /// Charges [C].
    pub(super) charges: &'a [f64],
    /// Number of those at which the sum is wanted.
    pub(super) targets: usize,
}

/// Sources sorted by cell. Memory is kept between builds.
#[derive(Debug, Default)]
pub(super) struct NearCells {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    charge: Vec<f64>,
    /// Index of the particle when the source is the particle itself, else [`IMAGE`].
    pub(super) real: Vec<u32>,
    entries: Vec<Entry>,
    start: Vec<u32>,
    counts: [usize; 3],
    per_length: [f64; 3],
    rows: Vec<Row>,
}

impl NearCells {
    /// Sorts the charges and their images within the cut-off radius [m] of the targets' bounding box.
    pub(super) fn build(
        &mut self,
        domain: &Domain,
        lattice: &ImageLattice,
        Charges { positions, charges, targets }: Charges<'_>,
        radius: f64,
        per_charge: f64,
    ) {
        self.entries.clear();
        self.counts = [0; 3];
        if let Some(target) = BoundingBox::around(&positions[..targets]) {
            let low = target.min.add_scalar(-radius);
            self.collect(domain, lattice, positions, charges, &target, radius);
            for entry in &mut self.entries {
                entry.place = [0, 1, 2].map(|axis| (entry.place[axis] - low[axis]) / radius);
                entry.charge *= per_charge;
            }
            self.shape(&(target.extent() / radius).add_scalar(2.0));
        }
        self.sort();
    }

    /// Lists the charges and the images.
    fn collect(
        &mut self,
        domain: &Domain,
        lattice: &ImageLattice,
        positions: &[Vector3<f64>],
        charges: &[f64],
        target: &BoundingBox,
        radius: f64,
    ) {
        let deep = without_images(domain, target, radius);
        for (index, (position, &charge)) in positions.iter().zip(charges).enumerate() {
            #[expect(clippy::cast_possible_truncation, reason = "fewer than 2³² particles")]
            let real = index as u32;
            if deep.contains(position) {
                self.entries.push(Entry { place: (*position).into(), charge, real, cell: 0 });
                continue;
            }
            lattice.for_each_near(position, target, radius, |image| {
                self.entries.push(Entry {
                    place: image.position.into(),
                    charge: charge * image.sign,
                    real: if image.is_real { real } else { IMAGE },
                    cell: 0,
                });
            });
        }
    }

    /// Chooses the cells of a box of the given size, and the rows around a row.
    fn shape(&mut self, size: &Vector3<f64>) {
        let distance = (size.product() / self.entries.len() as f64).cbrt();
        let most = CELLS_PER_SOURCE * self.entries.len() + 64;
        let across = (ROWS_PER_ROOT * distance.powf(-1.5)).floor().clamp(1.0, MOST_ROWS).recip();
        let mut edges = [(ALONG * distance).clamp(SHORTEST, LONGEST), across, across];
        loop {
            #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small and positive")]
            let counts = [0, 1, 2].map(|axis| ((size[axis] / edges[axis]).min(1e6) as usize).max(1));
            if counts.iter().product::<usize>() <= most {
                self.counts = counts;
                break;
            }
            edges = edges.map(|edge| 1.2 * edge);
        }
        self.per_length = [0, 1, 2].map(|axis| self.counts[axis] as f64 / size[axis]);
        self.rows.clear();
        let [_, y, z] = self.per_length.map(|per_length| per_length.ceil() as isize);
        let gap = |axis: usize, cells: isize| (cells.abs() - 1).max(0) as f64 / self.per_length[axis];
        for across_z in -z..=z {
            for across_y in -y..=y {
                let rest = 1.0 + SLIVER - gap(1, across_y).powi(2) - gap(2, across_z).powi(2);
                if rest >= 0.0 {
                    self.rows.push(Row { across: [across_y, across_z], reach: rest.sqrt() + SLIVER });
                }
            }
        }
    }

    /// Stable counting sort: the order depends on the particles' order alone.
    fn sort(&mut self) {
        let len = self.entries.len();
        let cells: usize = self.counts.iter().product();
        self.start.clear();
        self.start.resize(cells + 1, 0);
        for index in 0..len {
            let place = self.entries[index].place;
            let cell = self.row_start(self.row_at(place)) + self.cell(0, place[0]);
            #[expect(
                clippy::cast_possible_truncation,
                reason = "a few cells a source, fewer than 2³² sources"
            )]
            (self.entries[index].cell = cell as u32);
            self.start[cell + 1] += 1;
        }
        for cell in 0..cells {
            self.start[cell + 1] += self.start[cell];
        }
        for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.charge] {
            array.resize(len + PADDING, 0.0);
        }
        self.real.resize(len, IMAGE);
        for entry in &self.entries {
            let slot = &mut self.start[entry.cell as usize];
            let at = *slot as usize;
            *slot += 1;
            [self.x[at], self.y[at], self.z[at]] = entry.place;
            self.charge[at] = entry.charge;
            self.real[at] = entry.real;
        }
        // Every start has moved to its cell's end, the next one's start.
        self.start.rotate_right(1);
        self.start[0] = 0;
    }

    #[inline(always)]
    fn cell(&self, axis: usize, at: f64) -> usize {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the cells")]
        let cell = (at * self.per_length[axis]).max(0.0) as usize;
        cell.min(self.counts[axis] - 1)
    }

    #[inline(always)]
    fn row_at(&self, place: [f64; 3]) -> [usize; 2] {
        [self.cell(1, place[1]), self.cell(2, place[2])]
    }

    /// The row of cells along x that a source lies in: numbers of its cells along y and z.
    #[inline(always)]
    pub(super) fn row_of(&self, source: usize) -> [usize; 2] {
        self.row_at(self.place(source))
    }

    fn row_start(&self, [y, z]: [usize; 2]) -> usize {
        (z * self.counts[1] + y) * self.counts[0]
    }

    /// Place of a source in units of the cut-off radius.
    #[inline(always)]
    pub(super) fn place(&self, source: usize) -> [f64; 3] {
        [self.x[source], self.y[source], self.z[source]]
    }

    /// Charge of a source over the largest.
    #[inline(always)]
    pub(super) fn charge(&self, source: usize) -> f64 {
        self.charge[source]
    }

    pub(super) fn sources(&self) -> Sources<'_> {
        Sources { x: &self.x, y: &self.y, z: &self.z, charge: &self.charge }
    }

    /// Rows of cells around any row that the cut-off reaches.
    pub(super) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// A range of sources of a row around row (y, z) that holds every source within the cut-off of any
    /// place there with x in `from..=to`, and some beyond it. Empty beyond the cells. The ranges of all
    /// [`Self::rows`] hold them all; one of them holds what lies between in the row itself.
    #[inline(always)]
    pub(super) fn run(&self, row: &Row, [y, z]: [usize; 2], [from, to]: [f64; 2]) -> Range<usize> {
        let (y, z) = (y.wrapping_add_signed(row.across[0]), z.wrapping_add_signed(row.across[1]));
        if y >= self.counts[1] || z >= self.counts[2] {
            return 0..0;
        }
        let start = self.row_start([y, z]);
        let first = self.start[start + self.cell(0, from - row.reach)] as usize;
        let last = self.start[start + self.cell(0, to + row.reach) + 1] as usize;
        first..last
    }

    /// Memory held [bytes].
    pub(super) fn memory_bytes(&self) -> usize {
        self.entries.capacity() * size_of::<Entry>()
            + self.x.capacity() * (4 * size_of::<f64>() + size_of::<u32>())
            + self.start.capacity() * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;

    #[test]
    fn every_source_within_the_cutoff_is_in_one_run() {
        let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Open; 2]];
        let domain = Domain::new(Vector3::zeros(), Vector3::new(1.0, 1.3, 0.8), faces).unwrap();
        let lattice = ImageLattice::new(&domain);
        let positions: Vec<_> = (0..60)
            .map(|i| {
                let at = |step: f64, length: f64| (f64::from(i) * step).fract() * length;
                Vector3::new(at(0.618, 1.0), at(0.414, 1.3), at(0.303, 0.8))
            })
            .collect();
        let charges = vec![1.0; 60];
        // No image lies exactly at the cut-off: rounding would decide.
        for radius in [0.11, 0.5, 2.57] {
            let mut cells = NearCells::default();
            cells.build(
                &domain,
                &lattice,
                Charges { positions: &positions, charges: &charges, targets: 60 },
                radius,
                1.0,
            );
            let target = BoundingBox::around(&positions).unwrap();
            let near = |a: [f64; 3], b: [f64; 3]| (Vector3::from(a) - Vector3::from(b)).norm() < 1.0;
            for source in (0..cells.real.len()).filter(|&source| cells.real[source] != IMAGE) {
                let at = positions[cells.real[source] as usize];
                let mut expected = 0;
                for source in &positions {
                    lattice.for_each_near(source, &target, radius, |image| {
                        expected += usize::from((image.position - at).norm() < radius);
                    });
                }
                let place = cells.place(source);
                let run = |row| cells.run(row, cells.row_of(source), [place[0]; 2]);
                let found = cells
                    .rows()
                    .iter()
                    .flat_map(run)
                    .filter(|&other| near(cells.place(other), place))
                    .count();
                assert_eq!(found, expected, "radius {radius}");
            }
        }
    }
}
