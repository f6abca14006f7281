//! Charges and those of their images that lie near a box, sorted into linked cells.

use crate::geometry::images::{BoundingBox, Image, ImageLattice};
use nalgebra::Vector3;
use std::ops::Range;

/// Cells per cut-off radius: rows of cells then follow the ball closely enough, and stay long enough.
const CELLS_PER_RADIUS: f64 = 2.0;
/// Cells at most, per image; more would be empty.
const CELLS_PER_IMAGE: usize = 2;

/// `real` of an entry that is an image.
pub(crate) const IMAGE: u32 = u32::MAX;

#[derive(Clone, Copy, Debug)]
struct Entry<T> {
    position: Vector3<f64>,
    charge: f64,
    real: u32,
    extra: T,
    cell: u32,
}

/// Images within a radius of the particles' bounding box, sorted by cell, as a structure of arrays.
///
/// Memory is kept between builds. `extra` is what a method wants to know about each image.
#[derive(Clone, Debug, Default)]
pub(crate) struct ImageCells<T> {
    /// Coordinates [m].
    pub(crate) x: Vec<f64>,
    /// Coordinates [m].
    pub(crate) y: Vec<f64>,
    /// Coordinates [m].
    pub(crate) z: Vec<f64>,
    /// Signed charges [C].
    pub(crate) charge: Vec<f64>,
    /// Index of the particle when the entry is the particle itself, else [`IMAGE`].
    pub(crate) real: Vec<u32>,
    /// Values that the method attached to each image.
    pub(crate) extra: Vec<T>,
    staging: Vec<Entry<T>>,
    start: Vec<u32>,
    low: Vector3<f64>,
    width: Vector3<f64>,
    cells_per_length: Vector3<f64>,
    counts: [usize; 3],
    radius: f64,
}

impl<T: Copy + Default> ImageCells<T> {
    /// Collects and sorts the charges, zeros left out, and the images within `radius` [m] of the positions'
    /// bounding box.
    pub(crate) fn build(
        &mut self,
        lattice: &ImageLattice,
        positions: &[Vector3<f64>],
        charges: &[f64],
        radius: f64,
        extra: impl Fn(usize, &Image) -> T,
    ) {
        self.radius = radius;
        self.staging.clear();
        if let Some(target) = BoundingBox::around(positions) {
            let all = positions.iter().zip(charges).enumerate();
            for (index, (position, &charge)) in all.filter(|(_, (_, charge))| **charge != 0.0) {
                lattice.for_each_near(position, &target, radius, |image| {
                    #[expect(clippy::cast_possible_truncation, reason = "fewer than 2³² particles")]
                    let real = if image.is_real { index as u32 } else { IMAGE };
                    self.staging.push(Entry {
                        position: image.position,
                        charge: charge * image.sign,
                        real,
                        extra: extra(index, &image),
                        cell: 0,
                    });
                });
            }
            self.shape_cells(&target);
        }
        self.sort();
    }

