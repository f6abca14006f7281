//! Trials of p3m parameters on the grains of a scene; here all of them are in one process.

use crate::choosing::charge_statistics::ChargeStatistics;
use crate::choosing::splittings::sample_of;
use crate::error::FieldError;
use crate::methods::method::FieldMethod;
use crate::methods::p3m::P3m;
use crate::methods::p3m_parameters::P3mParameters;
use crate::values::{FieldValues, Wanted};
use amberfield_core::{Domain, FieldSettings};
use nalgebra::Vector3;
use std::time::Instant;

/// A time is the shortest of as many evaluations as this many particles need, three at most.
const TIMED_PARTICLES: usize = 200_000;
const MOST_EVALUATIONS: usize = 3;

/// Grains on which parameters are tried. What comes back is of all grains, wherever they are.
pub(crate) trait Trials {
    /// Sums over the grains of E² and of the square of the grid's part [V²/m²].
    fn squares(&self, parameters: P3mParameters) -> Result<[f64; 2], FieldError>;

    /// Sum of the squared differences of E between two splittings on a sample [V²/m²], and its size.
    fn difference(&self, first: P3mParameters, second: P3mParameters) -> Result<(f64, usize), FieldError>;

    /// Shortest of a few evaluations [s].
    fn seconds(&self, parameters: P3mParameters) -> Result<f64, FieldError>;

    /// Parameters that a model found, as all who look for them shall have them: where ranks share a field,
    /// processors may round differently.
    fn shared(&self, parameters: Option<P3mParameters>) -> Result<Option<P3mParameters>, FieldError> {
        Ok(parameters)
    }
}

/// The grains of a scene, all in this process.
pub(crate) struct OneProcess<'a> {
    pub(crate) domain: &'a Domain,
    pub(crate) settings: &'a FieldSettings,
    pub(crate) positions: &'a [Vector3<f64>],
    pub(crate) charges: &'a [f64],
}

impl OneProcess<'_> {
    /// Statistics of the grains.
    pub(crate) fn statistics(&self) -> ChargeStatistics {
        ChargeStatistics::new(self.domain, self.settings.permittivity, self.positions, self.charges)
    }
}

impl Trials for OneProcess<'_> {
    fn squares(&self, parameters: P3mParameters) -> Result<[f64; 2], FieldError> {
        let mut p3m = P3m::new(self.domain, self.settings, parameters);
        squares(&mut p3m, self.positions, self.charges)
    }

    fn difference(&self, first: P3mParameters, second: P3mParameters) -> Result<(f64, usize), FieldError> {
        let sample = sample_of(self.positions.len());
        let field = |parameters| {
            P3m::new(self.domain, self.settings, parameters).sample(self.positions, self.charges, &sample)
        };
        Ok((difference(&field(first), &field(second)), sample.len()))
    }

    fn seconds(&self, parameters: P3mParameters) -> Result<f64, FieldError> {
        let mut field = FieldValues::default();
        let mut p3m = P3m::new(self.domain, self.settings, parameters);
        let mut shortest = f64::INFINITY;
        for _ in 0..TIMED_PARTICLES.div_ceil(self.positions.len().max(1)).min(MOST_EVALUATIONS) {
            let start = Instant::now();
            p3m.evaluate(self.positions, self.charges, Wanted::default(), &mut field)?;
            shortest = shortest.min(start.elapsed().as_secs_f64());
        }
        Ok(shortest)
    }
}

/// Sums over the grains that a method is given of E² and of the square of the grid's part [V²/m²].
pub(crate) fn squares(
    method: &mut dyn FieldMethod,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<[f64; 2], FieldError> {
    let mut field = FieldValues::default();
    let wanted = Wanted { components: true, ..Wanted::default() };
    method.evaluate(positions, charges, wanted, &mut field)?;
    let sum = |e: &[Vector3<f64>]| e.iter().map(Vector3::norm_squared).sum();
    Ok([sum(&field.e), sum(&field.components.far)])
}

/// Sum of squared differences.
pub(crate) fn difference(first: &[Vector3<f64>], second: &[Vector3<f64>]) -> f64 {
    first.iter().zip(second).map(|(a, b)| (a - b).norm_squared()).sum()
}
