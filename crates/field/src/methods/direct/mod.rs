//! The truth: every pair and every image, periodic sums by Ewald.

mod modes;
mod pairs;
mod splitting;

use crate::error::FieldError;
use crate::geometry::image_cells::ImageCells;
use crate::geometry::images::{BoundingBox, Geometry, ImageLattice};
use crate::geometry::inputs::{check_finite, check_inside, check_net_charge, check_result};
use crate::methods::method::FieldMethod;
use crate::numerics::stopwatch::Stopwatch;
use crate::values::{FieldValues, Wanted};
use amberfield_core::{Domain, Permittivity};
use modes::Modes;
use nalgebra::Vector3;
use splitting::Splitting;
use std::f64::consts::{FRAC_2_SQRT_PI, PI};

/// The direct sum of a box: E and potential at every particle with all images, exact to about 1e-12.
///
/// All axes open: the plain sum over charges and mirror images. Closed axes: Ewald's sum, the smooth part in the
/// real functions that obey each face, tinfoil for periodic boxes. Two closed axes and an open one: the same with
/// the open axis' Green function cut beyond what the particles see. Where the faces leave the potential free its
/// mean is 0, and a net charge, when allowed, is balanced by a uniform background. Fields of electrodes and of
/// normal fields on faces are not in it, see [`crate::BoundaryField`].
///
/// In a slab whose closed axes have no conductor the potential of a charged layer far from everything grows with
/// distance; it is taken as −2π σ|z| (σ charge per area), symmetric about the layer.
#[derive(Debug)]
pub struct Direct {
    domain: Domain,
    geometry: Geometry,
    lattice: ImageLattice,
    permittivity: Permittivity,
    neutralising_background: bool,
    cells: ImageCells<()>,
    wrapped: Vec<Vector3<f64>>,
    pairs_per_particle: f64,
    stopwatch: Stopwatch,
}

/// Two parts of the sum over k_e at one particle, and the number of partners.
struct Parts {
    potential: f64,
    near: Vector3<f64>,
    far: Vector3<f64>,
    partners: usize,
}

impl Direct {
    /// The direct sum of a box filled with a medium of the given relative permittivity.
    ///
    /// # Errors
    /// One closed axis between two open ones.
    pub fn new(
        domain: &Domain,
        permittivity: Permittivity,
        neutralising_background: bool,
    ) -> Result<Self, FieldError> {
        Ok(Self {
            domain: domain.clone(),
            geometry: Geometry::of(domain)?,
            lattice: ImageLattice::new(domain),
            permittivity,
            neutralising_background,
            cells: ImageCells::default(),
            wrapped: Vec::new(),
            pairs_per_particle: 0.0,
            stopwatch: Stopwatch::default(),
        })
    }

    fn sum(&mut self, positions: &[Vector3<f64>], charges: &[f64]) -> Result<Vec<Parts>, FieldError> {
        check_finite(positions, charges)?;
        check_inside(&self.domain, positions)?;
        check_net_charge(&self.domain, self.permittivity, self.neutralising_background, charges)?;
        self.stopwatch.restart();
        self.wrapped.clear();
        self.wrapped.extend(positions.iter().map(|position| self.domain.wrap(*position)));
        let Some(particles) = BoundingBox::around(&self.wrapped) else {
            return Ok(Vec::new());
        };
        if self.geometry == Geometry::Open {
            let sums = pairs::open(&self.lattice, &self.wrapped, charges);
            self.stopwatch.lap("pairs");
            return Ok(sums
                .into_iter()
                .map(|(potential, near, partners)| Parts { potential, near, far: Vector3::zeros(), partners })
                .collect());
        }
        let splitting = Splitting::cheapest(&self.domain, self.geometry, &particles, positions.len());
        Ok(self.ewald(charges, &splitting))
    }

