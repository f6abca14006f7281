//! Shares of a grain in the cells near it.
//!
//! w_c = V_c φ(|x_c − x|/R) / Σ V_c φ with φ(s) = (1 − s²)³ for s < 1
//!
//! Shares add up to one, whatever the cells' shape and however near a wall is. They change without a jump
//! when a grain crosses a face, whether cells are larger than grains or smaller. The same shares take the
//! grain to the cells and the flow to the grain, so that the one gets what the other gives. A grain that is
//! near no centre belongs to its cell alone.

use crate::GasError;
use amberfield_core::Vector3;
use amberfield_field::far::{FarMesh, Neighbour};
use rayon::prelude::*;

/// Least radius R over the widest cell. Every point of a cube has a centre within 0.87 of its edge, and
/// several within this radius.
const OVER_CELL: f64 = 1.25;
/// Least radius R over the largest diameter. Grains in cells smaller than themselves are spread over some
/// 27 times their volume.
const OVER_DIAMETER: f64 = 1.5;
/// Grains that one thread takes at a time.
pub(crate) const CHUNK: usize = 1024;
/// Largest distance of a corner from its cell's centre, over that of the farthest face.
const CORNER: f64 = 2.0;

/// A cell that may have a share: its index, and the number of the shift with which its centre is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct NearCell {
    cell: u32,
    shift: u32,
}

/// Shares of grains in the cells of a mesh.
#[derive(Clone, Debug)]
pub struct Mapping {
    radius: f64,
    centres: Vec<Vector3<f64>>,
    volumes: Vec<f64>,
    /// Number of the first of each cell's near cells, which are those of any point in it.
    first: Vec<usize>,
    near_cells: Vec<NearCell>,
    shifts: Vec<Vector3<f64>>,
}

/// A grain's share in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Share {
    /// Index of the cell.
    pub cell: u32,
    /// Weight of the share; those of a grain add up to one.
    pub weight: f64,
}

/// Shares of many grains, grain by grain.
#[derive(Clone, Debug, Default)]
pub(crate) struct Shares {
    /// Number of the first share of each grain; one entry more than there are grains.
    first: Vec<usize>,
    all: Vec<Share>,
}

impl Shares {
    /// Shares of one grain.
    pub(crate) fn of(&self, grain: usize) -> &[Share] {
        &self.all[self.first[grain]..self.first[grain + 1]]
    }
}

impl Mapping {
    /// Mapping with the radius `radius` [m], or with one that suits the cells and grains up to a diameter
    /// [m].
    ///
    /// # Errors
    /// A radius that is no positive number.
    pub fn new(mesh: &FarMesh, radius: Option<f64>, largest_diameter: f64) -> Result<Self, GasError> {
        let reach = |cell: usize| {
            let centre = mesh.centres()[cell];
            mesh.faces_of(cell).iter().map(|face| face.offset - face.normal.dot(&centre)).fold(0.0, f64::max)
        };
        let reaches: Vec<f64> = (0..mesh.cell_count()).map(reach).collect();
        let widest = 2.0 * reaches.iter().copied().fold(0.0, f64::max);
        let radius = radius.unwrap_or((OVER_CELL * widest).max(OVER_DIAMETER * largest_diameter));
        if !(radius.is_finite() && radius > 0.0) {
            return Err(GasError::Settings(format!(
                "the smoothing length is {radius} m; give a positive one"
            )));
        }
        let mut mapping = Self {
            radius,
            centres: mesh.centres().to_vec(),
            volumes: mesh.volumes().to_vec(),
            first: vec![0],
            near_cells: Vec::new(),
            shifts: vec![Vector3::zeros()],
        };
        let around: Vec<Vec<(u32, Vector3<f64>)>> = (0..mesh.cell_count())
            .into_par_iter()
            .map(|cell| around(mesh, cell, radius + CORNER * reaches[cell]))
            .collect();
        // Round-off makes many shifts of one.
        let same = 1e-6 * widest;
        for cells in around {
            for (cell, shift) in cells {
                let known = mapping.shifts.iter().position(|known| (known - shift).norm() < same);
                let place = known.unwrap_or_else(|| {
                    mapping.shifts.push(shift);
                    mapping.shifts.len() - 1
                });
                mapping.near_cells.push(NearCell { cell, shift: place as u32 });
            }
            mapping.first.push(mapping.near_cells.len());
        }
        Ok(mapping)
    }

    /// Radius R over which a grain is spread [m].
    #[must_use]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Shares of all grains at their places [m] in their cells.
    pub(crate) fn fill(&self, places: &[Vector3<f64>], cells: &[u32], shares: &mut Shares) {
        let parts: Vec<(Vec<usize>, Vec<Share>)> = places
            .par_chunks(CHUNK)
            .zip(cells.par_chunks(CHUNK))
            .map(|(places, cells)| {
                let mut found = Vec::new();
                let one = |(place, &cell): (&Vector3<f64>, &u32)| {
                    self.shares(place, cell, &mut found);
                    found.len()
                };
                let ends = places.iter().zip(cells).map(one).collect();
                (ends, found)
            })
            .collect();
        shares.first.clear();
        shares.first.push(0);
        shares.all.clear();
        for (ends, found) in parts {
            let begin = shares.all.len();
            shares.first.extend(ends.into_iter().map(|end| begin + end));
            shares.all.extend(found);
        }
    }

