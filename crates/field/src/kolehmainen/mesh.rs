//! Poisson's equation on the cells of a box: seven-point finite volumes, solved directly by transforms.
//!
//! Walls are cell faces: a conductor lies half a cell from the cell's centre, an insulator gives its flux.

use super::lattice::green_function;
use crate::FieldError;
use crate::grid::axis::smooth_even;
use crate::grid::transform::{LineScratch, LineTransform, Symmetry};
use crate::images::{AxisKind, FaceKind, Geometry, axis_kinds};
use amberfield_core::{Axis, Boundary, Domain, Side};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Shares into which planes are cut; each has its own working memory.
const SHARES: usize = 16;

/// What lies beyond the last cell.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Beyond {
    /// The array goes on: the opposite side, or free space that was solved for.
    Cell,
    /// Face at a potential [V].
    Potential(f64),
    /// Face with a slope of the potential outwards [V/m].
    Slope(f64),
}

/// The inverse of −∇²_h.
#[derive(Debug)]
enum Inverse {
    /// Eigenvalues of each axis [1/m²] by coefficient; their sum's inverse, 0 for the constant mode.
    Eigenvalues([Vec<f64>; 3]),
    /// Transform of the unbounded grid's Green function [m²] by wave index.
    Kernel { values: Vec<f64>, waves: [usize; 3] },
}

#[derive(Debug)]
struct Share {
    scratch: [LineScratch; 3],
    line: Vec<f64>,
}

/// Cells of a box with their potential.
#[derive(Debug)]
pub(super) struct Mesh {
    pub(super) cells: [usize; 3],
    pub(super) spacing: Vector3<f64>,
    beyond: [[Beyond; 2]; 3],
    transforms: [LineTransform; 3],
    /// Lengths of the transforms: the cells, or more than twice as many in free space.
    lengths: [usize; 3],
    inverse: Inverse,
    /// Right-hand side, then potential [V], index [x][y][z].
    potential: Vec<f64>,
    /// Lines along x, index [y][z][x].
    lines: Vec<f64>,
    shares: Vec<Share>,
    /// Face values' part of the right-hand side [V/m²], absent when they are zero.
    walls: Option<Vec<f64>>,
}

impl Mesh {
    /// A mesh of so many cells along each axis.
    ///
    /// # Errors
    /// Open faces beside others.
    pub(super) fn new(domain: &Domain, cells: [usize; 3]) -> Result<Self, FieldError> {
        let kinds = axis_kinds(domain);
        let spacing = Vector3::from_fn(|axis, _| domain.extent()[axis] / cells[axis] as f64);
        let is_free = kinds.iter().all(|kind| *kind == AxisKind::Faces(FaceKind::Open, FaceKind::Open));
        if !is_free && Geometry::of(domain)? != Geometry::Closed {
            return Err(FieldError::Settings(
                "method kolehmainen on the internal grid needs all faces open or none; close the open faces, or choose method p3m".into(),
            ));
        }
        let transforms = [0, 1, 2].map(|axis| {
            let length = if is_free { smooth_even(2 * cells[axis] + 2) } else { cells[axis] };
            LineTransform::new(symmetry(kinds[axis]), length)
        });
        let lengths = transforms.each_ref().map(LineTransform::len);
        let size: usize = lengths.iter().product();
        let share = || Share {
            scratch: transforms.each_ref().map(LineTransform::scratch),
            line: vec![0.0; lengths[1]],
        };
        let mut mesh = Self {
            cells,
            spacing,
            beyond: Axis::ALL.map(|axis| [Side::Min, Side::Max].map(|side| beyond(domain.face(axis, side)))),
            lengths,
            inverse: Inverse::Eigenvalues([0, 1, 2].map(|a| eigenvalues(&transforms[a], spacing[a]))),
            potential: vec![0.0; size],
            lines: vec![0.0; size],
            shares: (0..SHARES).map(|_| share()).collect(),
            transforms,
            walls: None,
        };
        if is_free {
            mesh.inverse = mesh.free_space();
        }
        mesh.walls = mesh.wall_source();
        Ok(mesh)
    }

    /// The cell that holds a point of the box at the given distance from its lower corner [m].
    pub(super) fn cell_of(&self, offset: &Vector3<f64>) -> [usize; 3] {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the cells")]
        [0, 1, 2]
            .map(|axis| ((offset[axis] / self.spacing[axis]).max(0.0) as usize).min(self.cells[axis] - 1))
    }

    /// Solves −∇²φ = Σ charge/(permittivity · cell volume) with the faces' conditions.
    pub(super) fn solve(&mut self, cells: &[[usize; 3]], charges: &[f64], permittivity: f64) {
        match &self.walls {
            Some(walls) => self.potential.copy_from_slice(walls),
            None => self.potential.fill(0.0),
        }
        let factor = 1.0 / (permittivity * self.spacing.product());
        for (cell, charge) in cells.iter().zip(charges) {
            let index = self.index(*cell);
            self.potential[index] += charge * factor;
        }
        self.forward();
        self.invert();
        self.backward();
    }

