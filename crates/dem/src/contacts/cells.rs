//! Linked cells on several levels, so that 100:1 sizes in one scene stay O(N).
//!
//! Grains are sorted into levels by radius, each level twice as coarse as the one before; every level has a
//! grid of its own whose cells hold its largest pair. A grain looks into its own level and into the coarser
//! ones only: 27 cells each. Periodic images are stored like grains, with the code of their shift.

use amberfield_core::{Axis, Domain, Vector3};

/// Bits of a partner entry that hold the index; the rest is the shift code.
pub(crate) const INDEX_BITS: u32 = 27;
/// Mask of the index.
pub(crate) const INDEX_MASK: u32 = (1 << INDEX_BITS) - 1;
/// Code of "no shift".
pub(crate) const NO_SHIFT: u32 = 13;
/// Most cells per stored item; beyond it cells are enlarged.
const CELLS_PER_ITEM: usize = 8;
/// A cell number beyond every grid.
const FAR_CELL: f64 = 1e15;
/// Radius ratio of neighbouring levels.
const LEVEL_RATIO: f64 = 2.0;

/// Shift vectors [m] of the codes 0..27: code = 9 sx + 3 sy + sz + 13, s in −1..=1.
pub(crate) fn shifts(domain: &Domain) -> [[f64; 3]; 32] {
    let extent = domain.extent();
    std::array::from_fn(|code| {
        let digits = [code / 9, code / 3 % 3, code % 3];
        std::array::from_fn(|axis| {
            let periodic = domain.is_periodic(Axis::ALL[axis]) && code < 27;
            if periodic { (digits[axis] as f64 - 1.0) * extent[axis] } else { 0.0 }
        })
    })
}

/// Level of every radius: 0 holds the smallest grains; also the largest radius of each level.
pub(crate) fn levels_of(radii: impl Iterator<Item = f64> + Clone) -> (Vec<u8>, Vec<f64>) {
    let largest = radii.clone().fold(0.0, f64::max);
    // Class 0 holds the largest grains here; empty classes are squeezed out below.
    let class = |r: f64| {
        let mut class = 0_usize;
        let mut bound = largest / LEVEL_RATIO;
        while r < bound && class < 60 {
            class += 1;
            bound /= LEVEL_RATIO;
        }
        class
    };
    let mut largest_of = [0.0_f64; 61];
    for r in radii.clone() {
        let class = class(r);
        largest_of[class] = largest_of[class].max(r);
    }
    let mut level_of_class = [0_u8; 61];
    let mut level_radius = Vec::new();
    for class in (0..61).rev() {
        level_of_class[class] = level_radius.len() as u8;
        if largest_of[class] > 0.0 {
            level_radius.push(largest_of[class]);
        }
    }
    (radii.map(|r| level_of_class[class(r)]).collect(), level_radius)
}

/// Linked cells of one level.
#[derive(Debug, Default)]
struct CellLevel {
    origin: Vector3<f64>,
    inverse_size: f64,
    cells: [i64; 3],
    start: Vec<u32>,
    /// Centre and radius of each item, by cell.
    centre: Vec<[f64; 4]>,
    /// Index and shift code of each item, by cell.
    entry: Vec<u32>,
    // Scratch before sorting by cell.
    loose: Vec<([f64; 4], u32)>,
    cell_of: Vec<u32>,
}

/// Linked cells of all levels.
#[derive(Debug)]
pub(crate) struct LinkedCells {
    levels: Vec<CellLevel>,
    level_radius: Vec<f64>,
    skin: f64,
}

impl LinkedCells {
    pub(crate) fn new(level_radius: Vec<f64>, skin: f64) -> Self {
        let levels = level_radius.iter().map(|_| CellLevel::default()).collect();
        Self { levels, level_radius, skin }
    }

    /// Number of levels.
    pub(crate) fn level_count(&self) -> usize {
        self.levels.len()
    }

