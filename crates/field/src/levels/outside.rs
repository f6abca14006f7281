//! What there is without charges.

use crate::error::FieldError;
use crate::levels::faces::BoundaryField;
use amberfield_core::{Domain, FieldSettings, Method};
use nalgebra::Vector3;
use rayon::prelude::*;

/// The field that is there without any charge: of the faces, and external.
#[derive(Debug)]
pub(crate) struct Outside {
    boundary: Option<BoundaryField>,
    external: Vector3<f64>,
    centre: Vector3<f64>,
    values: Vec<(Vector3<f64>, f64)>,
}

impl Outside {
    /// `None` where there is nothing to add.
    pub(crate) fn new(domain: &Domain, settings: &FieldSettings) -> Result<Option<Self>, FieldError> {
        /// The quadrature of the faces' field costs little: it takes no part of the tolerance worth naming.
        const SHARE: f64 = 1e-3;
        let boundary = match settings.method {
            // Its mesh has the faces' values in its own boundary conditions.
            Method::Kolehmainen => None,
            Method::P3m => BoundaryField::with_tolerance(domain, SHARE * settings.tolerance)?,
            _ => BoundaryField::new(domain)?,
        };
        let external = settings.external_field_v_m;
        let nothing = boundary.is_none() && external == Vector3::zeros();
        let outside = Self { boundary, external, centre: domain.centre(), values: Vec::new() };
        Ok((!nothing).then_some(outside))
    }

    /// E = boundary + external, V = boundary − E_external·(x − centre).
    pub(crate) fn evaluate(&mut self, positions: &[Vector3<f64>]) -> &[(Vector3<f64>, f64)] {
        self.values.resize(positions.len(), (Vector3::zeros(), 0.0));
        self.values.par_iter_mut().zip(positions).for_each(|(value, position)| {
            let (e, potential) = match &self.boundary {
                Some(boundary) => boundary.evaluate(position),
                None => (Vector3::zeros(), 0.0),
            };
            *value = (e + self.external, potential - self.external.dot(&(position - self.centre)));
        });
        &self.values
    }
}
