//! `amberfield tune`.

use crate::arguments::TuneOptions;
use crate::failure::Failure;
use crate::print::line;
use crate::run::{Charges, SolverFolder, charges_of, domain_of, read_scene, scene_name};
use amberfield_core::{Domain, FieldSettings, Method, Tuning, Vector3};
use amberfield_field::{Candidate, Choice, ElectricField, FieldError, FieldValues, Wanted};
use amberfield_oracle::{ErrorNorms, field_scale};
use amberfield_scene::{Purpose, files, write_rows};
use serde::Serialize;
use std::path::PathBuf;
use std::time::Instant;

/// Grains up to which the choice is compared with the direct sum rather than with a more exact splitting.
const DIRECT_UP_TO: usize = 5000;

/// Says what parameters a scene's field can have, and checks the choice.
pub(crate) fn tune(options: &TuneOptions) -> Result<(), Failure> {
    let mut set = options.set.clone();
    set.extend(options.tolerance.map(|tolerance| format!("electric_field.tolerance={tolerance:?}")));
    let scene = read_scene(&options.scene, &set, Purpose::Field, &SolverFolder::temporary()?)?;
    for warning in &scene.warnings {
        tracing::warn!("{warning}");
    }
    if scene.solver.is_some() {
        return Err(Failure::bad_input(
            "tune chooses parameters of the internal grid, and the scene has a [solver]; its parameters are \
             chosen when a run starts and stand in the run's summary.json",
        ));
    }
    let mut settings = scene.electric_field.as_ref().expect("the purpose needs it").field.clone();
    settings.tuning = Tuning::Timed;
    let domain = domain_of(&scene)?;
    let Charges { position: positions, charge: charges, .. } = charges_of(&scene);
    if charges.is_empty() {
        return Err(Failure::bad_input(
            "no grain takes part in the field: there is nothing to tune; add grains to [particles] or \
             change electric_field.particle_group",
        ));
    }
    let candidates = ElectricField::candidates(domain, &settings, &positions, &charges).map_err(failed)?;
    let mut field = ElectricField::new(domain, &settings, &positions, &charges).map_err(failed)?;
    line(format_args!("{} grains, tolerance {:e}", charges.len(), settings.tolerance));
    line(format_args!("{:<52} {:>9} {:>9} {:>10}", "parameters", "estimated", "measured", "seconds"));
    candidates.iter().for_each(|candidate| Row::new(candidate, false).print());
    let mut values = FieldValues::default();
    let begun = Instant::now();
    field.evaluate(&positions, &charges, Wanted::default(), &mut values).map_err(failed)?;
    let chosen = Candidate {
        choice: field.choice().clone(),
        estimated: field.error_estimated(),
        measured: field.error_measured(),
        seconds: begun.elapsed().as_secs_f64(),
    };
    line(format_args!("chosen:"));
    Row::new(&chosen, true).print();
    let out = options
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}-tune.csv", scene_name(&options.scene))));
    let all = candidates.iter().map(|candidate| Row::new(candidate, false));
    write_rows(&out, &files::TUNE, &all.chain([Row::new(&chosen, true)]).collect::<Vec<_>>())?;
    line(format_args!("results: {}", out.display()));
    let (error, by) = if charges.len() <= DIRECT_UP_TO {
        (against_direct(domain, &settings, (&positions, &charges), &values.e)?, "the direct sum")
    } else {
        let measured = field.measure_error(&positions, &charges).map_err(failed)?;
        (measured.map(|measured| measured.relative_rms), "a more exact splitting on a sample")
    };
    let Some(error) = error else {
        line(format_args!("check: none, no grain is charged"));
        return Ok(());
    };
    line(format_args!("check: relative error {error:.2e} against {by}"));
    if error > settings.tolerance {
        return Err(Failure::outside_tolerance(format!(
            "the choice has a relative error of {error:.2e} against {by}, above the tolerance {:e}; please \
             report it with the scene",
            settings.tolerance
        )));
    }
    Ok(())
}

fn failed(error: FieldError) -> Failure {
    Failure::of_field(&error)
}

/// Relative RMS difference from the direct sum; `None` while no grain is charged.
fn against_direct(
    domain: &Domain,
    settings: &FieldSettings,
    (positions, charges): (&[Vector3<f64>], &[f64]),
    e: &[Vector3<f64>],
) -> Result<Option<f64>, Failure> {
    if charges.iter().all(|charge| *charge == 0.0) {
        return Ok(None);
    }
    let settings = FieldSettings { method: Method::Direct, ..settings.clone() };
    let mut exact = FieldValues::default();
    let mut direct = ElectricField::new(domain, &settings, positions, charges).map_err(failed)?;
    direct.evaluate(positions, charges, Wanted::default(), &mut exact).map_err(failed)?;
    let scale = field_scale(&exact.e, charges, domain.volume(), settings.permittivity.coulomb());
    Ok(Some(ErrorNorms::new(e, &exact.e, scale).relative_rms))
}

/// A line of the table.
#[derive(Debug, Serialize)]
struct Row {
    chosen: bool,
    levels: &'static str,
    order: Option<usize>,
    cutoff_m: Option<f64>,
    spacing_m: Option<f64>,
    cloud_shape: Option<f64>,
    window_shape: Option<f64>,
    error_estimated: Option<f64>,
    error_measured: Option<f64>,
    seconds: f64,
}

impl Row {
    fn new(candidate: &Candidate, chosen: bool) -> Self {
        let parameters = match &candidate.choice {
            Choice::P3m(parameters) => Some(parameters),
            _ => None,
        };
        Self {
            chosen,
            levels: if parameters.is_some() { "near and grid" } else { "all pairs" },
            order: parameters.map(|p| p.order),
            cutoff_m: parameters.map(|p| p.cutoff_m),
            spacing_m: parameters.map(|p| p.spacing_m),
            cloud_shape: parameters.map(|p| p.cloud_shape),
            window_shape: parameters.map(|p| p.window_shape),
            error_estimated: candidate.estimated,
            error_measured: candidate.measured.map(|measured| measured.relative_rms),
            seconds: candidate.seconds,
        }
    }

    fn print(&self) {
        let error = |error: Option<f64>| error.map_or_else(|| "–".to_owned(), |error| format!("{error:.2e}"));
        let parameters = match (self.cutoff_m, self.spacing_m, self.order) {
            (Some(cutoff), Some(spacing), Some(order)) => {
                format!("cut-off {cutoff:.3e} m, nodes {spacing:.3e} m, order {order}")
            }
            _ => self.levels.to_owned(),
        };
        line(format_args!(
            "{parameters:<52} {:>9} {:>9} {:>10.3e}",
            error(self.error_estimated),
            error(self.error_measured),
            self.seconds
        ));
    }
}
