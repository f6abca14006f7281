//! The far level of p3m on a field solver's mesh.
//!
//! The grains' clouds are as wide as the mesh can carry; pairs and the middle grid carry the rest, images
//! included, and reach the walls: what they make there is taken off the far level's boundary conditions,
//!
//! potential prescribed: φ_far = V − φ_short,  slope prescribed: ∂φ_far/∂n = ∂V/∂n + n·E_short,
//!
//! so that the sum keeps the case's own. Clouds are cut at the walls, not normalised anew.

use super::local_fit::LocalFits;
use super::{Condition, FarMesh};
use super::{FarField, FarRadii, FarRequest, FarSolver, check_net_charge};
use crate::error::FieldError;
use crate::levels::walls::{Ghosts, OfWalls, Outline, Place, Walls};
use crate::values::FieldAt;
use amberfield_core::{Axis, Boundary, Domain, FarQuestion, FieldSettings, Permittivity, SourceCloud};
use amberfield_laws::kaiser_bessel_cloud::Cloud;
use nalgebra::Vector3;
use rayon::prelude::*;

/// Radius of the clouds over the mesh's largest cell size, and their shape: a root mean square width of 2.7
/// cells.
const RADIUS_OF_CELL: f64 = 9.0;
const SHAPE: f64 = 10.0;

/// Factors of the clouds' radius and of the walls' depth in a second splitting, by which errors are measured.
const WIDER_FOR_A_CHECK: f64 = 1.5;
const DEEPER_FOR_A_CHECK: f64 = 1.4;

/// Charges whose images are found by one thread at once.
const REFLECTED_AT_ONCE: usize = 512;

/// State of a far level before a check.
#[derive(Debug)]
pub(crate) struct Before {
    radii: FarRadii,
    overlap: bool,
}

/// Medium in which the charges are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Medium {
    pub(crate) permittivity: Permittivity,
    /// Whether a charge that no face takes has an even background of the opposite sign.
    pub(crate) neutralising_background: bool,
}

impl Medium {
    pub(crate) fn of(settings: &FieldSettings) -> Self {
        let FieldSettings { permittivity, neutralising_background, .. } = *settings;
        Self { permittivity, neutralising_background }
    }
}

/// The far level's share of the field.
#[derive(Debug)]
pub(crate) struct FarLevel {
    solver: FarSolver,
    outline: Outline,
    walls: Walls,
    fits: LocalFits,
    cloud: Cloud,
    /// Factor of the ghosts' radii.
    of_ghosts: f64,
    medium: Medium,
    image_positions: Vec<Vector3<f64>>,
    image_charges: Vec<f64>,
    ghosts: Ghosts,
    /// Density of the ghosts' source in each cell [C/m³]; empty without ghosts.
    ghost_density: Vec<f64>,
    boundary: Vec<f64>,
    cells: Vec<u32>,
}

impl FarLevel {
    pub(crate) fn new(solver: Box<dyn FarField>, settings: &FieldSettings) -> Self {
        let mesh = solver.mesh();
        let size = mesh.largest_cell();
        let (fits, outline) = (LocalFits::new(mesh), Outline::new(mesh));
        Self {
            walls: Walls::new(mesh, &outline, 1.0, 1.0),
            outline,
            ghosts: Ghosts::new(fits.smoothing_over_size()),
            ghost_density: Vec::new(),
            fits,
            cloud: Cloud { radius: RADIUS_OF_CELL * size, shape: SHAPE },
            of_ghosts: 1.0,
            medium: Medium::of(settings),
            image_positions: Vec::new(),
            image_charges: Vec::new(),
            boundary: Vec::new(),
            cells: Vec::new(),
            solver: FarSolver::new(solver, settings.overlap),
        }
    }

    pub(crate) fn mesh(&self) -> &FarMesh {
        self.solver.mesh()
    }

    /// Medium in which the charges are.
    pub(crate) fn medium(&self) -> Medium {
        self.medium
    }

    /// Radii of the clouds and of the ghosts.
    pub(crate) fn radii(&self) -> FarRadii {
        FarRadii { cloud_m: self.cloud.radius, of_ghosts: self.of_ghosts }
    }

    /// Gives clouds and ghosts other radii.
    pub(crate) fn set_radii(&mut self, radii: FarRadii) {
        self.set_radii_with_edges(radii, radii.of_ghosts);
    }

