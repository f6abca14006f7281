//! The truth: every pair and every image, periodic sums by Ewald.

mod modes;
mod pairs;
mod splitting;

use crate::error::FieldError;
use crate::geometry::image_cells::ImageCells;
use crate::geometry::images::{BoundingBox, Geometry, ImageLattice};
use crate::geometry::inputs::{ChargeSums, check_finite, check_inside, check_net_charge};
use crate::methods::method::FieldMethod;
use crate::numerics::stopwatch::Stopwatch;
use crate::sum::{Levels, OwnClouds, Part};
use crate::values::{FieldAt, Wanted};
use amberfield_core::{Domain, Permittivity};
use modes::Modes;
use nalgebra::Vector3;
use pairs::PairSum;
use splitting::Splitting;
use std::f64::consts::{FRAC_2_SQRT_PI, PI};

/// The direct sum of a box: E and potential at every particle with all images, exact to about 1e-12.
///
/// All axes open: the plain sum over charges and mirror images. Closed axes: Ewald's sum, the smooth part
/// in the real functions that obey each face, tinfoil for periodic boxes. Two closed axes and an open one:
/// the same with the open axis' Green function cut beyond what the particles see. One closed axis between
/// two open ones: the same, cut at a cylinder about the closed axis. Where the faces leave the
/// potential free its mean is 0, and a net charge, when allowed, is balanced by a uniform background.
/// Fields of electrodes and of normal fields on faces are not in it, see [`crate::BoundaryField`].
///
/// In a slab whose closed axes have no conductor the potential of a charged layer far from everything grows
/// with distance; it is taken as −2π σ|z| (σ charge per area), symmetric about the layer. Around a closed
/// axis of length L without a conductor it is −2 λ ln(ρ/L) (λ charge per length, ρ distance from it).
#[derive(Debug)]
pub struct Direct {
    domain: Domain,
    geometry: Geometry,
    lattice: ImageLattice,
    permittivity: Permittivity,
    neutralising_background: bool,
    cells: ImageCells<()>,
    wrapped: Vec<Vector3<f64>>,
    parts: Parts,
    pairs_per_particle: f64,
    stopwatch: Stopwatch,
}

/// Parts of the sum, over Coulomb's constant.
#[derive(Debug, Default)]
struct Parts {
    near: Vec<FieldAt>,
    far: Vec<FieldAt>,
    /// Potential of a unit charge's own cloud at its centre [1/m].
    own_cloud: f64,
    /// Mean potential of the pairs of a net charge [C/m].
    background: f64,
    /// Partners of all particles together.
    partners: usize,
}

impl Parts {
    fn of_pairs(sums: Vec<PairSum>) -> Self {
        Self {
            partners: sums.iter().map(|sum| sum.partners).sum(),
            near: sums.into_iter().map(|sum| sum.field).collect(),
            ..Self::default()
        }
    }
}

impl Direct {
    /// The direct sum of a box filled with a medium of the given relative permittivity.
    #[must_use]
    pub fn new(domain: &Domain, permittivity: Permittivity, neutralising_background: bool) -> Self {
        Self {
            domain: domain.clone(),
            geometry: Geometry::of(domain),
            lattice: ImageLattice::new(domain),
            permittivity,
            neutralising_background,
            cells: ImageCells::default(),
            wrapped: Vec::new(),
            parts: Parts::default(),
            pairs_per_particle: 0.0,
            stopwatch: Stopwatch::default(),
        }
    }

    fn sum(&mut self, positions: &[Vector3<f64>], charges: &[f64]) -> Result<Parts, FieldError> {
        check_finite(positions, charges)?;
        check_inside(&self.domain, positions)?;
        let sums = ChargeSums::of(charges);
        check_net_charge(&self.domain, self.permittivity, self.neutralising_background, sums)?;
        self.stopwatch.restart();
        self.wrapped.clear();
        self.wrapped.extend(positions.iter().map(|position| self.domain.wrap(*position)));
        let Some(particles) = BoundingBox::around(&self.wrapped) else {
            return Ok(Parts::default());
        };
        if self.geometry == Geometry::Open {
            let sums = pairs::open(&self.lattice, &self.wrapped, charges);
            self.stopwatch.lap("pairs");
            return Ok(Parts::of_pairs(sums));
        }
        let splitting = Splitting::cheapest(&self.domain, self.geometry, &particles, positions.len());
        Ok(self.ewald(charges, &splitting))
    }