    /// Sorts all grains and their periodic images into cells.
    pub(crate) fn fill(
        &mut self,
        domain: &Domain,
        shifts: &[[f64; 3]; 32],
        centre: &[[f64; 4]],
        level_of: impl Fn(usize) -> u8,
    ) {
        for level in &mut self.levels {
            level.loose.clear();
        }
        for (index, &centre) in centre.iter().enumerate() {
            let level = level_of(index) as usize;
            let reach = 2.0 * self.level_radius[level] + self.skin;
            push_with_images(&mut self.levels[level].loose, domain, shifts, centre, index as u32, reach);
        }
        for (level, radius) in self.levels.iter_mut().zip(&self.level_radius) {
            level.sort(2.0 * radius + self.skin);
        }
    }

    /// Appends every partner whose gap is below the skin and which this grain's list holds: larger indices of
    /// its own level and everything of coarser levels.
    #[inline]
    pub(crate) fn partners(&self, index: u32, level: u8, centre: &[f64; 4], found: &mut Vec<u32>) {
        for (depth, cells) in self.levels.iter().enumerate().skip(level as usize) {
            let coarser = depth != level as usize;
            cells.visit(centre, |others, entries| {
                // Every item is written, and overwritten by the next unless it counts: no branch to guess
                // wrong.
                let mut end = found.len();
                found.resize(end + entries.len(), 0);
                for (other, &entry) in others.iter().zip(entries) {
                    let (dx, dy, dz) = (other[0] - centre[0], other[1] - centre[1], other[2] - centre[2]);
                    let reach = other[3] + centre[3] + self.skin;
                    let near = dx * dx + dy * dy + dz * dz < reach * reach;
                    let code = entry >> INDEX_BITS;
                    let larger = (code == NO_SHIFT) & (entry & INDEX_MASK > index);
                    found[end] = entry;
                    end += usize::from(near & (coarser | larger | (code > NO_SHIFT)));
                }
                found.truncate(end);
            });
        }
    }
}

impl LinkedCells {
    /// Distance of surfaces within which lists hold a pair [m].
    pub(crate) fn skin(&self) -> f64 {
        self.skin
    }

    /// Radius of the largest grain [m].
    pub(crate) fn largest(&self) -> f64 {
        self.level_radius.last().copied().unwrap_or(0.0)
    }

    /// Appends every grain, without its images, whose surface is nearer than a gap [m] to that of a grain of
    /// any size.
    pub(crate) fn near(&self, centre: &[f64; 4], gap: f64, found: &mut Vec<u32>) {
        for (cells, largest) in self.levels.iter().zip(&self.level_radius) {
            cells.visit_within(centre, centre[3] + largest + gap, |others, entries| {
                let near = others.iter().zip(entries).filter(|(other, entry)| {
                    let d2: f64 = (0..3).map(|k| (other[k] - centre[k]).powi(2)).sum();
                    *entry >> INDEX_BITS == NO_SHIFT && d2 < (other[3] + centre[3] + gap).powi(2)
                });
                found.extend(near.map(|(_, entry)| entry & INDEX_MASK));
            });
        }
    }
}

/// The centre and its periodic images that can reach into the domain, by as much along each axis, with their
/// shift codes.
pub(crate) fn images<'a>(
    domain: &'a Domain,
    shifts: &'a [[f64; 3]; 32],
    centre: Vector3<f64>,
    reach: Vector3<f64>,
) -> impl Iterator<Item = (u32, Vector3<f64>)> + 'a {
    let (min, max) = (domain.min(), domain.max());
    (0..27_u32).filter_map(move |code| {
        let digits = [code / 9, code / 3 % 3, code % 3];
        let wanted = code == NO_SHIFT
            || (0..3).all(|axis| match (digits[axis], domain.is_periodic(Axis::ALL[axis])) {
                (1, _) => true,
                (0, true) => max[axis] - centre[axis] <= reach[axis],
                (2, true) => centre[axis] - min[axis] <= reach[axis],
                _ => false,
            });
        wanted.then(|| (code, centre + Vector3::from(shifts[code as usize])))
    })
}

