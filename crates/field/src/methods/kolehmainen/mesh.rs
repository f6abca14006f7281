//! Poisson's equation on the cells of a box: seven-point finite volumes, solved directly by transforms.
//!
//! Walls are cell faces: a conductor lies half a cell from the cell's centre, an insulator gives its flux.

use super::inverse::Inverse;
use crate::error::FieldError;
use crate::geometry::images::FaceKind::{Conductor, Insulator, Open};
use crate::geometry::images::{AxisKind, Geometry, axis_kinds};
use crate::levels::faces::BoundaryField;
use crate::levels::grid::axis::{smooth_even, symmetry};
use crate::levels::grid::solve::{TILE, across_rows};
use crate::levels::grid::transform::{LineScratch, LineTransform, Symmetry};
use amberfield_core::{Axis, Boundary, Domain, Side};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Shares into which planes are cut; each has its own working memory.
const SHARES: usize = 16;

/// Neighbour beyond the last cell.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Beyond {
    /// The array goes on: the opposite side, or free space that was solved for.
    Cell,
    /// Face at a potential [V].
    Potential(f64),
    /// Face with a slope of the potential outwards [V/m].
    Slope(f64),
}

impl Beyond {
    fn without_value(self) -> Self {
        match self {
            Self::Cell => Self::Cell,
            Self::Potential(_) => Self::Potential(0.0),
            Self::Slope(_) => Self::Slope(0.0),
        }
    }
}

/// One axis of the mesh.
#[derive(Debug)]
pub(super) struct MeshAxis {
    /// Cells of the box.
    pub(super) cells: usize,
    /// Cell size [m].
    pub(super) spacing: f64,
    /// Place in the transform at which the box's cells begin.
    offset: usize,
    /// Transform over the cells, and over free space beside them where a face is open.
    pub(super) transform: LineTransform,
    /// Cells after which an open axis repeats itself; `None` for a closed axis.
    pub(super) period: Option<usize>,
    beyond: [Beyond; 2],
}

impl MeshAxis {
    fn new(domain: &Domain, axis: Axis, kind: AxisKind, cells: usize) -> Self {
        let spacing = domain.extent()[axis.index()] / cells as f64;
        let symmetry = symmetry(kind);
        let (mut length, mut period) = (cells, None);
        if kind.is_open() {
            // Room for all distances between a cell of the box, or the next one, and a cell or its mirror
            // image.
            length = smooth_even(2 * cells + 2);
            period = Some(if symmetry == Symmetry::Periodic { length } else { 2 * length });
        }
        let at_end = matches!(kind, AxisKind::Faces(Open, Conductor | Insulator));
        Self {
            cells,
            spacing,
            offset: if at_end { length - cells } else { 0 },
            transform: LineTransform::new(symmetry, length),
            period,
            beyond: [Side::Min, Side::Max].map(|side| beyond(domain.face(axis, side))),
        }
    }

    /// Order of the wave of a coefficient on an open axis: it has so many wavelengths in the period.
    pub(super) fn order(&self, coefficient: usize) -> usize {
        let first = usize::from(self.transform.symmetry() == Symmetry::OddOdd);
        self.transform.wave_index(coefficient) + first
    }

    /// Eigenvalue (2 sin(kh/2)/h)² of the axis' part of −∇²_h [1/m²].
    pub(super) fn eigenvalue(&self, coefficient: usize) -> f64 {
        let angle = self.transform.wave_number(self.transform.wave_index(coefficient));
        (2.0 * (0.5 * angle).sin() / self.spacing).powi(2)
    }
}

#[derive(Debug)]
struct Share {
    scratch: [LineScratch; 3],
    tile: Vec<f64>,
}

/// Cells of a box with their potential.
#[derive(Debug)]
pub(super) struct Mesh {
    axes: [MeshAxis; 3],
    origin: Vector3<f64>,
    /// Lengths of the transforms.
    lengths: [usize; 3],
    inverse: Inverse,
    /// Right-hand side, then potential [V], index [x][y][z].
    potential: Vec<f64>,
    /// Lines along x, index [y][z][x].
    lines: Vec<f64>,
    shares: Vec<Share>,
    /// Face values' part of the right-hand side [V/m²], absent when they are zero.
    walls: Option<Vec<f64>>,
    /// Field of the faces' values where a face is open: they reach beyond the box, so that cells cannot
    /// hold them.
    faces: Option<BoundaryField>,
}

