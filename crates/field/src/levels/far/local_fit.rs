//! The potential within a cell: a quadratic through the cell's own value, fitted to those around it.
//!
//! φ(x) = φ_c + g·d + ½ d·H·d, d = (x − x_c)/h, h the cube root of the cell's volume, by least squares with
//! the weights exp(−d²/(2 s²)) over the neighbours, their neighbours, and the slopes at boundary faces.
//!
//! Where a face's potential φ_b is given, the slope is that of finite volumes, (φ_b − φ_c)/δ with the centre
//! of the face's cell a distance δ before it. Finite volumes conserve the flux, so that this is the slope at
//! the face to second order; φ_c bears what it misses, ½ δ² ∂²φ/∂n², against φ_b. How φ_b differs from face
//! to face counts, therefore, but not its difference from the cells: that is an unknown of the fit.

use super::{BoundaryFace, Condition, FarMesh, Neighbour};
use crate::levels::walls::polygon;
use crate::values::FieldAt;
use nalgebra::{SMatrix, SVector, Vector3};
use rayon::prelude::*;

/// s: as narrow as leaves the mixed terms determined.
const WEIGHT_WIDTH: f64 = 0.75;
/// Rings of cells around one that a fit looks at, at least and at most, and values that are enough for it:
/// tetrahedra have few neighbours.
const LEAST_RINGS: usize = 2;
const MOST_RINGS: usize = 4;
const ENOUGH: usize = 20;
/// Weight of the slopes that finite volumes take at given potentials, over that of values: they tell the
/// least of narrow fields. A bed of one sign errs 2.2 times less than with potentials alone, a few grains as
/// much, and the field behind a plate is 0.8 instead of 0.7 % of that before it.
const OF_DIFFERENCES: f64 = 0.2;
/// Distance of a centre from a face at least, over that from the face's centre, as OpenFOAM has it.
const LEAST_DISTANCE: f64 = 0.05;
/// Distance from a face up to which both its cells have a say, over the cell's size.
const BLENDED: f64 = 0.25;
/// Weight that keeps terms of which no neighbour tells anything (a mesh one cell thick) at zero, over the
/// largest of its kind.
const RIDGE: f64 = 1e-9;
/// Share of a line, or of a face's size, within which a place lies on a face.
const ON_FACE: f64 = 1e-6;
/// Numbers of a fit: g and H; unknowns of its equations: the cells' difference from given potentials, too.
const TERMS: usize = 9;
const UNKNOWNS: usize = TERMS + 1;

/// Source of a row of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    /// Potential of a cell.
    Cell(u32),
    /// Slope at a boundary face.
    Slope(u32),
    /// Potential given at a boundary face.
    Potential(u32),
}

/// One value's part in a cell's fit.
#[derive(Clone, Copy, Debug)]
struct Row {
    source: Source,
    /// Contribution to each term, per volt.
    part: [f32; TERMS],
}

/// g and H of a cell, in volts.
type Fit = [f64; TERMS];

/// Fits of all cells.
#[derive(Debug)]
pub(crate) struct LocalFits {
    size: Vec<f64>,
    first_row: Vec<usize>,
    rows: Vec<Row>,
    fits: Vec<Fit>,
    potential: Vec<f64>,
    smoothing: f64,
    smoothing_over_size: f64,
}

impl LocalFits {
    pub(crate) fn new(mesh: &FarMesh) -> Self {
        let cells: Vec<(Vec<Row>, f64)> =
            (0..mesh.cell_count()).into_par_iter().map(|cell| rows_of(mesh, cell)).collect();
        let mut first_row = vec![0];
        first_row.extend(cells.iter().scan(0, |count, (rows, _)| {
            *count += rows.len();
            Some(*count)
        }));
        let size: Vec<f64> = mesh.volumes().iter().map(|volume| volume.cbrt()).collect();
        let over_size = cells.iter().zip(&size).map(|((_, smoothing), size)| smoothing / (size * size));
        Self {
            smoothing_over_size: over_size.sum::<f64>() / cells.len() as f64,
            size,
            first_row,
            smoothing: cells.iter().map(|(_, smoothing)| smoothing).sum::<f64>() / cells.len() as f64,
            rows: cells.into_iter().flat_map(|(rows, _)| rows).collect(),
            fits: vec![[0.0; TERMS]; mesh.cell_count()],
            potential: vec![0.0; mesh.cell_count()],
        }
    }