    fn shape_cells(&mut self, target: &BoundingBox) {
        self.low = target.min.add_scalar(-self.radius);
        let size = target.extent().add_scalar(2.0 * self.radius);
        let most = CELLS_PER_IMAGE * self.staging.len() + 1;
        let mut divisor = self.radius / CELLS_PER_RADIUS;
        loop {
            #[expect(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "small positive counts"
            )]
            let counts =
                [0, 1, 2].map(|axis| (size[axis] / divisor).min(1e6) as usize).map(|count| count.max(1));
            if counts.iter().product::<usize>() <= most {
                self.counts = counts;
                break;
            }
            divisor *= 1.2;
        }
        self.width = Vector3::from_fn(|axis, _| size[axis] / self.counts[axis] as f64);
        self.cells_per_length = self.width.map(f64::recip);
    }

    /// Stable counting sort: the order depends on the particles' order alone.
    fn sort(&mut self) {
        let len = self.staging.len();
        if len == 0 {
            self.counts = [0; 3];
        }
        let cells: usize = self.counts.iter().product();
        self.start.clear();
        self.start.resize(cells + 1, 0);
        for index in 0..len {
            let cell = self.cell_of(&self.staging[index].position);
            self.staging[index].cell = cell;
            self.start[cell as usize + 1] += 1;
        }
        for cell in 0..cells {
            self.start[cell + 1] += self.start[cell];
        }
        for array in [&mut self.x, &mut self.y, &mut self.z, &mut self.charge] {
            array.resize(len, 0.0);
        }
        self.real.resize(len, IMAGE);
        self.extra.resize(len, T::default());
        for entry in &self.staging {
            let slot = &mut self.start[entry.cell as usize];
            let place = *slot as usize;
            *slot += 1;
            self.x[place] = entry.position.x;
            self.y[place] = entry.position.y;
            self.z[place] = entry.position.z;
            self.charge[place] = entry.charge;
            self.real[place] = entry.real;
            self.extra[place] = entry.extra;
        }
        // Every start has moved to its cell's end, the next one's start.
        self.start.rotate_right(1);
        self.start[0] = 0;
    }

    #[inline(always)]
    fn index(&self, axis: usize, at: f64) -> usize {
        let last = self.counts[axis] - 1;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the cells")]
        let index = (((at - self.low[axis]) * self.cells_per_length[axis]).max(0.0) as usize).min(last);
        index
    }

    #[expect(clippy::cast_possible_truncation, reason = "at most two cells an image, fewer than 2³² images")]
    fn cell_of(&self, at: &Vector3<f64>) -> u32 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.index(axis, at[axis]));
        ((z * self.counts[1] + y) * self.counts[0] + x) as u32
    }

    /// Distance along an axis from a coordinate to a cell.
    fn gap(&self, axis: usize, cell: usize, at: f64) -> f64 {
        let low = self.low[axis] + cell as f64 * self.width[axis];
        (low - at).max(at - low - self.width[axis]).max(0.0)
    }

    /// Calls `visit` with ranges of entries that together hold every entry within the radius of `at`, and
    /// some beyond it.
    #[inline]
    pub(crate) fn for_each_range(&self, at: &Vector3<f64>, mut visit: impl FnMut(Range<usize>)) {
        if self.real.is_empty() {
            return;
        }
        // Cells are found by rounding: a sliver more than the radius makes sure of those on the edge.
        let radius = self.radius * (1.0 + 1e-9);
        for z in self.index(2, at.z - radius)..=self.index(2, at.z + radius) {
            let rest_z = radius * radius - self.gap(2, z, at.z).powi(2);
            for y in self.index(1, at.y - radius)..=self.index(1, at.y + radius) {
                let rest = rest_z - self.gap(1, y, at.y).powi(2);
                if rest < 0.0 {
                    continue;
                }
                let reach = rest.sqrt();
                let row = (z * self.counts[1] + y) * self.counts[0];
                let first = self.start[row + self.index(0, at.x - reach)] as usize;
                let last = self.start[row + self.index(0, at.x + reach) + 1] as usize;
                if first < last {
                    visit(first..last);
                }
            }
        }
    }

    /// Calls `visit(k, d, |d|²)` for every entry k within the radius of the particle `index` at `at`, itself
    /// excepted; d points from the entry to the particle [m].
    #[inline]
    pub(crate) fn for_each_partner(
        &self,
        index: usize,
        at: &Vector3<f64>,
        mut visit: impl FnMut(usize, Vector3<f64>, f64),
    ) {
        let limit = self.radius * self.radius;
        self.for_each_range(at, |range| {
            for k in range {
                let d = Vector3::new(at.x - self.x[k], at.y - self.y[k], at.z - self.z[k]);
                let square = d.norm_squared();
                if square < limit && self.real[k] as usize != index {
                    visit(k, d, square);
                }
            }
        });
    }

    /// Number of images.
    pub(crate) fn len(&self) -> usize {
        self.real.len()
    }

    /// Memory held [bytes].
    pub(crate) fn memory_bytes(&self) -> usize {
        self.staging.capacity() * size_of::<Entry<T>>()
            + self.x.capacity() * (4 * size_of::<f64>() + size_of::<u32>() + size_of::<T>())
            + self.start.capacity() * size_of::<u32>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{Boundary, Domain};

    #[test]
    fn every_image_within_the_radius_is_visited_once() {
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
        for radius in [0.11, 0.5, 2.6] {
            let mut cells = ImageCells::<()>::default();
            cells.build(&lattice, &positions, &charges, radius, |_, _| ());
            let target = BoundingBox::around(&positions).unwrap();
            for at in &positions {
                let mut expected = 0;
                for source in &positions {
                    lattice.for_each_near(source, &target, radius, |image| {
                        expected += usize::from((image.position - at).norm() < radius);
                    });
                }
                let mut found = 0;
                cells.for_each_range(at, |range| {
                    for k in range {
                        let place = Vector3::new(cells.x[k], cells.y[k], cells.z[k]);
                        found += usize::from((place - at).norm() < radius);
                    }
                });
                assert_eq!(found, expected, "radius {radius}");
            }
        }
    }
}
