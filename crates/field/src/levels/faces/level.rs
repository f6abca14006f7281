//! The faces' part of a scene's field at every particle.

use super::BoundaryField;
use crate::error::FieldError;
use crate::values::FieldAt;
use amberfield_core::{Domain, FieldSettings, Method};
use nalgebra::Vector3;
use rayon::prelude::*;

/// Potentials and normal fields of the faces, at every particle.
#[derive(Debug)]
pub(crate) struct FacesLevel {
    /// `None` where the faces have no values, or the method holds them in boundary conditions of its own.
    field: Option<BoundaryField>,
    /// Domain whose faces have the potentials of the present time; `None` where they stay as they are.
    changing: Option<Domain>,
    values: Vec<FieldAt>,
}

impl FacesLevel {
    /// The faces of a scene.
    ///
    /// # Errors
    /// Geometries and normal fields that have no bounded solution.
    pub(crate) fn new(domain: &Domain, settings: &FieldSettings) -> Result<Self, FieldError> {
        /// The quadrature of the faces' field costs little: it takes no part of the tolerance worth naming.
        const SHARE: f64 = 1e-3;
        let field = match settings.method {
            // Its mesh has the faces' values in its own boundary conditions.
            Method::Kolehmainen => None,
            Method::P3m => BoundaryField::with_tolerance(domain, SHARE * settings.tolerance)?,
            _ => BoundaryField::new(domain)?,
        };
        let changes = field.is_some() && !domain.courses().is_empty();
        Ok(Self { field, changing: changes.then(|| domain.clone()), values: Vec::new() })
    }

    /// Takes the potentials of a time [s].
    pub(crate) fn set_time(&mut self, time_s: f64) {
        if let (Some(field), Some(domain)) = (&mut self.field, &mut self.changing) {
            domain.set_time(time_s);
            field.set_potentials(domain);
        }
    }

    /// Field that changes with time and is the same everywhere, if it is one.
    pub(crate) fn changing_uniform(&self) -> Option<&BoundaryField> {
        self.changing.as_ref().and(self.field.as_ref()).filter(|field| field.is_uniform())
    }

    /// E of a field that changes with time and is the same everywhere, at any time [s], in V/m; zero for
    /// other fields.
    pub(crate) fn changing_uniform_at(&self, time_s: f64) -> Vector3<f64> {
        match (&self.changing, self.changing_uniform()) {
            (Some(domain), Some(field)) => field.uniform_at(domain, time_s),
            _ => Vector3::zeros(),
        }
    }

    /// Domain whose potentials change and make a field that is not the same everywhere.
    pub(crate) fn changing_otherwise(&self) -> Option<&Domain> {
        self.changing.as_ref().filter(|_| self.changing_uniform().is_none())
    }

    /// E [V/m] and potential [V] at a place [m].
    pub(crate) fn at(&self, place: &Vector3<f64>) -> FieldAt {
        self.field.as_ref().map_or_else(FieldAt::default, |field| field.evaluate(place))
    }

    /// E [V/m] and potential [V] at positions [m]; empty where the faces add nothing.
    pub(crate) fn evaluate(&mut self, positions: &[Vector3<f64>]) -> &[FieldAt] {
        if let Some(field) = &self.field {
            self.values.resize(positions.len(), FieldAt::default());
            let all = self.values.par_iter_mut().zip(positions);
            all.for_each(|(value, position)| *value = field.evaluate(position));
        }
        &self.values
    }
}