    /// Potential of a cell [V].
    pub(super) fn potential(&self, cell: [usize; 3]) -> f64 {
        self.potential[self.index(cell)]
    }

    /// E = −∇φ of a cell [V/m], by Gauss' theorem with linear interpolation to the faces.
    pub(super) fn field(&self, cell: [usize; 3]) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| {
            (self.face(cell, axis, Side::Min) - self.face(cell, axis, Side::Max)) / self.spacing[axis]
        })
    }

    fn face(&self, cell: [usize; 3], axis: usize, side: Side) -> f64 {
        let (at, here) = (cell[axis], self.potential(cell));
        let is_last = if side == Side::Min { at == 0 } else { at + 1 == self.cells[axis] };
        match self.beyond[axis][side as usize] {
            Beyond::Potential(volts) if is_last => volts,
            Beyond::Slope(slope) if is_last => here + slope * 0.5 * self.spacing[axis],
            _ => {
                let mut next = cell;
                let step = if side == Side::Min { self.lengths[axis] - 1 } else { 1 };
                next[axis] = (at + step) % self.lengths[axis];
                0.5 * (here + self.potential(next))
            }
        }
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        (cell[0] * self.lengths[1] + cell[1]) * self.lengths[2] + cell[2]
    }

    /// What the faces' values add to the right-hand side of the cells beside them.
    fn wall_source(&self) -> Option<Vec<f64>> {
        let mut walls = vec![0.0; self.potential.len()];
        for axis in 0..3 {
            let h = self.spacing[axis];
            for side in [0, 1] {
                let value = match self.beyond[axis][side] {
                    Beyond::Cell => 0.0,
                    Beyond::Potential(volts) => 2.0 * volts / (h * h),
                    Beyond::Slope(slope) => slope / h,
                };
                if value == 0.0 {
                    continue;
                }
                let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
                for i in 0..self.cells[b] {
                    for j in 0..self.cells[c] {
                        let mut cell = [0; 3];
                        cell[axis] = if side == 0 { 0 } else { self.cells[axis] - 1 };
                        (cell[b], cell[c]) = (i, j);
                        walls[self.index(cell)] += value;
                    }
                }
            }
        }
        walls.iter().any(|value| *value != 0.0).then_some(walls)
    }

    /// Values to coefficients, left in `lines`.
    fn forward(&mut self) {
        let [nx, ny, nz] = self.lengths;
        let [along_x, along_y, along_z] = &self.transforms;
        let planes = nx.div_ceil(SHARES);
        self.potential.par_chunks_mut(planes * ny * nz).zip(&mut self.shares).for_each(|(planes, share)| {
            for plane in planes.chunks_mut(ny * nz) {
                for row in plane.chunks_mut(nz) {
                    along_z.forward(row, &mut share.scratch[2]);
                }
                each_column(plane, nz, &mut share.line, |line| along_y.forward(line, &mut share.scratch[1]));
            }
        });
        let values = &self.potential;
        let planes = ny.div_ceil(SHARES);
        self.lines.par_chunks_mut(planes * nz * nx).zip(&mut self.shares).enumerate().for_each(
            |(part, (lines, share))| {
                for (index, line) in lines.chunks_mut(nx).enumerate() {
                    let place = part * planes * nz + index;
                    for (x, value) in line.iter_mut().enumerate() {
                        *value = values[x * ny * nz + place];
                    }
                    along_x.forward(line, &mut share.scratch[0]);
                }
            },
        );
    }

    /// Coefficients of the right-hand side to those of the potential, with the transforms' scale.
    fn invert(&mut self) {
        let [nx, _, nz] = self.lengths;
        let scale = 1.0 / self.transforms.iter().map(LineTransform::scale).product::<f64>();
        let (inverse, transforms) = (&self.inverse, &self.transforms);
        self.lines.par_chunks_mut(nx).enumerate().for_each(|(place, line)| {
            let (y, z) = (place / nz, place % nz);
            match inverse {
                Inverse::Eigenvalues([of_x, of_y, of_z]) => {
                    for (value, of_x) in line.iter_mut().zip(of_x) {
                        let sum = of_x + of_y[y] + of_z[z];
                        *value *= if sum > 0.0 { scale / sum } else { 0.0 };
                    }
                }
                Inverse::Kernel { values, waves } => {
                    let (wave_y, wave_z) = (transforms[1].wave_index(y), transforms[2].wave_index(z));
                    for (x, value) in line.iter_mut().enumerate() {
                        let wave_x = transforms[0].wave_index(x);
                        *value *= scale * values[(wave_y * waves[2] + wave_z) * waves[0] + wave_x];
                    }
                }
            }
        });
    }

    /// Coefficients in `lines` to values.
    fn backward(&mut self) {
        let [nx, ny, nz] = self.lengths;
        let [along_x, along_y, along_z] = &self.transforms;
        let planes = ny.div_ceil(SHARES);
        self.lines.par_chunks_mut(planes * nz * nx).zip(&mut self.shares).for_each(|(lines, share)| {
            for line in lines.chunks_mut(nx) {
                along_x.inverse(line, &mut share.scratch[0]);
            }
        });
        let lines = &self.lines;
        let planes = nx.div_ceil(SHARES);
        self.potential.par_chunks_mut(planes * ny * nz).zip(&mut self.shares).enumerate().for_each(
            |(part, (values, share))| {
                for (index, plane) in values.chunks_mut(ny * nz).enumerate() {
                    let x = part * planes + index;
                    for (place, value) in plane.iter_mut().enumerate() {
                        *value = lines[place * nx + x];
                    }
                    each_column(plane, nz, &mut share.line, |line| {
                        along_y.inverse(line, &mut share.scratch[1])
                    });
                    for row in plane.chunks_mut(nz) {
                        along_z.inverse(row, &mut share.scratch[2]);
                    }
                }
            },
        );
    }

    /// Transform of the unbounded grid's Green function, repeated beyond all distances between cells.
    fn free_space(&mut self) -> Inverse {
        let most = self.lengths.map(|length| length / 2);
        let green = green_function(most, self.spacing);
        let [_, ny, nz] = self.lengths;
        for (index, value) in self.potential.iter_mut().enumerate() {
            let [x, y, z] = [index / (ny * nz), index / nz % ny, index % nz];
            let distance = |at: usize, axis: usize| at.min(self.lengths[axis] - at);
            let row = distance(x, 0) * (most[1] + 1) + distance(y, 1);
            *value = green[row * (most[2] + 1) + distance(z, 2)];
        }
        self.forward();
        // Even functions have real coefficients alone, the first of each pair.
        let real = |wave: usize| (2 * wave).saturating_sub(1);
        let waves = self.transforms.each_ref().map(LineTransform::wave_count);
        let mut values = vec![0.0; waves.iter().product()];
        for (index, value) in values.iter_mut().enumerate() {
            let [y, z, x] = [index / (waves[0] * waves[2]), index / waves[0] % waves[2], index % waves[0]];
            *value = self.lines[(real(y) * nz + real(z)) * self.lengths[0] + real(x)];
        }
        Inverse::Kernel { values, waves }
    }

    /// Memory held [bytes].
    pub(super) fn memory_bytes(&self) -> usize {
        let inverse = match &self.inverse {
            Inverse::Eigenvalues(_) => 0,
            Inverse::Kernel { values, .. } => values.len(),
        };
        let walls = self.walls.as_ref().map_or(0, Vec::len);
        (self.potential.len() + self.lines.len() + inverse + walls) * size_of::<f64>()
    }
}

