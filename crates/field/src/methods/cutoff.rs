//! The plain truncated sum: what most DEM runs use today.

use crate::error::FieldError;
use crate::geometry::image_cells::ImageCells;
use crate::geometry::images::ImageLattice;
use crate::geometry::inputs::check_finite;
use crate::methods::method::FieldMethod;
use crate::numerics::stopwatch::Stopwatch;
use crate::sum::{Levels, Part};
use crate::values::{FieldAt, Wanted};
use amberfield_core::{Domain, Permittivity};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Coulomb's sum over the charges and their periodic copies within a cut-off radius; walls have no images.
/// All of it is near.
///
/// Memory is kept: repeated evaluations of as many particles allocate nothing. Results do not depend on the
/// number of threads.
#[derive(Debug)]
pub struct Cutoff {
    domain: Domain,
    lattice: ImageLattice,
    permittivity: Permittivity,
    radius: f64,
    cells: ImageCells<()>,
    wrapped: Vec<Vector3<f64>>,
    /// Coulomb's sum at every particle.
    near: Vec<FieldAt>,
    pairs_per_particle: f64,
    stopwatch: Stopwatch,
}

impl Cutoff {
    /// The truncated sum with cut-off radius `radius_m` [m].
    ///
    /// # Errors
    /// A radius that is not positive and finite.
    pub fn new(domain: &Domain, permittivity: Permittivity, radius_m: f64) -> Result<Self, FieldError> {
        check_radius(radius_m)?;
        Ok(Self {
            domain: domain.clone(),
            lattice: ImageLattice::periodic_only(domain),
            permittivity,
            radius: radius_m,
            cells: ImageCells::default(),
            wrapped: Vec::new(),
            near: Vec::new(),
            pairs_per_particle: 0.0,
            stopwatch: Stopwatch::default(),
        })
    }
}

impl FieldMethod for Cutoff {
    fn levels<'a>(
        &'a mut self,
        _time_s: f64,
        positions: &'a [Vector3<f64>],
        charges: &'a [f64],
        _: Wanted,
    ) -> Result<Levels<'a>, FieldError> {
        check_finite(positions, charges)?;
        self.stopwatch.restart();
        self.wrapped.clear();
        self.wrapped.extend(positions.iter().map(|position| self.domain.wrap(*position)));
        self.cells.build(&self.lattice, &self.wrapped, charges, self.radius, |_, _| ());
        self.near.resize(positions.len(), FieldAt::default());
        let partners = sum_pairs(&self.cells, &self.wrapped, &mut self.near);
        self.pairs_per_particle = partners as f64 / positions.len().max(1) as f64;
        self.stopwatch.lap("near");
        let coulomb = self.permittivity.coulomb();
        Ok(Levels { coulomb, near: Part::new(&self.near), ..Levels::default() })
    }

    fn pairs_per_particle(&self) -> f64 {
        self.pairs_per_particle
    }

    fn seconds(&self) -> &[(&'static str, f64)] {
        self.stopwatch.laps()
    }

    fn memory_bytes(&self) -> usize {
        self.cells.memory_bytes()
            + self.wrapped.capacity() * size_of::<Vector3<f64>>()
            + self.near.capacity() * size_of::<FieldAt>()
    }
}

/// Refuses a cut-off radius that is not a length.
pub(crate) fn check_radius(radius_m: f64) -> Result<(), FieldError> {
    if radius_m.is_finite() && radius_m > 0.0 {
        return Ok(());
    }
    Err(FieldError::Settings(format!(
        "cut-off radius {radius_m} m; give electric_field.field_cutoff_radius a positive length"
    )))
}

/// Potential and field over k_e at distance `d` [m] from a charge.
pub(crate) fn coulomb(charge: f64, d: &Vector3<f64>) -> FieldAt {
    let inverse = 1.0 / d.norm();
    let potential = charge * inverse;
    FieldAt { e: d * (potential * inverse * inverse), potential }
}

/// Σ q/r and its field within the cells' radius at every particle, itself left out. Returns how many
/// partners all particles have together.
fn sum_pairs(cells: &ImageCells<()>, positions: &[Vector3<f64>], near: &mut [FieldAt]) -> usize {
    let all = near.par_iter_mut().zip(positions).enumerate();
    all.map(|(index, (near, at))| {
        let (mut total, mut partners) = (FieldAt::default(), 0);
        cells.for_each_partner(index, at, |k, d, _| {
            total += coulomb(cells.charge[k], &d);
            partners += 1;
        });
        *near = total;
        partners
    })
    .sum()
}
