//! What p3m can choose from for a scene, for people who want to look.

use crate::choosing::tuner::Tuner;
use crate::electric_field::{check, images};
use crate::geometry::images::Geometry;
use crate::geometry::inputs::check_finite;
use crate::{Choice, ElectricField, FieldError, FieldValues, Measured, Wanted};
use amberfield_core::{Domain, FieldSettings, Method};
use nalgebra::Vector3;
use std::time::Instant;

/// Parameters that can be chosen for a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// The parameters.
    pub choice: Choice,
    /// Relative error by the a-priori model; `None` for sums that are exact and while no grain is charged.
    pub estimated: Option<f64>,
    /// Relative error found on a sample; `None` likewise.
    pub measured: Option<Measured>,
    /// Shortest of a few evaluations [s].
    pub seconds: f64,
}

impl ElectricField {
    /// What p3m can choose from for the given particles (positions in m, charges in C): the best of each window's order by the cost model, cheapest
    /// first, and the sum over all pairs where few charges in open space make that worth a look; each with its errors and its time.
    ///
    /// # Errors
    /// As [`Self::new`]; a method without parameters to choose.
    pub fn candidates(
        domain: &Domain,
        settings: &FieldSettings,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Vec<Candidate>, FieldError> {
        check_finite(positions, charges)?;
        if settings.method != Method::P3m {
            return Err(FieldError::Settings(format!(
                "method {} has no parameters to choose; set electric_field.method = \"p3m\"",
                settings.method
            )));
        }
        check(domain, settings, positions, charges)?;
        let tuner = Tuner::new(domain, settings, positions, charges);
        let open = Geometry::of(domain)? == Geometry::Open;
        let mut candidates = tuner.table()?;
        if open && tuner.all_pairs_are_cheaper(images(domain)) {
            let (choice, mut values) = (Choice::AllPairs, FieldValues::default());
            let mut field = Self::with_choice(domain, settings, &choice)?;
            let start = Instant::now();
            field.evaluate(positions, charges, Wanted::default(), &mut values)?;
            let seconds = start.elapsed().as_secs_f64();
            candidates.push(Candidate { choice, estimated: None, measured: None, seconds });
        }
        Ok(candidates)
    }
}
