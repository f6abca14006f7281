//! The published hybrid of mesh and pairs, reproduced for comparison.

mod cells;
mod inverse;
mod lattice;
mod mesh;

use crate::error::FieldError;
use crate::geometry::image_cells::ImageCells;
use crate::geometry::images::ImageLattice;
use crate::geometry::inputs::check_charges_in_box;
use crate::levels::far::{FarField, FarSolver};
use crate::methods::cutoff::{check_radius, coulomb};
use crate::methods::method::FieldMethod;
use crate::numerics::stopwatch::Stopwatch;
use crate::sum::{Levels, Part};
use crate::values::{FieldAt, Wanted};
use amberfield_core::{Domain, Permittivity};
use cells::{ChargeCells, SolverCells};
use mesh::Mesh;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Cells per cut-off radius when the scene leaves them open: just above √3, the diagonal of a cube.
const CELLS_PER_RADIUS: f64 = 1.75;
/// Cells at most; beyond it the cut-off radius is a mistake.
const MOST_CELLS: f64 = 2e8;

/// The hybrid of Kolehmainen, Ozel, Boyce and Sundaresan (2016): every charge goes to its cell, Poisson's
/// equation on the mesh gives a field constant in each cell, the plain sum over pairs within a cut-off
/// radius is added, and for those pairs that lie in different cells Coulomb's field between the cells'
/// centres is taken off again.
///
/// It does not converge: the mesh made its own field of each charge, not Coulomb's between centres. Its
/// error stays at 20 to 40 % for charges of both signs however large the radius. Walls have no images in
/// the near sum.
///
/// The mesh is that of the box: seven-point finite volumes, walls at cell faces, gradient by Gauss' theorem
/// with linear interpolation, and the faces' potentials and normal fields in its boundary conditions.
/// Beyond open faces the mesh goes on for ever. Components: pairs are near, the mesh far, the sum over
/// cells' centres correction. The potential holds the mesh's potential of the particle's own charge, one
/// cell wide.
#[derive(Debug)]
pub struct Kolehmainen {
    domain: Domain,
    lattice: ImageLattice,
    permittivity: Permittivity,
    neutralising_background: bool,
    radius: f64,
    mesh: Box<dyn ChargeCells>,
    images: ImageCells<InCell>,
    wrapped: Vec<Vector3<f64>>,
    cells: Vec<u32>,
    /// Pairs, the field of the cells and the correction at every particle.
    near: Vec<FieldAt>,
    far: Vec<FieldAt>,
    correction: Vec<FieldAt>,
    pairs_per_particle: f64,
    stopwatch: Stopwatch,
}

/// An image's cell, and by how many periods it is moved.
type InCell = (u32, [i32; 3]);

impl Kolehmainen {
    /// The hybrid with cut-off radius `radius_m` [m]; `cells` per axis, or cubes of nearly `radius_m`/1.75.
    ///
    /// # Errors
    /// A radius below the cells' diagonal, no cells or too many, one closed axis between open ones, values
    /// on faces of several axes beside open faces.
    pub fn new(
        domain: &Domain,
        permittivity: Permittivity,
        neutralising_background: bool,
        radius_m: f64,
        cells: Option<[usize; 3]>,
    ) -> Result<Self, FieldError> {
        check_radius(radius_m)?;
        let cells = choose_cells(domain, radius_m, cells)?;
        let mesh = Box::new(Mesh::new(domain, cells)?);
        Ok(Self::on(domain, permittivity, neutralising_background, radius_m, mesh))
    }

    /// The hybrid over a field solver's mesh, whose faces, gradient and mapping of charges are the solver's
    /// own.
    ///
    /// # Errors
    /// A radius below the diagonal of the largest cell, taken as a cube.
    pub fn over(
        solver: Box<dyn FarField>,
        permittivity: Permittivity,
        neutralising_background: bool,
        radius_m: f64,
    ) -> Result<Self, FieldError> {
        check_radius(radius_m)?;
        let diagonal = 3.0_f64.sqrt() * solver.mesh().largest_cell();
        if radius_m < diagonal * (1.0 - 1e-9) {
            return Err(FieldError::Settings(format!(
                "cut-off radius {radius_m:e} m is below the largest cell's diagonal {diagonal:e} m; raise \
                 electric_field.field_cutoff_radius or refine the mesh"
            )));
        }
        let domain = solver.mesh().domain().clone();
        let mesh = Box::new(SolverCells::new(solver, neutralising_background));
        Ok(Self::on(&domain, permittivity, neutralising_background, radius_m, mesh))
    }

    fn on(
        domain: &Domain,
        permittivity: Permittivity,
        neutralising_background: bool,
        radius: f64,
        mesh: Box<dyn ChargeCells>,
    ) -> Self {
        Self {
            domain: domain.clone(),
            lattice: ImageLattice::periodic_only(domain),
            permittivity,
            neutralising_background,
            radius,
            mesh,
            images: ImageCells::default(),
            wrapped: Vec::new(),
            cells: Vec::new(),
            near: Vec::new(),
            far: Vec::new(),
            correction: Vec::new(),
            pairs_per_particle: 0.0,
            stopwatch: Stopwatch::default(),
        }
    }