    fn ewald(&mut self, charges: &[f64], splitting: &Splitting) -> Parts {
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
        let background = if self.domain.needs_neutrality() {
            charges.iter().sum::<f64>() * PI / (splitting.alpha.powi(2) * self.domain.volume())
        } else {
            0.0
        };
        Parts { far, own_cloud: splitting.alpha * FRAC_2_SQRT_PI, background, ..Parts::of_pairs(near) }
    }
}

impl FieldMethod for Direct {
    fn levels<'a>(
        &'a mut self,
        _time_s: f64,
        positions: &'a [Vector3<f64>],
        charges: &'a [f64],
        _: Wanted,
    ) -> Result<Levels<'a>, FieldError> {
        self.parts = self.sum(positions, charges)?;
        self.pairs_per_particle = self.parts.partners as f64 / positions.len().max(1) as f64;
        Ok(Levels {
            coulomb: self.permittivity.coulomb(),
            near: Part::new(&self.parts.near),
            far_of_charges: Part::new(&self.parts.far),
            own_clouds: OwnClouds { charges, at_centre: self.parts.own_cloud },
            background: self.parts.background,
            ..Levels::default()
        })
    }

    fn pairs_per_particle(&self) -> f64 {
        self.pairs_per_particle
    }

    fn seconds(&self) -> &[(&'static str, f64)] {
        self.stopwatch.laps()
    }

    fn memory_bytes(&self) -> usize {
        let parts = self.parts.near.capacity() + self.parts.far.capacity();
        self.cells.memory_bytes()
            + self.wrapped.capacity() * size_of::<Vector3<f64>>()
            + parts * size_of::<FieldAt>()
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
        #![proptest_config(ProptestConfig {
            cases: 64,
            failure_persistence: None,
            ..ProptestConfig::default()
        })]

        /// The sum is the same wherever it is split: images, modes and cut-offs fit together, in boxes of
        /// any shape.
        #[test]
        fn the_splitting_does_not_matter(
            faces in [axis_faces(), axis_faces(), axis_faces()],
            extent in [0.2..2.0_f64, 0.2..2.0_f64, 0.2..2.0_f64],
            places in prop::collection::vec(
                ([0.02..0.98_f64, 0.02..0.98_f64, 0.02..0.98_f64], -1.0..1.0_f64),
                1..8,
            ),
            factor in 0.6..1.6_f64,
        ) {
            let extent = Vector3::from(extent);
            let domain = Domain::new(Vector3::zeros(), extent, faces).unwrap();
            prop_assume!(Geometry::of(&domain) != Geometry::Open);
            let mut direct = Direct::new(&domain, Permittivity::VACUUM, true);
            let (positions, charges): (Vec<_>, Vec<_>) =
                places
                    .into_iter()
                    .map(|(place, charge)| (Vector3::from(place).component_mul(&extent), charge))
                    .unzip();
            direct.wrapped = positions;
            let particles = BoundingBox::around(&direct.wrapped).unwrap();
            let best = Splitting::cheapest(&domain, direct.geometry, &particles, charges.len());
            let other = Splitting::new(&domain, direct.geometry, &particles, best.alpha * factor);
            let (one, two) = (direct.ewald(&charges, &best), direct.ewald(&charges, &other));
            for (particle, charge) in charges.iter().enumerate() {
                let potential = |parts: &Parts| {
                    parts.near[particle].potential + parts.far[particle].potential
                        - parts.own_cloud * charge
                        - parts.background
                };
                let near = [one.near[particle].e, two.near[particle].e];
                let far = [one.far[particle].e, two.far[particle].e];
                let (field, value) =
                    (near[0].norm() + near[1].norm() + 1.0, potential(&one).abs() + 10.0 * best.alpha);
                let difference = (near[0] + far[0]) - near[1] - far[1];
                prop_assert!(difference.norm() < LEFT_OUT * field * best.alpha.powi(2).max(1.0));
                prop_assert!((potential(&one) - potential(&two)).abs() < LEFT_OUT * value);
            }
        }
    }
}