    fn ewald(&mut self, charges: &[f64], splitting: &Splitting) -> Vec<Parts> {
        self.cells.build(&self.lattice, &self.wrapped, charges, splitting.radius, |_, _| ());
        let near = pairs::short_ranged(&self.cells, &self.wrapped, splitting.alpha);
        self.stopwatch.lap("pairs");
        let modes = Modes::new(splitting);
        let amplitudes = modes.amplitudes(&self.wrapped, charges);
        let far = modes.gather(&amplitudes, &self.wrapped);
        self.stopwatch.lap("modes");
        tracing::debug!(
            alpha_per_m = splitting.alpha,
            radius_m = splitting.radius,
            images = self.cells.len(),
            modes = modes.len(),
            "direct sum"
        );
        // The modes hold each charge's own cloud; and the pairs of a net charge have a mean that is not zero.
        let own = splitting.alpha * FRAC_2_SQRT_PI;
        let mean = if self.domain.needs_neutrality() {
            charges.iter().sum::<f64>() * PI / (splitting.alpha.powi(2) * self.domain.volume())
        } else {
            0.0
        };
        near.into_iter()
            .zip(far)
            .zip(charges)
            .map(|(((potential, near, partners), (far_potential, far)), charge)| Parts {
                potential: potential + far_potential - own * charge - mean,
                near,
                far,
                partners,
            })
            .collect()
    }
}

impl FieldMethod for Direct {
    fn evaluate_at(
        &mut self,
        _time_s: f64,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError> {
        let parts = self.sum(positions, charges)?;
        let k = self.permittivity.coulomb();
        out.clear();
        out.e.extend(parts.iter().map(|part| (part.near + part.far) * k));
        if wanted.potential {
            out.potential.extend(parts.iter().map(|part| part.potential * k));
        }
        if wanted.components {
            out.components.near.extend(parts.iter().map(|part| part.near * k));
            out.components.far.extend(parts.iter().map(|part| part.far * k));
        }
        out.complete(parts.len(), wanted);
        let partners: usize = parts.iter().map(|part| part.partners).sum();
        self.pairs_per_particle = partners as f64 / parts.len().max(1) as f64;
        check_result(&out.e)
    }

    fn pairs_per_particle(&self) -> f64 {
        self.pairs_per_particle
    }

    fn seconds(&self) -> &[(&'static str, f64)] {
        self.stopwatch.laps()
    }

    fn memory_bytes(&self) -> usize {
        self.cells.memory_bytes() + self.wrapped.capacity() * size_of::<Vector3<f64>>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use amberfield_core::Boundary;
    use proptest::prelude::*;

    /// Terms left out, over the largest term.
    const LEFT_OUT: f64 = 1e-12;

    fn axis_faces() -> impl Strategy<Value = [Boundary; 2]> {
        let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
        let faces = [Boundary::Grounded, insulating, Boundary::Open];
        let walls = (0..3_usize, 0..3_usize).prop_map(move |(low, high)| [faces[low], faces[high]]);
        prop_oneof![1 => Just([Boundary::Periodic; 2]), 2 => walls]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

        /// The sum is the same wherever it is split: images, modes and cut-offs fit together, in boxes of any shape.
        #[test]
        fn the_splitting_does_not_matter(
            faces in [axis_faces(), axis_faces(), axis_faces()],
            extent in [0.2..2.0_f64, 0.2..2.0_f64, 0.2..2.0_f64],
            places in prop::collection::vec(([0.02..0.98_f64, 0.02..0.98_f64, 0.02..0.98_f64], -1.0..1.0_f64), 1..8),
            factor in 0.6..1.6_f64,
        ) {
            let extent = Vector3::from(extent);
            let domain = Domain::new(Vector3::zeros(), extent, faces).unwrap();
            let geometry = Geometry::of(&domain);
            prop_assume!(matches!(geometry, Ok(Geometry::Closed | Geometry::Slab(_))));
            let mut direct = Direct::new(&domain, Permittivity::VACUUM, true).unwrap();
            let (positions, charges): (Vec<_>, Vec<_>) =
                places.into_iter().map(|(place, charge)| (Vector3::from(place).component_mul(&extent), charge)).unzip();
            direct.wrapped = positions;
            let particles = BoundingBox::around(&direct.wrapped).unwrap();
            let best = Splitting::cheapest(&domain, direct.geometry, &particles, charges.len());
            let other = Splitting::new(&domain, direct.geometry, &particles, best.alpha * factor);
            let (one, two) = (direct.ewald(&charges, &best), direct.ewald(&charges, &other));
            for (one, two) in one.iter().zip(&two) {
                let (e, potential) = (one.near + one.far, one.potential);
                let (field, value) = (one.near.norm() + two.near.norm() + 1.0, one.potential.abs() + 10.0 * best.alpha);
                prop_assert!((e - two.near - two.far).norm() < LEFT_OUT * field * best.alpha.powi(2).max(1.0));
                prop_assert!((potential - two.potential).abs() < LEFT_OUT * value);
            }
        }
    }
}
