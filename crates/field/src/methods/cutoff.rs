//! The plain truncated sum: what most DEM runs use today.

use crate::error::FieldError;
use crate::geometry::image_cells::ImageCells;
use crate::geometry::images::ImageLattice;
use crate::geometry::inputs::{check_finite, check_result};
use crate::methods::method::FieldMethod;
use crate::numerics::stopwatch::Stopwatch;
use crate::values::{FieldValues, Wanted};
use amberfield_core::{Domain, Permittivity};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Coulomb's sum over the charges and their periodic copies within a cut-off radius; walls have no images. All
/// of it is near.
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
    sums: Vec<CoulombSum>,
    pairs_per_particle: f64,
    stopwatch: Stopwatch,
}

/// Coulomb's sum over k_e at one particle.
#[derive(Clone, Copy, Debug, Default)]
struct CoulombSum {
    /// Potential [C/m].
    potential: f64,
    /// Field [C/m²].
    e: Vector3<f64>,
    /// Number of partners.
    partners: usize,
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
            sums: Vec::new(),
            pairs_per_particle: 0.0,
            stopwatch: Stopwatch::default(),
        })
    }
}

impl FieldMethod for Cutoff {
    fn evaluate_at(
        &mut self,
        _time_s: f64,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError> {
        check_finite(positions, charges)?;
        self.stopwatch.restart();
        self.wrapped.clear();
        self.wrapped.extend(positions.iter().map(|position| self.domain.wrap(*position)));
        self.cells.build(&self.lattice, &self.wrapped, charges, self.radius, |_, _| ());
        coulomb_sums(&self.cells, &self.wrapped, &mut self.sums);
        let k = self.permittivity.coulomb();
        out.clear();
        out.e.extend(self.sums.iter().map(|sum| sum.e * k));
        if wanted.potential {
            out.potential.extend(self.sums.iter().map(|sum| sum.potential * k));
        }
        if wanted.components {
            out.components.near.extend_from_slice(&out.e);
        }
        out.complete(positions.len(), wanted);
        let partners: usize = self.sums.iter().map(|sum| sum.partners).sum();
        self.pairs_per_particle = partners as f64 / self.sums.len().max(1) as f64;
        self.stopwatch.lap("near");
        check_result(&out.e)
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
            + self.sums.capacity() * size_of::<CoulombSum>()
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
pub(crate) fn coulomb(charge: f64, d: &Vector3<f64>) -> (f64, Vector3<f64>) {
    let inverse = 1.0 / d.norm();
    let potential = charge * inverse;
    (potential, d * (potential * inverse * inverse))
}

/// Σ q/r within the cells' radius at every particle, itself left out.
fn coulomb_sums(cells: &ImageCells<()>, positions: &[Vector3<f64>], sums: &mut Vec<CoulombSum>) {
    sums.resize(positions.len(), CoulombSum::default());
    sums.par_iter_mut().zip(positions).enumerate().for_each(|(index, (sum, at))| {
        let mut total = CoulombSum::default();
        cells.for_each_partner(index, at, |k, d, _| {
            let (potential, e) = coulomb(cells.charge[k], &d);
            total.potential += potential;
            total.e += e;
            total.partners += 1;
        });
        *sum = total;
    });
}