impl Mesh {
    /// A mesh of so many cells along each axis.
    ///
    /// # Errors
    /// Open faces on two axes and none on the third; face values beside open faces whose field is not linear.
    pub(super) fn new(domain: &Domain, cells: [usize; 3]) -> Result<Self, FieldError> {
        let (geometry, kinds) = (Geometry::of(domain), axis_kinds(domain));
        let mut axes =
            Axis::ALL.map(|axis| MeshAxis::new(domain, axis, kinds[axis.index()], cells[axis.index()]));
        let mut faces = None;
        if let Geometry::Gap(closed) = geometry {
            return Err(FieldError::Settings(format!(
                "method kolehmainen has no mesh for a domain that is open along two axes and closed along \
                 {closed}; choose method p3m, or close one of the two"
            )));
        }
        if geometry != Geometry::Closed {
            faces = BoundaryField::new(domain)?;
            if faces.as_ref().is_some_and(|field| !field.is_closed_form()) {
                return Err(FieldError::Settings(
                    "method kolehmainen cannot have potentials or normal fields on faces of several axes \
                     beside open faces on the internal grid; close the open faces, ground the others, or \
                     choose method p3m"
                        .into(),
                ));
            }
            for beyond in axes.iter_mut().flat_map(|axis| &mut axis.beyond) {
                *beyond = beyond.without_value();
            }
        }
        let lengths = axes.each_ref().map(|axis| axis.transform.len());
        let size: usize = lengths.iter().product();
        let share = || Share {
            scratch: axes.each_ref().map(|axis| axis.transform.scratch()),
            tile: vec![0.0; TILE * lengths[1]],
        };
        let mut mesh = Self {
            origin: domain.min(),
            lengths,
            inverse: Inverse::new(&axes),
            potential: vec![0.0; size],
            lines: vec![0.0; size],
            shares: (0..SHARES).map(|_| share()).collect(),
            axes,
            walls: None,
            faces,
        };
        mesh.walls = mesh.wall_source();
        Ok(mesh)
    }

    /// Cells of the box per axis.
    pub(super) fn cells(&self) -> [usize; 3] {
        self.axes.each_ref().map(|axis| axis.cells)
    }

    /// A cell's number.
    #[expect(clippy::cast_possible_truncation, reason = "fewer than 2³² cells")]
    pub(super) fn number(&self, [x, y, z]: [usize; 3]) -> u32 {
        let [_, ny, nz] = self.cells();
        ((x * ny + y) * nz + z) as u32
    }

    /// The cell of a number.
    pub(super) fn place(&self, number: u32) -> [usize; 3] {
        let ([_, ny, nz], number) = (self.cells(), number as usize);
        [number / (ny * nz), number / nz % ny, number % nz]
    }

    /// Cell size [m].
    pub(super) fn spacing(&self) -> Vector3<f64> {
        Vector3::from_fn(|axis, _| self.axes[axis].spacing)
    }

    /// The cell that holds a point of the box [m].
    pub(super) fn cell_of(&self, point: &Vector3<f64>) -> [usize; 3] {
        let offset = point - self.origin;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to the cells")]
        [0, 1, 2].map(|a| ((offset[a] / self.axes[a].spacing).max(0.0) as usize).min(self.axes[a].cells - 1))
    }

    /// Solves −∇²φ = Σ charge/(permittivity · cell volume) with the faces' conditions; permittivity in F/m.
    pub(super) fn solve_for(&mut self, cells: &[u32], charges: &[f64], permittivity: f64) {
        match &self.walls {
            Some(walls) => self.potential.copy_from_slice(walls),
            None => self.potential.fill(0.0),
        }
        let factor = 1.0 / (permittivity * self.spacing().product());
        for (cell, charge) in cells.iter().zip(charges) {
            let index = self.index(self.place(*cell));
            self.potential[index] += charge * factor;
        }
        self.forward();
        self.inverse.apply(&self.axes, &mut self.lines);
        self.backward();
    }

    /// Potential of a cell [V].
    pub(super) fn potential_of(&self, cell: [usize; 3]) -> f64 {
        self.solved(cell)
            + self.faces.as_ref().map_or(0.0, |faces| faces.evaluate(&self.centre_of(cell)).potential)
    }