    /// Variance [m²] by which finite volumes and this fit together widen a cloud's field, to leading order
    /// in (kh)²: what is isotropic of their error.
    pub(crate) fn smoothing(&self) -> f64 {
        self.smoothing
    }

    /// Variance of [`Self::smoothing`] over the square of the cells' size, in the mean.
    pub(crate) fn smoothing_over_size(&self) -> f64 {
        self.smoothing_over_size
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        size_of_val(&self.rows[..]) + self.fits.len() * (size_of::<Fit>() + 24)
    }

    /// Fits potentials at the cells' centres [V]; `boundary` holds φ or ∂φ/∂n by boundary face.
    pub(crate) fn fit(&mut self, mesh: &FarMesh, potential: &[f64], boundary: &[f64]) {
        self.potential.copy_from_slice(potential);
        let (rows, first_row) = (&self.rows, &self.first_row);
        self.fits.par_iter_mut().enumerate().for_each(|(cell, fit)| {
            *fit = [0.0; TERMS];
            for row in &rows[first_row[cell]..first_row[cell + 1]] {
                let value = match row.source {
                    Source::Cell(other) => potential[other as usize] - potential[cell],
                    Source::Potential(face) => boundary[face as usize] - potential[cell],
                    Source::Slope(face) => {
                        let of = &mesh.boundary()[face as usize];
                        match of.condition {
                            Condition::Potential(_) => boundary[face as usize] - potential[of.cell as usize],
                            Condition::Slope(_) => boundary[face as usize],
                        }
                    }
                };
                for (term, part) in fit.iter_mut().zip(row.part) {
                    *term += f64::from(part) * value;
                }
            }
        });
    }

    /// E [V/m] and φ [V] at a point of a cell; near a face the mean of what both its cells say, so that the
    /// field goes on across it.
    pub(crate) fn across_faces_at(&self, mesh: &FarMesh, cell: u32, point: &Vector3<f64>) -> FieldAt {
        let reach = BLENDED * self.size[cell as usize];
        let mut sum = self.at(mesh, cell, point);
        let mut weights = 1.0;
        for face in mesh.faces_of(cell as usize) {
            let Neighbour::Cell { cell: other, shift } = face.neighbour else { continue };
            let weight = 1.0 - (face.offset - face.normal.dot(point)).max(0.0) / reach;
            if weight > 0.0 {
                sum += weight * self.at(mesh, other, &(point - shift));
                weights += weight;
            }
        }
        (1.0 / weights) * sum
    }

    /// Difference of E at a point of a cell from what the cell beyond the nearest face says of it [V/m]: what
    /// the cells are too coarse for.
    pub(crate) fn jump_at(&self, mesh: &FarMesh, cell: u32, point: &Vector3<f64>) -> Vector3<f64> {
        let beyond = mesh.faces_of(cell as usize).iter().filter_map(|face| match face.neighbour {
            Neighbour::Cell { cell, shift } => Some((face.offset - face.normal.dot(point), cell, shift)),
            Neighbour::Boundary(_) => None,
        });
        let nearest = beyond.min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.map_or(Vector3::zeros(), |(_, other, shift)| {
            self.at(mesh, cell, point).e - self.at(mesh, other, &(point - shift)).e
        })
    }

    /// E [V/m] and φ [V] at a point of a cell.
    pub(crate) fn at(&self, mesh: &FarMesh, cell: u32, point: &Vector3<f64>) -> FieldAt {
        let cell = cell as usize;
        let d = (point - mesh.centres()[cell]) / self.size[cell];
        let [x, y, z, xx, yy, zz, xy, xz, yz] = self.fits[cell];
        let bend = Vector3::new(
            xx * d.x + xy * d.y + xz * d.z,
            xy * d.x + yy * d.y + yz * d.z,
            xz * d.x + yz * d.y + zz * d.z,
        );
        let slope = Vector3::new(x, y, z);
        let potential = self.potential[cell] + (slope + 0.5 * bend).dot(&d);
        FieldAt { e: -(slope + bend) / self.size[cell], potential }
    }
}

