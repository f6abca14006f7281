//! Parameters of p3m over a field solver's mesh: how wide the far level's clouds are, and what near level and
//! middle grid need below them.
//!
//! Clouds of 9 cells suit grains that are about as close as the cells are wide. Where grains are farther
//! apart, what the mesh adds to each grain's own field, some share of q/(4πεh²), is large beside the fields
//! of the others, and clouds must be wider. How wide is found by measuring: the sum does not depend on the
//! clouds, and wider ones err less. The whole sum is looked at, over the mesh that is used.

use crate::choosing::choice::Measured;
use crate::choosing::splittings::{sample_of, second_splitting};
use crate::choosing::trials::OneProcess;
use crate::choosing::tuner::{Chosen, Tuner};
use crate::error::FieldError;
use crate::levels::far::{FarField, FarLevel, FarRadii};
use crate::methods::method::{FieldMethod, TwoSplittings};
use crate::methods::p3m::P3m;
use crate::methods::p3m_parameters::P3mParameters;
use amberfield_core::FieldSettings;
use nalgebra::Vector3;

/// Share of the tolerance that the measured error may reach.
const ACCEPT: f64 = 0.8;
/// Rounds at most, and factor from one round's clouds to the next.
const ROUNDS: usize = 8;
const WIDER: f64 = 1.7;
/// Share of the error below which wider clouds have to bring it to be worth another round.
const WORTH: f64 = 0.85;
/// Radius of the clouds over the mesh's extent beyond which nothing changes.
const WIDEST: f64 = 1.5;
/// Share of the error that near level and middle grid may have before they are made better, and the factor of
/// their tolerance then.
const OF_SHORT: f64 = 0.5;
const TIGHTER: f64 = 0.4;
/// Smallest factor of their tolerance that near level and middle grid begin with where grains are few: they
/// cost little beside the cells then, and a model of many charges knows little of what they leave.
const FEW: f64 = 0.15;
/// Factor of the ghosts' radii at least where grains are many in a cell: what cells miss of each then
/// averages out, and the ghosts' pairs are as many as their square.
const LEAST_OF_GHOSTS: f64 = 0.5;
/// Factor by which wider clouds widen the ghosts at most.
const MOST_OF_GHOSTS: f64 = 2.0;
/// Share of the jumps of E between cells that counts as an error: what cells are too coarse for, all
/// splittings miss alike. From boxes with known fields, see `crates/coupling/tests/stated_error.rs`.
const OF_JUMPS: f64 = 0.6;

/// A field over a mesh, with its errors.
pub(crate) struct OverMesh {
    pub(crate) p3m: P3m,
    pub(crate) parameters: P3mParameters,
    /// Error of near level and middle grid by the model.
    pub(crate) estimated: Option<f64>,
    /// Error of the whole sum; `None` while no grain is charged.
    pub(crate) measured: Option<Measured>,
}