    /// Adds the shares of a grain at a point [m] in a cell.
    pub fn shares(&self, point: &Vector3<f64>, cell: u32, shares: &mut Vec<Share>) {
        let begin = shares.len();
        let mut sum = 0.0;
        let per_square = 1.0 / (self.radius * self.radius);
        for near_cell in &self.near_cells[self.first[cell as usize]..self.first[cell as usize + 1]] {
            let centre = self.centres[near_cell.cell as usize] + self.shifts[near_cell.shift as usize];
            let rest = 1.0 - (point - centre).norm_squared() * per_square;
            if rest > 0.0 {
                let weight = self.volumes[near_cell.cell as usize] * rest * rest * rest;
                sum += weight;
                shares.push(Share { cell: near_cell.cell, weight });
            }
        }
        if sum > 0.0 {
            shares[begin..].iter_mut().for_each(|share| share.weight /= sum);
        } else {
            shares.push(Share { cell, weight: 1.0 });
        }
    }
}

/// Cells within a distance of a cell's centre, and the shifts with which they are seen.
///
/// The cell itself comes first, then the others as they are reached through faces.
fn around(mesh: &FarMesh, cell: usize, distance: f64) -> Vec<(u32, Vector3<f64>)> {
    let centre = mesh.centres()[cell];
    let mut found = vec![(cell as u32, Vector3::zeros())];
    let mut next = 0;
    while next < found.len() {
        let (from, moved) = found[next];
        next += 1;
        for face in mesh.faces_of(from as usize) {
            let Neighbour::Cell { cell: to, shift } = face.neighbour else { continue };
            let moved = moved + shift;
            let seen_at = mesh.centres()[to as usize] + moved;
            let known = |&(cell, shift): &(u32, Vector3<f64>)| {
                cell == to && (mesh.centres()[to as usize] + shift - seen_at).norm() < 1e-6 * distance
            };
            if (seen_at - centre).norm() <= distance && !found.iter().any(known) {
                found.push((to, moved));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::{Boundary, Domain};
    use amberfield_field::far::FarMeshParts;
    use proptest::prelude::*;

    fn mesh(boundary: Boundary) -> FarMesh {
        let faces = [[Boundary::Periodic; 2], [boundary; 2], [Boundary::Grounded; 2]];
        let domain = Domain::new(Vector3::zeros(), Vector3::new(4.0, 5.0, 6.0), faces).unwrap();
        FarMesh::new(FarMeshParts::of_box(&domain, [4, 5, 6]).unwrap()).unwrap()
    }

    fn by_cell(mapping: &Mapping, mesh: &FarMesh, point: Vector3<f64>) -> Vec<f64> {
        let mut shares = Vec::new();
        mapping.shares(&point, mesh.locate(&point, None).0, &mut shares);
        let mut sums = vec![0.0; mesh.cell_count()];
        shares.iter().for_each(|share| sums[share.cell as usize] += share.weight);
        sums
    }

    proptest! {
        #[test]
        fn shares_add_up_to_one_and_do_not_jump_across_faces(
            x in 0.0..4.0_f64, y in 0.0..5.0_f64, z in 0.0..6.0_f64,
            radius in 1.0..2.5_f64, axis in 0..3_usize,
        ) {
            let mesh = mesh(Boundary::Periodic);
            let mapping = Mapping::new(&mesh, Some(radius), 0.1).unwrap();
            let mut on_face = Vector3::new(x, y, z);
            on_face[axis] = on_face[axis].round();
            let domain = mesh.domain();
            let side = |sign: f64| {
                let mut point = on_face;
                point[axis] += sign * 1e-9;
                let mut point = domain.wrap(point);
                point.z = point.z.clamp(0.0, 6.0);
                by_cell(&mapping, &mesh, point)
            };
            let (below, above) = (side(-1.0), side(1.0));
            prop_assert!((below.iter().sum::<f64>() - 1.0).abs() < 1e-14);
            for (below, above) in below.iter().zip(&above) {
                prop_assert!((below - above).abs() < 1e-7, "{below} {above}");
            }
        }
    }

    #[test]
    fn cells_smaller_than_grains_share_them_and_walls_lose_nothing() {
        let mesh = mesh(Boundary::Grounded);
        let mapping = Mapping::new(&mesh, None, 3.0).unwrap();
        assert_eq!(mapping.radius(), 4.5);
        let corner = by_cell(&mapping, &mesh, Vector3::new(0.0, 0.0, 0.0));
        assert!((corner.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        assert!(corner.iter().all(|&weight| weight < 0.1));
        // Cells larger than grains: one and its neighbours.
        let mapping = Mapping::new(&mesh, None, 0.1).unwrap();
        assert_eq!(mapping.radius(), 1.25);
        let middle = by_cell(&mapping, &mesh, Vector3::new(1.5, 2.5, 2.5));
        assert_eq!(middle.iter().filter(|&&weight| weight > 0.0).count(), 7);
    }

    #[test]
    fn a_tiny_radius_leaves_a_grain_to_its_cell_and_nonsense_is_refused() {
        let mesh = mesh(Boundary::Grounded);
        let mapping = Mapping::new(&mesh, Some(1e-3), 0.1).unwrap();
        let point = Vector3::new(1.2, 2.2, 2.2);
        assert_eq!(by_cell(&mapping, &mesh, point)[mesh.locate(&point, None).0 as usize], 1.0);
        assert!(Mapping::new(&mesh, Some(f64::NAN), 0.1).is_err());
    }
}