/// The rows of a cell's fit, and its smoothing [m²].
fn rows_of(mesh: &FarMesh, cell: usize) -> (Vec<Row>, f64) {
    let size = mesh.volumes()[cell].cbrt();
    let around = sources_around(mesh, cell, size);
    let equations: Vec<Equation> =
        around.iter().map(|(source, offset)| Equation::new(mesh, *source, &(offset / size), size)).collect();
    let mut normal = SMatrix::<f64, UNKNOWNS, UNKNOWNS>::zeros();
    for Equation { terms, weight, .. } in &equations {
        normal += *weight * terms * terms.transpose();
    }
    for of_kind in [0..3, 3..TERMS, TERMS..UNKNOWNS] {
        let largest = of_kind.clone().map(|term| normal[(term, term)]).fold(0.0, f64::max);
        for term in of_kind {
            normal[(term, term)] += RIDGE * if largest > 0.0 { largest } else { 1.0 };
        }
    }
    let Some(factor) = normal.cholesky() else { return (Vec::new(), 0.0) };
    let mut widening = 0.0;
    let rows = equations
        .iter()
        .map(|Equation { source, terms, weight, scale, cubic }| {
            let part = factor.solve(&(*weight * terms));
            widening += size * size * part.fixed_rows::<3>(0).dot(cubic);
            Row { source: *source, part: std::array::from_fn(|term| (scale * part[term]) as f32) }
        })
        .collect();
    (rows, finite_volumes_and_place(size) + widening / 15.0)
}

/// Sources around a cell, with their places from its centre [m]: its neighbours, theirs, and so on until
/// there are enough; boundary faces of all of them. What a wall hides from the cell is left out.
fn sources_around(mesh: &FarMesh, cell: usize, size: f64) -> Vec<(Source, Vector3<f64>)> {
    let here = mesh.centres()[cell];
    let mut around: Vec<(Source, Vector3<f64>)> = Vec::new();
    let mut ring = vec![(cell, Vector3::zeros())];
    for round in 0..MOST_RINGS {
        if round >= LEAST_RINGS && around.len() >= ENOUGH {
            break;
        }
        let mut beyond = Vec::new();
        for (cell, shift) in ring {
            for face in mesh.faces_of(cell) {
                let (source, place, next) = match face.neighbour {
                    Neighbour::Cell { cell, shift: further } => {
                        let shift = shift + further;
                        (
                            Source::Cell(cell),
                            mesh.centres()[cell as usize] + shift,
                            Some((cell as usize, shift)),
                        )
                    }
                    Neighbour::Boundary(index) => {
                        let place = mesh.place_of_condition(index as usize);
                        (Source::Slope(index), place + shift, None)
                    }
                };
                let offset = place - here;
                let known = |(other, at): &(Source, Vector3<f64>)| {
                    *other == source && (at - offset).norm() < 1e-6 * size
                };
                if offset.norm() > 1e-6 * size && !around.iter().any(known) {
                    around.push((source, offset));
                    beyond.extend(next);
                }
            }
        }
        ring = beyond;
    }
    let faces: Vec<(u32, Vector3<f64>)> = around
        .iter()
        .filter_map(|(source, offset)| match source {
            Source::Slope(face) => {
                let place = mesh.place_of_condition(*face as usize);
                Some((*face, here + offset - place))
            }
            _ => None,
        })
        .collect();
    around.retain(|(source, offset)| {
        let hides = |(face, shift): &(u32, Vector3<f64>)| {
            *source != Source::Slope(*face) && is_between(mesh, *face, &(here - shift), offset)
        };
        !faces.iter().any(hides)
    });
    let given = around.iter().filter_map(|(source, offset)| match source {
        Source::Slope(face) if mesh.boundary()[*face as usize].gives_potential() => {
            Some((Source::Potential(*face), *offset))
        }
        _ => None,
    });
    around.extend(given.collect::<Vec<_>>());
    around
}

/// Whether a boundary face lies between a point and the place at an offset from it [m].
fn is_between(mesh: &FarMesh, face: u32, from: &Vector3<f64>, offset: &Vector3<f64>) -> bool {
    let BoundaryFace { centre, normal, area, .. } = mesh.boundary()[face as usize];
    let towards = normal.dot(offset);
    let share = normal.dot(&(centre - from)) / towards;
    let is_crossed = towards > 0.0 && (0.0..1.0 - ON_FACE).contains(&share);
    let at = from + offset * share;
    is_crossed && polygon::holds(mesh.corners_of(face as usize), &normal, &at, ON_FACE * area.sqrt())
}

/// Part that finite volumes on cubes (−h²/10) and the quadratic's ends (−h²/12) take off again [m²].
fn finite_volumes_and_place(size: f64) -> f64 {
    -size * size * (1.0 / 10.0 + 1.0 / 12.0)
}

/// Equation of a fit.
struct Equation {
    source: Source,
    terms: SVector<f64, UNKNOWNS>,
    weight: f64,
    /// Factor of the source's value [V or V/m].
    scale: f64,
    /// Values of the cubic potentials x d², y d², z d².
    cubic: Vector3<f64>,
}