    /// Gives clouds and ghosts other radii, and edges a reach of their own.
    fn set_radii_with_edges(&mut self, radii: FarRadii, of_edges: f64) {
        let FarRadii { cloud_m, of_ghosts } = radii;
        self.walls = Walls::new(self.solver.mesh(), &self.outline, of_ghosts, of_edges);
        (self.cloud.radius, self.of_ghosts) = (cloud_m, of_ghosts);
    }

    /// Changes what the sum must not depend on, and what the field solver knows of the motion.
    pub(crate) fn change_for_a_check(&mut self) -> Before {
        let before = Before { radii: self.radii(), overlap: self.solver.without_overlap() };
        // Edges that reach farther would cost more than they tell.
        self.set_radii_with_edges(before.radii.times(WIDER_FOR_A_CHECK), before.radii.of_ghosts);
        self.walls.scale_depth(DEEPER_FOR_A_CHECK);
        before
    }

    /// Takes the changes for a check back.
    pub(crate) fn change_back(&mut self, before: Before) {
        self.set_radii(before.radii);
        self.solver.with_overlap(before.overlap);
    }

    /// Field q_rms n^{2/3} of charges [C] that are spread over the mesh evenly, over Coulomb's constant
    /// [C/m²].
    pub(crate) fn field_of_spacing(&self, charges: &[f64]) -> f64 {
        let count = charges.len() as f64;
        let square = charges.iter().map(|charge| charge * charge).sum::<f64>() / count.max(1.0);
        let volume: f64 = self.mesh().volumes().iter().sum();
        square.sqrt() * (count / volume).powf(2.0 / 3.0)
    }

    /// The clouds as they come back: finite volumes and the fit widen them.
    pub(crate) fn cloud_as_returned(&self) -> Cloud {
        let widened = (1.0 + self.fits.smoothing() / self.cloud.mean_square()).max(0.0).sqrt();
        Cloud { radius: self.cloud.radius * widened, ..self.cloud }
    }

    /// Domain in which grains and images lie, open where the mesh ends.
    pub(crate) fn domain_of_pairs(&self) -> Domain {
        self.around(self.walls.deepest(), Boundary::Open)
    }

    /// The middle grid's periodic box: so large that no copy of a charge is felt along axes that are not
    /// periodic.
    pub(crate) fn domain_of_grid(&self) -> Domain {
        self.around(self.walls.deepest() + 0.5 * self.cloud_as_returned().radius, Boundary::Periodic)
    }

    /// Refuses a net charge that no face of its part of the mesh takes, after [`Self::locate`].
    pub(crate) fn check_net_charge(&self, charges: &[f64]) -> Result<(), FieldError> {
        let Medium { permittivity, neutralising_background } = self.medium;
        check_net_charge(self.mesh(), permittivity, neutralising_background, charges, &self.cells)
    }

    fn around(&self, margin: f64, face: Boundary) -> Domain {
        let domain = self.mesh().domain();
        let periodic = Axis::ALL.map(|axis| domain.is_periodic(axis));
        let margin = Vector3::from_fn(|axis, _| if periodic[axis] { 0.0 } else { margin });
        let faces = periodic.map(|periodic| [if periodic { Boundary::Periodic } else { face }; 2]);
        Domain::new(domain.min() - margin, domain.max() + margin, faces).expect("larger than a good domain")
    }

    /// Appends to the grains the places at the walls where the short-ranged field is asked for, without
    /// charge, and the images. How many places the field is asked for at, grains included.
    pub(crate) fn extend(&mut self, positions: &mut Vec<Vector3<f64>>, charges: &mut Vec<f64>) -> usize {
        let reflect =
            |(positions, charges): (&[Vector3<f64>], &[f64])| self.walls.of_charges(positions, charges);
        let pieces = positions.par_chunks(REFLECTED_AT_ONCE).zip(charges.par_chunks(REFLECTED_AT_ONCE));
        let of_walls: Vec<OfWalls> = pieces.map(reflect).collect();
        self.image_positions.clear();
        self.image_charges.clear();
        for piece in &of_walls {
            self.image_positions.extend(&piece.image_positions);
            self.image_charges.extend(&piece.image_charges);
        }
        let ghosts = of_walls.into_iter().flat_map(|piece| piece.ghosts);
        self.ghosts.replace(ghosts, self.solver.mesh().domain());
        positions.extend(self.walls.places().iter().map(|place| place.at));
        charges.resize(positions.len(), 0.0);
        let targets = positions.len();
        positions.extend(&self.image_positions);
        charges.extend(&self.image_charges);
        targets
    }