/// Stores a grain and its images that lie within `reach` of the domain.
fn push_with_images(
    items: &mut Vec<([f64; 4], u32)>,
    domain: &Domain,
    shifts: &[[f64; 3]; 32],
    centre: [f64; 4],
    index: u32,
    reach: f64,
) {
    items.push((centre, index | NO_SHIFT << INDEX_BITS));
    let (min, max) = (domain.min(), domain.max());
    let mut options = [(1_u32, 1_u32); 3];
    let mut alone = true;
    for (axis, option) in options.iter_mut().enumerate() {
        if domain.is_periodic(Axis::ALL[axis]) {
            // A grain near the lower face has an image beyond the upper one, and the other way round.
            let low = centre[axis] - min[axis] <= reach;
            let high = max[axis] - centre[axis] <= reach;
            *option = (u32::from(!high), 1 + u32::from(low));
            alone &= !low && !high;
        }
    }
    if alone {
        return;
    }
    for sx in options[0].0..=options[0].1 {
        for sy in options[1].0..=options[1].1 {
            for sz in options[2].0..=options[2].1 {
                let code = 9 * sx + 3 * sy + sz;
                if code != NO_SHIFT {
                    let shift = shifts[code as usize];
                    let image = [centre[0] + shift[0], centre[1] + shift[1], centre[2] + shift[2], centre[3]];
                    items.push((image, index | code << INDEX_BITS));
                }
            }
        }
    }
}

impl CellLevel {
    fn sort(&mut self, smallest_cell: f64) {
        let mut min = Vector3::repeat(f64::INFINITY);
        let mut max = Vector3::repeat(f64::NEG_INFINITY);
        for (c, _) in &self.loose {
            let c = Vector3::new(c[0], c[1], c[2]);
            min = min.inf(&c);
            max = max.sup(&c);
        }
        self.cells = [0; 3];
        if self.loose.is_empty() {
            return;
        }
        let mut size = smallest_cell;
        let limit = (CELLS_PER_ITEM * self.loose.len() + 64) as f64;
        loop {
            let counts = ((max - min) / size).map(|c| c.floor() + 1.0);
            if counts.product() <= limit {
                self.cells = [counts.x as i64, counts.y as i64, counts.z as i64];
                break;
            }
            size *= 1.25;
        }
        self.origin = min;
        self.inverse_size = 1.0 / size;
        let total = self.cells.iter().product::<i64>() as usize;
        self.start.clear();
        self.start.resize(total + 1, 0);
        self.cell_of.clear();
        for (centre, _) in &self.loose {
            let [x, y, z] = self.cell(centre);
            let cell = self.row(y, z) + x.clamp(0, self.cells[0] - 1) as usize;
            self.cell_of.push(cell as u32);
            self.start[cell + 1] += 1;
        }
        for k in 0..total {
            self.start[k + 1] += self.start[k];
        }
        self.centre.resize(self.loose.len(), [0.0; 4]);
        self.entry.resize(self.loose.len(), 0);
        // Filled from the back so that each cell keeps the order of its items.
        for ((centre, entry), &cell) in self.loose.iter().zip(&self.cell_of).rev() {
            let slot = &mut self.start[cell as usize + 1];
            *slot -= 1;
            self.centre[*slot as usize] = *centre;
            self.entry[*slot as usize] = *entry;
        }
        // `start[k + 1]` now is the first item of cell k; move it back to `start[k]`.
        self.start.copy_within(1.., 0);
        self.start[total] = self.loose.len() as u32;
    }

    /// Cell of a point; one far outside the grid stays in a range where neighbours can be counted.
    fn cell(&self, centre: &[f64; 4]) -> [i64; 3] {
        std::array::from_fn(|a| {
            ((centre[a] - self.origin[a]) * self.inverse_size).floor().clamp(-FAR_CELL, FAR_CELL) as i64
        })
    }

    fn row(&self, y: i64, z: i64) -> usize {
        let (y, z) = (y.clamp(0, self.cells[1] - 1), z.clamp(0, self.cells[2] - 1));
        ((z * self.cells[1] + y) * self.cells[0]) as usize
    }