impl Equation {
    /// Equation of a source at `d` from a cell's centre, in sizes of the cell [m].
    fn new(mesh: &FarMesh, source: Source, d: &Vector3<f64>, size: f64) -> Self {
        let weight = (-0.5 * d.norm_squared() / (WEIGHT_WIDTH * WEIGHT_WIDTH)).exp();
        let [x, y, z] = [d.x, d.y, d.z];
        let value = |unknown: f64| {
            SVector::from([x, y, z, 0.5 * x * x, 0.5 * y * y, 0.5 * z * z, x * y, x * z, y * z, unknown])
        };
        let cubic = d * d.norm_squared();
        match source {
            Source::Cell(_) => Self { source, terms: value(0.0), weight, scale: 1.0, cubic },
            Source::Potential(_) => Self { source, terms: value(1.0), weight, scale: 1.0, cubic },
            Source::Slope(face) => {
                let face = &mesh.boundary()[face as usize];
                let n = face.normal;
                let (xy, xz, yz) = (n.x * y + n.y * x, n.x * z + n.z * x, n.y * z + n.z * y);
                let terms = [n.x, n.y, n.z, n.x * x, n.y * y, n.z * z, xy, xz, yz, 0.0];
                let (weight, scale) = match face.condition {
                    Condition::Slope(_) => (weight, size),
                    Condition::Potential(_) => {
                        let apart = face.centre - mesh.centres()[face.cell as usize];
                        let distance = n.dot(&apart).max(LEAST_DISTANCE * apart.norm());
                        (OF_DIFFERENCES * weight, size / distance)
                    }
                };
                let cubic = n * d.norm_squared() + 2.0 * n.dot(d) * d;
                Self { source, terms: SVector::from(terms), weight, scale, cubic }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::mesh::FarMeshParts;
    use super::*;
    use amberfield_core::{Boundary, Domain};

    fn mesh() -> FarMesh {
        let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
        let faces = [[Boundary::Grounded; 2], [insulating; 2], [Boundary::Grounded, insulating]];
        let domain = Domain::new(Vector3::zeros(), Vector3::new(1.0, 1.2, 0.8), faces).unwrap();
        FarMesh::new(FarMeshParts::of_box(&domain, [10, 12, 8]).unwrap()).unwrap()
    }

    #[test]
    fn quadratic_potentials_are_exact_up_to_the_walls() {
        let mesh = mesh();
        let potential = |p: &Vector3<f64>| {
            1.0 + 2.0 * p.x + 0.5 * p.x * p.x - p.y * p.y + 3.0 * p.x * p.z + 0.5 * p.z * p.z
        };
        let slope = |p: &Vector3<f64>| Vector3::new(2.0 + p.x + 3.0 * p.z, -2.0 * p.y, 3.0 * p.x + p.z);
        // Finite volumes have every cell lower by ½ δ² ∂²φ/∂n² at the walls, half a cell before them.
        let lower = 0.5 * 0.05 * 0.05;
        let boundary: Vec<f64> = mesh
            .boundary()
            .iter()
            .map(|face| match face.condition {
                Condition::Potential(_) => potential(&face.centre),
                Condition::Slope(_) => slope(&face.centre).dot(&face.normal),
            })
            .collect();
        let mut fits = LocalFits::new(&mesh);
        let values: Vec<f64> = mesh.centres().iter().map(|centre| potential(centre) - lower).collect();
        fits.fit(&mesh, &values, &boundary);
        for (cell, centre) in mesh.centres().iter().enumerate() {
            let point = centre + Vector3::new(0.05, -0.03, 0.04);
            let FieldAt { e, potential: v } = fits.at(&mesh, cell as u32, &point);
            assert!((e + slope(&point)).norm() < 1e-5 && (v + lower - potential(&point)).abs() < 1e-6);
        }
    }

    #[test]
    fn smoothing_of_cubes_is_between_that_of_central_differences_and_that_of_their_mean_over_rows() {
        let domain =
            Domain::new(Vector3::zeros(), Vector3::repeat(0.8), [[Boundary::Periodic; 2]; 3]).unwrap();
        let mesh = FarMesh::new(FarMeshParts::of_box(&domain, [8; 3]).unwrap()).unwrap();
        let smoothing = LocalFits::new(&mesh).smoothing() / 0.01;
        assert!((0.0..0.3).contains(&smoothing), "{smoothing}");
    }
}