    /// Sums over pairs within the radius, and over the centres of their cells where these differ.
    fn sum_pairs(&mut self, charges: &[f64]) {
        let cells = &self.cells;
        self.images.build(&self.lattice, &self.wrapped, charges, self.radius, |index, image| {
            (cells[index], image.periods)
        });
        let (images, mesh, extent) = (&self.images, &self.mesh, self.domain.extent());
        let particles = self.wrapped.len();
        self.near.resize(particles, FieldAt::default());
        self.correction.resize(particles, FieldAt::default());
        let sums = self.near.par_iter_mut().zip(&mut self.correction);
        let places = self.wrapped.par_iter().zip(cells);
        let partners: usize = sums
            .zip(places)
            .enumerate()
            .map(|(index, ((near, correction), (at, &own)))| {
                let here = mesh.centre(own);
                let (mut of_pairs, mut of_centres, mut partners) =
                    (FieldAt::default(), FieldAt::default(), 0);
                images.for_each_partner(index, at, |k, d, _| {
                    partners += 1;
                    of_pairs += coulomb(images.charge[k], &d);
                    let (other, periods) = images.extra[k];
                    if (other, periods) != (own, [0; 3]) {
                        let moved = Vector3::from(periods.map(f64::from)).component_mul(&extent);
                        let d = here - mesh.centre(other) - moved;
                        of_centres -= coulomb(images.charge[k], &d);
                    }
                });
                (*near, *correction) = (of_pairs, of_centres);
                partners
            })
            .sum();
        self.pairs_per_particle = partners as f64 / particles.max(1) as f64;
    }

    /// Field and potential of every particle's cell.
    fn gather(&mut self) {
        let mesh = &self.mesh;
        self.far.resize(self.cells.len(), FieldAt::default());
        let all = self.far.par_iter_mut().zip(&self.cells);
        all.for_each(|(far, &cell)| *far = FieldAt { e: mesh.field(cell), potential: mesh.potential(cell) });
    }
}

impl FieldMethod for Kolehmainen {
    fn levels<'a>(
        &'a mut self,
        time_s: f64,
        positions: &'a [Vector3<f64>],
        charges: &'a [f64],
        _: Wanted,
    ) -> Result<Levels<'a>, FieldError> {
        let permittivity = self.permittivity;
        let background = self.neutralising_background;
        check_charges_in_box(&self.domain, permittivity, background, positions, charges)?;
        self.stopwatch.restart();
        self.wrapped.clear();
        self.wrapped.extend(positions.iter().map(|position| self.domain.wrap(*position)));
        self.mesh.solve(time_s, &self.wrapped, charges, permittivity, &mut self.cells)?;
        self.gather();
        self.stopwatch.lap("mesh");
        self.sum_pairs(charges);
        self.stopwatch.lap("pairs");
        Ok(Levels {
            coulomb: self.permittivity.coulomb(),
            near: Part::new(&self.near),
            far_of_cells: Part::new(&self.far),
            correction: Part::new(&self.correction),
            ..Levels::default()
        })
    }

    fn far_solver(&self) -> Option<&FarSolver> {
        self.mesh.solver()
    }

    fn far_solver_mut(&mut self) -> Option<&mut FarSolver> {
        self.mesh.solver_mut()
    }

    fn grid_cells(&self) -> Option<[usize; 3]> {
        self.mesh.counts()
    }

    fn pairs_per_particle(&self) -> f64 {
        self.pairs_per_particle
    }

    fn seconds(&self) -> &[(&'static str, f64)] {
        self.stopwatch.laps()
    }

    fn memory_bytes(&self) -> usize {
        self.mesh.memory_bytes()
            + self.images.memory_bytes()
            + self.wrapped.capacity() * size_of::<Vector3<f64>>()
            + self.cells.capacity() * size_of::<u32>()
            + (self.near.capacity() + self.far.capacity() + self.correction.capacity()) * size_of::<FieldAt>()
    }
}

/// Cells per axis, given or by the radius, whose diagonal is at most the radius.
fn choose_cells(domain: &Domain, radius: f64, cells: Option<[usize; 3]>) -> Result<[usize; 3], FieldError> {
    let extent = domain.extent();
    let wanted: [f64; 3] = match cells {
        Some(cells) => cells.map(|count| count as f64),
        None => std::array::from_fn(|axis| (CELLS_PER_RADIUS * extent[axis] / radius).ceil()),
    };
    let total: f64 = wanted.iter().product();
    if !(1.0..=MOST_CELLS).contains(&total) {
        return Err(FieldError::Settings(format!(
            "{} x {} x {} cells for a cut-off radius of {radius:e} m; give electric_field.grid.cells or a \
             radius that make between 1 and {MOST_CELLS:e} cells",
            wanted[0], wanted[1], wanted[2]
        )));
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and 2e8")]
    let cells = wanted.map(|count| count as usize);
    let diagonal = Vector3::from_fn(|axis, _| extent[axis] / wanted[axis]).norm();
    // A radius equal to the diagonal is allowed, to the last digit written.
    if radius < diagonal * (1.0 - 1e-9) {
        return Err(FieldError::Settings(format!(
            "cut-off radius {radius:e} m is below the largest cell diagonal {diagonal:e} m of {} x {} x {} \
             cells; raise electric_field.field_cutoff_radius or give more cells",
            cells[0], cells[1], cells[2]
        )));
    }
    Ok(cells)
}