    /// Visits the items of all cells within a distance of a point along each axis, a row of cells at a time.
    fn visit_within(&self, centre: &[f64; 4], reach: f64, mut row_of_items: impl FnMut(&[[f64; 4]], &[u32])) {
        let corner = |sign: f64| self.cell(&centre.map(|x| x + sign * reach));
        let (low, high) = (corner(-1.0), corner(1.0));
        let range = |axis: usize| low[axis].max(0)..=high[axis].min(self.cells[axis] - 1);
        if range(0).is_empty() {
            return;
        }
        for z in range(2) {
            for y in range(1) {
                let row = self.row(y, z);
                let first = self.start[row + *range(0).start() as usize] as usize;
                let last = self.start[row + *range(0).end() as usize + 1] as usize;
                row_of_items(&self.centre[first..last], &self.entry[first..last]);
            }
        }
    }

    /// Visits the items of the 27 cells around a point, a row of cells at a time.
    #[inline]
    fn visit(&self, centre: &[f64; 4], mut row_of_items: impl FnMut(&[[f64; 4]], &[u32])) {
        let [x, y, z] = self.cell(centre);
        let [nx, ny, nz] = self.cells;
        let (x0, x1) = ((x - 1).max(0), (x + 1).min(nx - 1));
        if x0 > x1 {
            return;
        }
        for z in (z - 1).max(0)..=(z + 1).min(nz - 1) {
            for y in (y - 1).max(0)..=(y + 1).min(ny - 1) {
                let row = ((z * ny + y) * nx) as usize;
                let first = self.start[row + x0 as usize] as usize;
                let last = self.start[row + x1 as usize + 1] as usize;
                row_of_items(&self.centre[first..last], &self.entry[first..last]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;

    fn all_pairs(domain: &Domain, centre: &[[f64; 4]], skin: f64) -> Vec<(u32, u32)> {
        let shifts = shifts(domain);
        let mut pairs = Vec::new();
        for i in 0..centre.len() {
            for j in i + 1..centre.len() {
                for shift in &shifts[..27] {
                    let d2: f64 = (0..3).map(|a| (centre[j][a] + shift[a] - centre[i][a]).powi(2)).sum();
                    let near = d2 < (centre[i][3] + centre[j][3] + skin).powi(2);
                    if near && !pairs.contains(&(i as u32, j as u32)) {
                        pairs.push((i as u32, j as u32));
                    }
                }
            }
        }
        pairs.sort_unstable();
        pairs
    }

    /// Deterministic scattered numbers in [0, 1).
    fn scatter(k: usize) -> f64 {
        (k as f64 * 0.618_033_988_749_895).fract()
    }

    #[test]
    fn finds_every_pair_once_with_images_and_sizes() {
        for faces in [[[Boundary::Open; 2]; 3], [[Boundary::Periodic; 2]; 3]] {
            let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), faces).unwrap();
            let centre: Vec<[f64; 4]> = (0..300)
                .map(|k| {
                    let radius = if k % 50 == 0 { 0.2 } else { 0.004 + 0.02 * scatter(7 * k) };
                    [scatter(k * k + 1), scatter(3 * k * k + 2), scatter(5 * k * k * k + 3), radius]
                })
                .collect();
            let skin = 0.01;
            let (level, radii) = levels_of(centre.iter().map(|c| c[3]));
            let mut cells = LinkedCells::new(radii, skin);
            assert!(cells.level_count() > 2);
            cells.fill(&domain, &shifts(&domain), &centre, |k| level[k]);
            let mut pairs = Vec::new();
            for (i, c) in centre.iter().enumerate() {
                let mut found = Vec::new();
                cells.partners(i as u32, level[i], c, &mut found);
                pairs.extend(
                    found.iter().map(|entry| entry & INDEX_MASK).map(|j| (j.min(i as u32), j.max(i as u32))),
                );
            }
            pairs.sort_unstable();
            assert_eq!(pairs, all_pairs(&domain, &centre, skin));
        }
    }
}
