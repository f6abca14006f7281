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
        Ok(Self { field, values: Vec::new() })
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