/// Chooses parameters for particles (positions in m, charges in C).
pub(crate) fn choose(
    solver: Box<dyn FarField>,
    settings: &FieldSettings,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<OverMesh, FieldError> {
    let mut far = FarLevel::new(solver, settings);
    let wrapped: Vec<_> = positions.iter().map(|position| far.mesh().domain().wrap(*position)).collect();
    let widest = WIDEST * far.mesh().domain().extent().max();
    let grains_per_cell = positions.len() as f64 / far.mesh().cell_count() as f64;
    let of_ghosts = grains_per_cell.max(1.0).powf(-1.0 / 3.0).max(LEAST_OF_GHOSTS);
    far.set_radii(FarRadii { of_ghosts, ..far.radii() });
    let mut tolerance = settings.tolerance * grains_per_cell.sqrt().clamp(FEW, 1.0);
    let mut best: Option<Round> = None;
    let mut failed = 0;
    for _ in 0..ROUNDS {
        let aim = FieldSettings { tolerance, ..settings.clone() };
        let chosen = tune(&far, &aim, &wrapped, charges)?;
        let parameters = P3mParameters { far: Some(far.radii()), ..chosen.parameters };
        let mut p3m = P3m::over(far, parameters);
        let Some(error) = measure(&mut p3m, parameters, positions, charges)? else {
            return Ok(OverMesh { p3m, parameters, estimated: chosen.estimated, measured: None });
        };
        tracing::debug!(?parameters, ?error, "p3m over a mesh");
        far = p3m.into_far().expect("built over it");
        let before = best.as_ref().map_or(f64::INFINITY, |best| best.error.rms);
        failed = if error.rms < WORTH * before { 0 } else { failed + 1 };
        if error.rms < before {
            best = Some(Round { error, parameters, estimated: chosen.estimated });
        }
        let radii = far.radii();
        let wider = WIDER.min(widest / radii.cloud_m);
        if error.rms <= ACCEPT * settings.tolerance * error.scale || failed == 2 {
            break;
        }
        // Whatever seems to leave more; where that has brought nothing, the other.
        let of_short = chosen.error_v_m.unwrap_or(0.0) > OF_SHORT * error.rms;
        if (of_short != (failed == 1)) || wider <= 1.0 {
            tolerance *= TIGHTER;
        } else {
            let radii = radii.times(wider);
            far.set_radii(FarRadii { of_ghosts: radii.of_ghosts.min(MOST_OF_GHOSTS * of_ghosts), ..radii });
        }
    }
    let Round { error, parameters, estimated } = best.expect("one round at least");
    let stated = error.rms / error.scale;
    if stated > settings.tolerance {
        tracing::warn!(
            "the field solver's mesh gives E to {stated:.1e}, not to the tolerance {:e}; smaller cells, \
             above all at walls and where charges are, make it better",
            settings.tolerance
        );
    }
    far.set_radii(parameters.far.expect("a round has radii"));
    let p3m = P3m::over(far, parameters);
    Ok(OverMesh { p3m, parameters, estimated, measured: Some(error.relative(positions.len())) })
}

/// Parameters that were tried, with their errors.
struct Round {
    error: OnMesh,
    parameters: P3mParameters,
    estimated: Option<f64>,
}

/// Parameters of near level and middle grid below a far level.
fn tune(
    far: &FarLevel,
    settings: &FieldSettings,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<Chosen, FieldError> {
    // They are those of a periodic box as large as the middle grid's; no face of it takes charge.
    let domain = far.domain_of_grid();
    let alone = FieldSettings { neutralising_background: true, ..settings.clone() };
    // Beyond the far level's clouds there is nothing for pairs to do.
    let longest = far.cloud_as_returned().radius;
    if let Some(cutoff) = settings.cutoff_radius_m.filter(|cutoff| *cutoff > longest) {
        return Err(FieldError::Settings(format!(
            "field_cutoff_radius {cutoff:e} m is larger than the {longest:e} m from which on the field \
             solver's mesh takes over; make it smaller or leave it out"
        )));
    }
    let grains = OneProcess { domain: &domain, settings: &alone, positions, charges };
    Tuner::new(&domain, &alone, grains.statistics(), &grains).up_to(longest).choose()
}

/// Measures the error of the whole sum on a sample; `None` where no grain is charged, and for a field without
/// a far level that answers at once.
pub(crate) fn measure(
    method: &mut dyn FieldMethod,
    parameters: P3mParameters,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<Option<OnMesh>, FieldError> {
    if charges.iter().all(|charge| *charge == 0.0) {
        return Ok(None);
    }
    let sample = sample_of(positions.len());
    let second = second_splitting(parameters);
    let Some(TwoSplittings { first, second, jumps, scale }) =
        method.by_two_splittings(second, positions, charges, &sample)?
    else {
        return Ok(None);
    };
    let sum: f64 = first.iter().zip(&second).map(|(a, b)| (a - b).norm_squared()).sum();
    let of_jumps: f64 = jumps.iter().map(Vector3::norm_squared).sum();
    let rms = ((sum + OF_JUMPS * OF_JUMPS * of_jumps) / sample.len().max(1) as f64).sqrt();
    Ok(Some(OnMesh { rms, scale }))
}

/// Error on a mesh, and what it is relative to [V/m].
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnMesh {
    rms: f64,
    scale: f64,
}

impl OnMesh {
    /// The error over its scale, from a sample of so many particles.
    pub(crate) fn relative(self, particles: usize) -> Measured {
        Measured { relative_rms: self.rms / self.scale, sample: sample_of(particles).len() }
    }
}
