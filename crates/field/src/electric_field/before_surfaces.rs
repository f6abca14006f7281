//! The field before conductors whose surfaces are triangles.

use super::ElectricField;
use crate::choosing::charge_statistics::ChargeStatistics;
use crate::choosing::choice::{Choice, Measured};
use crate::choosing::splittings::second_splitting;
use crate::choosing::trials::OneProcess;
use crate::choosing::tuner::Tuner;
use crate::error::FieldError;
use crate::geometry::images::{Geometry, images_per_charge};
use crate::levels::surfaces::Surfaces;
use crate::methods::direct::Direct;
use crate::methods::method::FieldMethod;
use crate::methods::over_surfaces::OverSurfaces;
use crate::methods::p3m::P3m;
use crate::values::{FieldValues, Wanted};
use amberfield_core::{Axis, Boundary, Conductor, Domain, FieldSettings, Method, Side};
use nalgebra::Vector3;

/// Share of the tolerance that the sum over charges gets; facets have the rest.
const OF_SUM: f64 = 0.5;

/// Most facets of a check by facets split in four: their matrix has 0.6 GB.
const MOST_FOR_A_CHECK: usize = 12_000;

/// Surfaces of a scene, and the box in which charges, images and the surfaces' own charges lie.
struct Before {
    surfaces: Surfaces,
    room: Domain,
}

impl Before {
    fn new(domain: &Domain, settings: &FieldSettings) -> Result<Self, FieldError> {
        let surfaces = Surfaces::new(&settings.conductors, domain, settings.permittivity.coulomb())?;
        let room = room(domain, &surfaces)?;
        Ok(Self { surfaces, room })
    }

    /// Parameters of p3m for grains and their images, and the error by its model.
    fn choose(
        &mut self,
        settings: &FieldSettings,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<(Choice, Option<f64>), FieldError> {
        self.surfaces.begin(positions, charges);
        let (of_images, charges_of_images) = self.surfaces.images();
        let positions = [positions, of_images].concat();
        let charges = [charges, charges_of_images].concat();
        let settings = &FieldSettings { tolerance: OF_SUM * settings.tolerance, ..settings.clone() };
        let grains = OneProcess { domain: &self.room, settings, positions: &positions, charges: &charges };
        let tuner = Tuner::new(&self.room, settings, grains.statistics(), &grains);
        let is_open = Geometry::of(&self.room) == Geometry::Open;
        if is_open && tuner.all_pairs_are_cheaper(images_per_charge(&self.room)) {
            return Ok((Choice::AllPairs, None));
        }
        let found = tuner.choose()?;
        Ok((Choice::P3m(found.parameters), found.estimated))
    }

    fn field(
        self,
        domain: &Domain,
        settings: &FieldSettings,
        choice: &Choice,
    ) -> Result<ElectricField, FieldError> {
        let background = settings.neutralising_background;
        let method: Box<dyn FieldMethod> = match choice {
            Choice::Direct | Choice::AllPairs => {
                Box::new(Direct::new(&self.room, settings.permittivity, background))
            }
            Choice::P3m(parameters) => Box::new(P3m::new(&self.room, settings, *parameters)),
            choice => {
                return Err(FieldError::Settings(format!(
                    "{choice} cannot be used with conductors; choose method p3m or direct"
                )));
            }
        };
        let method = OverSurfaces::new(method, self.surfaces, settings);
        ElectricField::with_method(domain, settings, choice, Box::new(method))
    }
}

impl ElectricField {
    /// Chooses parameters for grains before conductors, with the images that their surfaces make.
    pub(super) fn before_surfaces(
        domain: &Domain,
        settings: &FieldSettings,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Self, FieldError> {
        let mut before = Before::new(domain, settings)?;
        let (choice, estimated) = match settings.method {
            Method::Direct => (Choice::Direct, None),
            Method::P3m => before.choose(settings, positions, charges)?,
            method => {
                return Err(FieldError::Settings(format!(
                    "method {method} cannot be used with conductors; choose method p3m or direct"
                )));
            }
        };
        let mut field = before.field(domain, settings, &choice)?;
        field.error_estimated = estimated;
        if charges.iter().any(|charge| *charge != 0.0) {
            field.measure_before_surfaces(positions, charges)?;
        }
        Ok(field)
    }

    /// Builds a field before conductors with parameters chosen earlier.
    pub(super) fn before_surfaces_with_choice(
        domain: &Domain,
        settings: &FieldSettings,
        choice: &Choice,
    ) -> Result<Self, FieldError> {
        Before::new(domain, settings)?.field(domain, settings, choice)
    }

    /// Measures the error of E at all grains: by facets split in four, and by a second splitting of p3m.
    /// `None` where the split facets are too many.
    pub(super) fn measure_before_surfaces(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Option<Measured>, FieldError> {
        let split =
            |conductor: &Conductor| Conductor { surface: conductor.surface.split(), ..conductor.clone() };
        let conductors = self.settings.conductors.iter().map(split).collect();
        let finer = FieldSettings { conductors, ..self.settings.clone() };
        let facets: usize = finer.conductors.iter().map(|finer| finer.surface.triangles.len()).sum();
        if facets > MOST_FOR_A_CHECK {
            tracing::warn!(
                facets = facets / 4,
                most = MOST_FOR_A_CHECK / 4,
                "the conductors have too many facets for their error to be measured"
            );
            return Ok(None);
        }
        let choice = match &self.choice {
            Choice::P3m(parameters) => Choice::P3m(second_splitting(*parameters)),
            choice => choice.clone(),
        };
        let mut second = Before::new(&self.domain, &finer)?.field(&self.domain, &finer, &choice)?;
        let (mut here, mut there) = (FieldValues::default(), FieldValues::default());
        self.evaluate(positions, charges, Wanted::default(), &mut here)?;
        second.evaluate(positions, charges, Wanted::default(), &mut there)?;
        let mean = |sum: f64| (sum / positions.len().max(1) as f64).sqrt();
        let differences = here.e.iter().zip(&there.e).map(|(a, b)| (a - b).norm_squared());
        let field = mean(there.e.iter().map(Vector3::norm_squared).sum());
        let of_spacing =
            ChargeStatistics::new(&self.domain, self.settings.permittivity, positions, charges).floor;
        let relative_rms = mean(differences.sum()) / field.max(of_spacing).max(f64::MIN_POSITIVE);
        let measured = Measured { relative_rms, sample: positions.len() };
        if relative_rms > self.settings.tolerance {
            tracing::warn!(
                error = relative_rms,
                tolerance = self.settings.tolerance,
                "facets of the conductors are too large for the tolerance: split them, to 3 grain radii or \
                 less, and to one at edges and at sheets with grains on both sides"
            );
        }
        self.error_measured = Some(measured);
        Ok(Some(measured))
    }
}

/// The box, larger where open faces let images and surfaces reach beyond it.
fn room(domain: &Domain, surfaces: &Surfaces) -> Result<Domain, FieldError> {
    let [low, high] = surfaces.bounds();
    let margin = Vector3::repeat(surfaces.depth());
    let (mut min, mut max) = (domain.min(), domain.max());
    for axis in Axis::ALL {
        let k = axis.index();
        if domain.face(axis, Side::Min) == Boundary::Open {
            min[k] = min[k].min((low - margin)[k]);
        }
        if domain.face(axis, Side::Max) == Boundary::Open {
            max[k] = max[k].max((high + margin)[k]);
        }
    }
    Domain::new(min, max, *domain.faces()).map_err(|error| FieldError::Settings(error.to_string()))
}