    /// Adds the ghosts' field, over Coulomb's constant, to the near field of the grains and, behind them, of
    /// the places at the walls.
    pub(crate) fn add_ghosts(&self, positions: &[Vector3<f64>], field: &mut [FieldAt]) {
        if self.ghosts.is_empty() {
            return;
        }
        let (at_grains, at_walls) = field.split_at_mut(positions.len());
        at_grains.par_iter_mut().zip(positions).for_each(|(field, position)| {
            *field += self.ghosts.field_at(&Place { at: *position, seen_from: *position });
        });
        at_walls.par_iter_mut().zip(self.walls.places()).for_each(|(field, place)| {
            *field += self.ghosts.field_at(place);
        });
    }

    /// Solves for the far potential of the grains at a time [s], with the short-ranged E [V/m] and
    /// potential [V] at the boundary's faces.
    pub(crate) fn solve(
        &mut self,
        time_s: f64,
        positions: &[Vector3<f64>],
        charges: &[f64],
        short: impl Iterator<Item = FieldAt>,
    ) -> Result<(), FieldError> {
        self.ghost_density.clear();
        if !self.ghosts.is_empty() {
            let of_cell =
                |centre: &Vector3<f64>| self.ghosts.density_at(&Place { at: *centre, seen_from: *centre });
            self.ghost_density.par_extend(self.solver.mesh().centres().par_iter().map(of_cell));
        }
        self.boundary.clear();
        self.boundary.extend(self.solver.mesh().boundary().iter().zip(short).map(|(face, short)| {
            match face.condition {
                Condition::Potential(volts) => volts - short.potential,
                Condition::Slope(slope) => slope + face.normal.dot(&short.e),
            }
        }));
        self.solver.add_changing(&mut self.boundary)?;
        let question = FarQuestion {
            cloud: SourceCloud { radius_m: self.cloud.radius, shape: self.cloud.shape },
            permittivity_f_m: self.medium.permittivity.absolute(),
            neutralising_background: u64::from(self.medium.neutralising_background),
            time_s,
            tolerance: 0.0,
            wants_e: 0,
        };
        let request = FarRequest {
            question,
            positions,
            charges,
            image_positions: &self.image_positions,
            image_charges: &self.image_charges,
            density: &self.ghost_density,
            boundary: &self.boundary,
            guess: &[],
        };
        self.solver.solve(&request)?;
        self.solver.forecast_changing(&mut self.boundary);
        let mesh = self.solver.mesh();
        self.fits.fit(mesh, self.solver.potential(), &self.boundary);
        Ok(())
    }

    /// The solver's state.
    pub(crate) fn solver(&self) -> &FarSolver {
        &self.solver
    }

    /// The solver's state, to start from another.
    pub(crate) fn solver_mut(&mut self) -> &mut FarSolver {
        &mut self.solver
    }

    /// E [V/m] and potential [V] at the grains, after [`Self::solve`].
    pub(crate) fn gather(&self, positions: &[Vector3<f64>], field: &mut [FieldAt]) {
        let mesh = self.solver.mesh();
        field.par_iter_mut().zip(positions).zip(&self.cells).for_each(|((field, position), &cell)| {
            *field = self.fits.across_faces_at(mesh, cell, position);
        });
    }

    /// Jumps of E between cells, which tell what the cells are too coarse for, at some of the grains, after
    /// [`Self::solve`] [V/m].
    pub(crate) fn jumps(&self, positions: &[Vector3<f64>], sample: &[usize]) -> Vec<Vector3<f64>> {
        let mesh = self.solver.mesh();
        let jump = |&grain: &usize| self.fits.jump_at(mesh, self.cells[grain], &positions[grain]);
        sample.iter().map(jump).collect()
    }

    /// Each grain's cell, by a walk from its last one; refuses grains outside the mesh.
    pub(crate) fn locate(&mut self, positions: &[Vector3<f64>]) -> Result<(), FieldError> {
        let mesh = self.solver.mesh();
        self.cells.resize(positions.len(), u32::MAX);
        self.cells.par_iter_mut().zip(positions).for_each(|(cell, position)| {
            let last = (*cell != u32::MAX).then_some(*cell);
            *cell = mesh.locate(position, last).0;
        });
        mesh.check_inside(positions, &self.cells)
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.fits.memory_bytes() + self.ghosts.memory_bytes() + 32 * self.image_charges.capacity()
    }
}
