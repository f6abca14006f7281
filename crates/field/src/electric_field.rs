//! The evaluator: one scene's field, with the parameters chosen for it.

use crate::{FieldError, FieldValues, Wanted};
use amberfield_core::{Domain, FieldSettings, Method, Plan};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Parameters chosen for a scene. Written to the run folder and reused on resume, so that results never
/// depend on a stopwatch.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Choice {
    /// Method.
    pub method: Method,
}

/// Error found by comparing with a more exact evaluation on a sample of grains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// RMS error of E over the scale the tolerance refers to.
    pub relative_rms: f64,
    /// Grains in the sample.
    pub sample: usize,
}

/// Cost of the last evaluation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Mean number of partners within the cut-off per particle (images included, full list).
    pub pairs_per_particle: f64,
    /// Cells of the internal grid per axis; `None` when no grid was built.
    pub grid_cells: Option<[usize; 3]>,
    /// Stage name and seconds, in the order in which they ran.
    pub seconds: Vec<(&'static str, f64)>,
}

/// The field of one scene.
#[derive(Debug)]
pub struct ElectricField {
    choice: Choice,
}

impl ElectricField {
    /// Chooses parameters for the given particles and builds what they need.
    ///
    /// # Errors
    /// Settings that the method or the boundaries do not allow, a net charge without a field, values that are
    /// not finite, a tolerance that cannot be met.
    pub fn new(
        domain: &Domain,
        settings: &FieldSettings,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Self, FieldError> {
        let _ = (domain, settings, positions, charges);
        Ok(Self { choice: Choice { method: settings.method } })
    }

    /// Builds a field with parameters chosen earlier.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with_choice(
        domain: &Domain,
        settings: &FieldSettings,
        choice: &Choice,
    ) -> Result<Self, FieldError> {
        let _ = (domain, settings);
        Ok(Self { choice: choice.clone() })
    }

    /// E (and what else is wanted) at every particle. Allocates nothing once `out` has its size and the
    /// particles' number is unchanged.
    ///
    /// # Errors
    /// Values that are not finite; net charge that no longer vanishes where it must.
    pub fn evaluate(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
        wanted: Wanted,
        out: &mut FieldValues,
    ) -> Result<(), FieldError> {
        let _ = (charges, wanted);
        out.e.clear();
        out.e.resize(positions.len(), Vector3::zeros());
        Ok(())
    }

    /// Measures the error of E on a sample by an independent, more exact splitting; `None` for methods that
    /// make no promise (`cutoff`, `kolehmainen`) and for `direct`.
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    pub fn measure_error(
        &mut self,
        positions: &[Vector3<f64>],
        charges: &[f64],
    ) -> Result<Option<Measured>, FieldError> {
        let _ = (positions, charges);
        Ok(None)
    }

    /// Parameters in force.
    #[must_use]
    pub fn choice(&self) -> &Choice {
        &self.choice
    }

    /// A-priori estimate of the relative RMS error; `None` for methods that make no promise.
    #[must_use]
    pub fn error_estimated(&self) -> Option<f64> {
        None
    }

    /// Cost of the last evaluation.
    #[must_use]
    pub fn statistics(&self) -> Statistics {
        Statistics::default()
    }

    /// Memory held [bytes].
    #[must_use]
    pub fn memory_bytes(&self) -> usize {
        0
    }

    /// Which field stages are built and which are not, with reasons.
    #[must_use]
    pub fn plan(&self) -> Plan {
        Plan::new()
    }
}