/// Applies a transform to every column of a plane with rows of the given length.
fn each_column(plane: &mut [f64], row: usize, line: &mut [f64], mut transform: impl FnMut(&mut [f64])) {
    for column in 0..row {
        for (value, source) in line.iter_mut().zip(plane[column..].iter().step_by(row)) {
            *value = *source;
        }
        transform(line);
        for (value, target) in line.iter().zip(plane[column..].iter_mut().step_by(row)) {
            *target = *value;
        }
    }
}

fn beyond(face: Boundary) -> Beyond {
    match face {
        // E·n = −∂φ/∂n.
        Boundary::Insulating { normal_field_v_m } => Beyond::Slope(-normal_field_v_m),
        face => face.potential().map_or(Beyond::Cell, Beyond::Potential),
    }
}

fn symmetry(kind: AxisKind) -> Symmetry {
    use FaceKind::{Conductor, Insulator};
    match kind {
        AxisKind::Faces(Conductor, Conductor) => Symmetry::OddOdd,
        AxisKind::Faces(Insulator, Insulator) => Symmetry::EvenEven,
        AxisKind::Faces(Conductor, Insulator) => Symmetry::OddEven,
        AxisKind::Faces(Insulator, Conductor) => Symmetry::EvenOdd,
        _ => Symmetry::Periodic,
    }
}

/// Eigenvalues (2 sin(kh/2)/h)² of the axis' part of −∇²_h [1/m²] by coefficient.
fn eigenvalues(transform: &LineTransform, spacing: f64) -> Vec<f64> {
    (0..transform.len())
        .map(|coefficient| {
            let angle = transform.wave_number(transform.wave_index(coefficient));
            (2.0 * (0.5 * angle).sin() / spacing).powi(2)
        })
        .collect()
}
