//! The sum: the one place where the parts of the field are added.
//!
//! E = near + middle + far + correction + faces + external
//!
//! A method gives the first four, which come from charges; faces and external need no charge. A part that a
//! scene or a method does not have is zero everywhere. The potential is the same sum, less the self term
//! and the background.

use crate::levels::external::ExternalField;
use crate::values::{FieldAt, FieldValues, Wanted};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Particles that one task adds up at least: fewer are not worth another thread.
const TASK: usize = 4096;

/// One part of the field at every particle; the zero field where it is absent.
#[derive(Clone, Copy, Debug, Default)]
pub struct Part<'a>(&'a [FieldAt]);

impl<'a> Part<'a> {
    /// A part by particle. There may be more places behind the particles.
    #[must_use]
    pub fn new(by_particle: &'a [FieldAt]) -> Self {
        Self(by_particle)
    }

    /// The part at a particle.
    #[inline]
    pub(crate) fn at(self, particle: usize) -> FieldAt {
        self.0.get(particle).copied().unwrap_or_default()
    }
}

/// The clouds of the particles themselves, which a smooth level holds; zero where no level does.
#[derive(Clone, Copy, Debug, Default)]
pub struct OwnClouds<'a> {
    /// Charges [C].
    pub charges: &'a [f64],
    /// Potential at the centre of a unit charge's cloud, over Coulomb's constant [1/m].
    pub at_centre: f64,
}

impl OwnClouds<'_> {
    /// A particle's own cloud at its own place.
    #[inline]
    fn at(&self, particle: usize) -> FieldAt {
        let charge = self.charges.get(particle).copied().unwrap_or_default();
        FieldAt::of_potential(charge * self.at_centre)
    }
}

/// Parts of the field that come from charges, as a method leaves them at every particle.
#[derive(Clone, Copy, Debug, Default)]
pub struct Levels<'a> {
    /// Coulomb's constant of the medium [V m/C].
    pub coulomb: f64,
    /// Pairs, and their images, within the cut-off radius; over Coulomb's constant.
    pub near: Part<'a>,
    /// Middle grid, between the pairs and a field solver's mesh; over Coulomb's constant.
    pub middle: Part<'a>,
    /// Far level that is a sum over charges, on the internal grid or in modes; over Coulomb's constant.
    pub far_of_charges: Part<'a>,
    /// Far level that cells of a mesh carry, with boundary conditions of their own [V/m and V].
    pub far_of_cells: Part<'a>,
    /// Pairs that both near and far count, taken off again; over Coulomb's constant.
    pub correction: Part<'a>,
    /// The particles' own clouds.
    pub own_clouds: OwnClouds<'a>,
    /// Mean potential of the pairs of a net charge, over Coulomb's constant [C/m].
    pub background: f64,
}

/// Every part of the field at the particles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sum<'a> {
    /// Levels that a method made of the charges.
    pub(crate) levels: Levels<'a>,
    /// Potentials and normal fields of the faces.
    pub(crate) faces: Part<'a>,
    /// The uniform external field.
    pub(crate) external: ExternalField,
    /// Positions of the particles [m].
    pub(crate) positions: &'a [Vector3<f64>],
}

impl<'a> Sum<'a> {
    /// The charges' part alone, at particles at these positions [m].
    pub(crate) fn of_charges(levels: Levels<'a>, positions: &'a [Vector3<f64>]) -> Self {
        Self { levels, faces: Part::default(), external: ExternalField::default(), positions }
    }

    /// The field at a particle:
    ///
    /// E = near + middle + far + correction + faces + external
    #[inline]
    pub(crate) fn at(&self, particle: usize) -> FieldAt {
        let levels = &self.levels;
        let near = levels.near.at(particle);
        let middle = levels.middle.at(particle);
        let far_of_charges = levels.far_of_charges.at(particle);
        let far_of_cells = levels.far_of_cells.at(particle);
        let correction = levels.correction.at(particle);
        let faces = self.faces.at(particle);
        let external = self.external.at(&self.positions[particle]);

        // Self term: grid and modes hold the cloud of the particle itself, which is no part of the field
        // that acts on it. A cloud has no field at its own centre, but a potential.
        let own_cloud = levels.own_clouds.at(particle);
        // Neutralising background: where no face fixes the potential its mean is zero, but that of a net
        // charge's pairs is not. It is the same everywhere, so that E does not see it.
        let background = FieldAt::of_potential(levels.background);

        // Sums over charges come without Coulomb's constant; it multiplies them once, when they are added.
        #[rustfmt::skip]
        let of_charges =
              near
            + middle
            + far_of_charges
            + correction
            - own_cloud
            - background;
        #[rustfmt::skip]
        let sum =
              levels.coulomb * of_charges
            + far_of_cells
            + (faces + external);
        sum
    }

    /// Writes what is wanted at every particle; what is not wanted becomes empty. Memory is kept.
    pub(crate) fn write(&self, wanted: Wanted, out: &mut FieldValues) {
        let particles = self.positions.len();
        let components = if wanted.components { particles } else { 0 };
        let Levels { coulomb, near, middle, far_of_charges, far_of_cells, correction, .. } = self.levels;

        if wanted.potential {
            let both = |particle| {
                let sum = self.at(particle);
                (sum.e, sum.potential)
            };
            numbers(particles).map(both).unzip_into_vecs(&mut out.e, &mut out.potential);
        } else {
            fill(&mut out.e, particles, |particle| self.at(particle).e);
            out.potential.clear();
        }

        let parts = &mut out.components;
        fill(&mut parts.near, components, |particle| coulomb * near.at(particle).e);
        fill(&mut parts.middle, components, |particle| coulomb * middle.at(particle).e);
        fill(&mut parts.far, components, |particle| {
            coulomb * far_of_charges.at(particle).e + far_of_cells.at(particle).e
        });
        fill(&mut parts.correction, components, |particle| coulomb * correction.at(particle).e);
        fill(&mut parts.faces, components, |particle| self.faces.at(particle).e);
        fill(&mut parts.external, components, |particle| self.external.at(&self.positions[particle]).e);
    }
}

/// Gives `values` this many values, each by its number; memory is kept, and not written twice.
fn fill<T: Send>(values: &mut Vec<T>, count: usize, value: impl Fn(usize) -> T + Sync + Send) {
    numbers(count).map(value).collect_into_vec(values);
}

/// Numbers of particles, in tasks.
fn numbers(count: usize) -> impl IndexedParallelIterator<Item = usize> {
    (0..count).into_par_iter().with_min_len(TASK)
}
