//! Charges before conductors whose surfaces are triangles: images, and points with the surfaces' charge, join
//! the grains in a method that knows nothing of them.

use crate::error::FieldError;
use crate::levels::surfaces::Surfaces;
use crate::methods::method::{FieldMethod, UnitPotential};
use crate::numerics::stopwatch::Stopwatch;
use crate::sum::{Levels, OwnClouds, Part, Sum};
use crate::values::{FieldAt, Wanted};
use amberfield_core::FieldSettings;
use nalgebra::Vector3;

/// Looks at the equation in one evaluation, at most.
const MOST_LOOKS: usize = 20;
/// Field that is missing on the surfaces over the tolerance at which an evaluation ends.
const ENOUGH: f64 = 0.3;

/// A method with surfaces before its charges.
#[derive(Debug)]
pub(crate) struct OverSurfaces {
    method: Box<dyn FieldMethod>,
    surfaces: Surfaces,
    tolerance: f64,
    /// Potential of electrodes and of the external field at the facets [V].
    given: Vec<f64>,
    /// Grains, centroids without charge, images, points.
    positions: Vec<Vector3<f64>>,
    charges: Vec<f64>,
    parts: Parts,
    /// Coulomb's constant of the medium [V m/C].
    coulomb: f64,
    stopwatch: Stopwatch,
}

/// Copies of what the method found at the grains.
#[derive(Debug, Default)]
struct Parts {
    near: Vec<FieldAt>,
    far: Vec<FieldAt>,
}

impl OverSurfaces {
    /// Puts surfaces before a method, which has room for images beyond them.
    pub(crate) fn new(method: Box<dyn FieldMethod>, surfaces: Surfaces, settings: &FieldSettings) -> Self {
        let given = vec![0.0; surfaces.centres().len()];
        Self {
            method,
            given,
            surfaces,
            tolerance: settings.tolerance,
            positions: Vec::new(),
            charges: Vec::new(),
            parts: Parts::default(),
            coulomb: settings.permittivity.coulomb(),
            stopwatch: Stopwatch::default(),
        }
    }

    /// Lays grains, centroids, images and points side by side.
    fn load(&mut self, positions: &[Vector3<f64>], charges: &[f64]) {
        self.positions.clear();
        self.positions.extend_from_slice(positions);
        self.positions.extend(self.surfaces.centres());
        self.charges.clear();
        self.charges.extend_from_slice(charges);
        self.charges.resize(self.positions.len(), 0.0);
        let (places, charges) = self.surfaces.images();
        self.positions.extend_from_slice(places);
        self.charges.extend_from_slice(charges);
        let (places, charges) = self.surfaces.points();
        self.positions.extend_from_slice(places);
        self.charges.extend_from_slice(charges);
    }

    /// Evaluates the field of all charges at the grains, and what the surfaces' density is off by.
    fn look(&mut self, time_s: f64, positions: &[Vector3<f64>], charges: &[f64]) -> Result<Look, FieldError> {
        self.load(positions, charges);
        let wanted = Wanted { potential: true, ..Wanted::default() };
        let levels = self.method.levels(time_s, &self.positions, &self.charges, wanted)?;
        let sum = Sum::of_charges(levels, &self.positions);
        let (grains, facets) = (positions.len(), self.given.len());
        let per_volt = 1.0 / self.coulomb;
        let potential: Vec<f64> = (0..facets)
            .map(|facet| per_volt * (sum.at(grains + facet).potential + self.given[facet]))
            .collect();
        let mut squares = 0.0;
        for (grain, charge) in charges.iter().enumerate() {
            squares += if *charge == 0.0 { 0.0 } else { sum.at(grain).e.norm_squared() };
        }
        self.parts.near.clear();
        self.parts.near.extend((0..grains).map(|grain| levels.near.at(grain)));
        self.parts.far.clear();
        let far =
            |grain| levels.middle.at(grain) + levels.far_of_charges.at(grain) + levels.correction.at(grain);
        self.parts.far.extend((0..grains).map(far));
        let (at_centre, background) = (levels.own_clouds.at_centre, levels.background);
        let charged = charges.iter().filter(|charge| **charge != 0.0).count().max(1);
        let scale = per_volt * (squares / charged as f64).sqrt();
        let missing = self.surfaces.correct(&potential);
        let missing = if missing == 0.0 { 0.0 } else { missing / scale.max(self.surfaces.least_scale()) };
        Ok(Look { at_centre, background, missing })
    }
}

/// Numbers that a look at the equation leaves.
struct Look {
    /// Potentials that the method's levels have beside the fields at places.
    at_centre: f64,
    background: f64,
    /// Field that is missing on the surfaces, over the scale of E.
    missing: f64,
}

impl FieldMethod for OverSurfaces {
    fn levels<'a>(
        &'a mut self,
        time_s: f64,
        positions: &'a [Vector3<f64>],
        charges: &'a [f64],
        _wanted: Wanted,
    ) -> Result<Levels<'a>, FieldError> {
        self.stopwatch.restart();
        self.surfaces.begin(positions, charges);
        self.stopwatch.lap("images");
        let mut look = self.look(time_s, positions, charges)?;
        let mut looks = 1;
        while look.missing > ENOUGH * self.tolerance && looks < MOST_LOOKS {
            self.surfaces.look_again();
            look = self.look(time_s, positions, charges)?;
            looks += 1;
        }
        tracing::debug!(looks, missing = look.missing, "surfaces");
        self.stopwatch.lap("surfaces");
        Ok(Levels {
            coulomb: self.coulomb,
            near: Part::new(&self.parts.near),
            far_of_charges: Part::new(&self.parts.far),
            own_clouds: OwnClouds { charges, at_centre: look.at_centre },
            background: look.background,
            ..Levels::default()
        })
    }

    fn potentials_of_conductors(&self) -> Vec<f64> {
        self.surfaces.potentials().iter().map(|potential| self.coulomb * potential).collect()
    }

    fn unit_potential(
        &mut self,
        conductor: usize,
        positions: &[Vector3<f64>],
    ) -> Result<UnitPotential, FieldError> {
        let volts = self.potentials_of_conductors();
        let nothing = vec![0.0; self.given.len()];
        let given = std::mem::replace(&mut self.given, nothing);
        self.surfaces.hold(conductor, self.coulomb);
        let uncharged = vec![0.0; positions.len()];
        let wanted = Wanted { potential: true, ..Wanted::default() };
        let at = self.levels(0.0, positions, &uncharged, wanted).map(|levels| {
            let sum = Sum::of_charges(levels, positions);
            (0..positions.len()).map(|place| sum.at(place)).collect()
        });
        self.surfaces.release();
        self.given = given;
        Ok(UnitPotential { at: at?, of_given: self.surfaces.charge_by(&volts, &self.given) })
    }

    fn give_potentials(&mut self, given: &dyn Fn(&Vector3<f64>) -> f64) {
        self.given.clear();
        self.given.extend(self.surfaces.centres().map(|centre| given(&centre)));
    }

    fn pairs_per_particle(&self) -> f64 {
        self.method.pairs_per_particle()
    }

    fn grid_cells(&self) -> Option<[usize; 3]> {
        self.method.grid_cells()
    }

    fn seconds(&self) -> &[(&'static str, f64)] {
        self.stopwatch.laps()
    }

    fn memory_bytes(&self) -> usize {
        self.method.memory_bytes() + self.surfaces.memory_bytes() + 32 * self.positions.capacity()
    }
}