    /// E = −∇φ of a cell [V/m], by Gauss' theorem with linear interpolation to the faces.
    pub(super) fn field_of(&self, cell: [usize; 3]) -> Vector3<f64> {
        let solved = Vector3::from_fn(|axis, _| {
            (self.face(cell, axis, Side::Min) - self.face(cell, axis, Side::Max)) / self.axes[axis].spacing
        });
        match &self.faces {
            None => solved,
            Some(faces) => solved + faces.evaluate(&self.centre_of(cell)).e,
        }
    }

    pub(super) fn centre_of(&self, cell: [usize; 3]) -> Vector3<f64> {
        self.origin + Vector3::from_fn(|axis, _| (cell[axis] as f64 + 0.5) * self.axes[axis].spacing)
    }

    fn face(&self, cell: [usize; 3], index: usize, side: Side) -> f64 {
        let axis = &self.axes[index];
        let (at, here) = (cell[index], self.solved(cell));
        let is_last = if side == Side::Min { at == 0 } else { at + 1 == axis.cells };
        match axis.beyond[side as usize] {
            Beyond::Potential(volts) if is_last => volts,
            Beyond::Slope(slope) if is_last => here + slope * 0.5 * axis.spacing,
            _ => {
                let mut next = cell;
                let step = if side == Side::Min { self.lengths[index] - 1 } else { 1 };
                next[index] = (at + step) % self.lengths[index];
                0.5 * (here + self.solved(next))
            }
        }
    }

    /// Potential that the charges and the walls' cells make [V].
    fn solved(&self, cell: [usize; 3]) -> f64 {
        self.potential[self.index(cell)]
    }

    fn index(&self, cell: [usize; 3]) -> usize {
        let [x, y, z] = [0, 1, 2].map(|axis| (cell[axis] + self.axes[axis].offset) % self.lengths[axis]);
        (x * self.lengths[1] + y) * self.lengths[2] + z
    }

    /// Part that the faces' values add to the right-hand side of the cells beside them.
    fn wall_source(&self) -> Option<Vec<f64>> {
        let mut walls = vec![0.0; self.potential.len()];
        for axis in 0..3 {
            let h = self.axes[axis].spacing;
            for side in [0, 1] {
                let value = match self.axes[axis].beyond[side] {
                    Beyond::Cell => 0.0,
                    Beyond::Potential(volts) => 2.0 * volts / (h * h),
                    Beyond::Slope(slope) => slope / h,
                };
                if value == 0.0 {
                    continue;
                }
                let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
                for i in 0..self.axes[b].cells {
                    for j in 0..self.axes[c].cells {
                        let mut cell = [0; 3];
                        cell[axis] = if side == 0 { 0 } else { self.axes[axis].cells - 1 };
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
        let [along_x, along_y, along_z] = self.axes.each_ref().map(|axis| &axis.transform);
        let planes = nx.div_ceil(SHARES);
        self.potential.par_chunks_mut(planes * ny * nz).zip(&mut self.shares).for_each(|(planes, share)| {
            for plane in planes.chunks_mut(ny * nz) {
                for row in plane.chunks_mut(nz) {
                    along_z.forward(row, &mut share.scratch[2]);
                }
                across_rows(plane, nz, &mut share.tile, |line| along_y.forward(line, &mut share.scratch[1]));
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

    /// Coefficients in `lines` to values.
    fn backward(&mut self) {
        let [nx, ny, nz] = self.lengths;
        let [along_x, along_y, along_z] = self.axes.each_ref().map(|axis| &axis.transform);
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
                    across_rows(plane, nz, &mut share.tile, |line| {
                        along_y.inverse(line, &mut share.scratch[1])
                    });
                    for row in plane.chunks_mut(nz) {
                        along_z.inverse(row, &mut share.scratch[2]);
                    }
                }
            },
        );
    }

    /// Memory held [bytes].
    pub(super) fn bytes(&self) -> usize {
        let walls = self.walls.as_ref().map_or(0, Vec::len);
        (self.potential.len() + self.lines.len() + self.inverse.len() + walls) * size_of::<f64>()
    }
}

fn beyond(face: Boundary) -> Beyond {
    match face {
        // E·n = −∂φ/∂n.
        Boundary::Insulating { normal_field_v_m } => Beyond::Slope(-normal_field_v_m),
        face => face.potential().map_or(Beyond::Cell, Beyond::Potential),
    }
}
