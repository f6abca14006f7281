//! `amberfield field`.

use crate::arguments::FieldOptions;
use crate::failure::Failure;
use crate::print;
use crate::run::{
    Charges, SolverConnections, SolverFolder, charges_of, connect_solver, domain_of, field_of, parameters,
    read_scene, scene_name,
};
use amberfield_core::{Method, Vector3};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_scene::{
    ElectricFieldSettings, FieldColumns, FieldComponents, FieldReport, FieldReportSeconds, Purpose, Scene,
    write_field_csv, write_json,
};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Computes the electric field at the particles of a scene.
pub(crate) fn field(options: &FieldOptions) -> Result<(), Failure> {
    let out = out_file(options)?;
    let folder = SolverFolder::beside(&out);
    let mut scene = read_scene(&options.scene, &overrides(options), Purpose::Field, &folder)?;
    for warning in &scene.warnings {
        tracing::warn!("{warning}");
    }
    let SolverConnections { field: solver, warnings, .. } = connect_solver(&mut scene, &folder)?;
    for warning in &warnings {
        tracing::warn!("{warning}");
    }
    let settings = scene.electric_field.as_ref().expect("the purpose needs it");
    let domain = domain_of(&scene)?;
    let Charges { index: indices, position: positions, charge: charges } = charges_of(&scene);
    let mut field = field_of(domain, &settings.field, solver, &positions, &charges)?;
    let wanted = Wanted { potential: true, components: options.components };
    let mut values = FieldValues::default();
    let mut seconds: BTreeMap<String, Vec<f64>> = BTreeMap::new();
    for _ in 0..options.repeat {
        let begun = Instant::now();
        field
            .evaluate(&positions, &charges, wanted, &mut values)
            .map_err(|error| Failure::of_field(&error))?;
        seconds.entry("total".to_owned()).or_default().push(begun.elapsed().as_secs_f64());
        for (stage, time) in field.statistics().seconds {
            seconds.entry(stage.to_owned()).or_default().push(time);
        }
    }
    let measured = match field.error_measured() {
        Some(measured) => Some(measured),
        None => field.measure_error(&positions, &charges).map_err(|error| Failure::of_field(&error))?,
    };
    let measured = measured.map(|measured| measured.relative_rms);
    write_values(&out, &scene, &indices, &values, options.components)?;
    let report = report(&field, settings, seconds, measured);
    write_json(&out.with_extension("json"), &report)?;
    summarise(&out, &report, scene.particles.len());
    match measured {
        Some(error) if settings.field.method == Method::P3m && error > settings.field.tolerance => {
            let advice = match field.far_solver() {
                Some(_) => "make the field solver's cells smaller or raise electric_field.tolerance",
                None => "ask for a smaller tolerance or set electric_field.tuning = \"timed\"",
            };
            Err(Failure::outside_tolerance(format!(
                "measured error {error:.2e} is above the tolerance {:e}; the results are written, but \
                 {advice}",
                settings.field.tolerance
            )))
        }
        _ => Ok(()),
    }
}

/// The result's name; one that is the report's name too would overwrite itself.
fn out_file(options: &FieldOptions) -> Result<PathBuf, Failure> {
    let out = options
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}-field.csv", scene_name(&options.scene))));
    if out.extension().is_some_and(|extension| extension == "json") {
        return Err(Failure::bad_input(format!(
            "--out {}: the report beside the result has this name; end it in .csv",
            out.display()
        )));
    }
    Ok(out)
}

/// `--method` and `--tolerance` are overrides like any other.
fn overrides(options: &FieldOptions) -> Vec<String> {
    let mut overrides = options.set.clone();
    overrides.extend(options.method.map(|method| format!("electric_field.method={method}")));
    overrides.extend(options.tolerance.map(|tolerance| format!("electric_field.tolerance={tolerance:?}")));
    overrides
}

/// Writes the field in the order of the input; grains outside the group feel none.
fn write_values(
    out: &Path,
    scene: &Scene,
    indices: &[usize],
    values: &FieldValues,
    components: bool,
) -> Result<(), Failure> {
    let count = scene.particles.len();
    let vectors = |members: &[Vector3<f64>]| {
        let mut all = vec![Vector3::zeros(); count];
        for (index, value) in indices.iter().zip(members) {
            all[*index] = *value;
        }
        all
    };
    let mut potential = vec![0.0; count];
    for (index, value) in indices.iter().zip(&values.potential) {
        potential[*index] = *value;
    }
    let e = vectors(&values.e);
    let parts = &values.components;
    let (near, middle, far) = (vectors(&parts.near), vectors(&parts.middle), vectors(&parts.far));
    let (correction, faces) = (vectors(&parts.correction), vectors(&parts.faces));
    let external = vectors(&parts.external);
    let parts = FieldComponents {
        near: &near,
        middle: &middle,
        far: &far,
        correction: &correction,
        faces: &faces,
        external: &external,
    };
    let columns = FieldColumns {
        id: &scene.particles.id,
        e: &e,
        potential: &potential,
        components: components.then_some(parts),
    };
    Ok(write_field_csv(out, &columns)?)
}

fn report(
    field: &ElectricField,
    settings: &ElectricFieldSettings,
    seconds: BTreeMap<String, Vec<f64>>,
    measured: Option<f64>,
) -> FieldReport {
    let statistics = field.statistics();
    let summary = |mut times: Vec<f64>| {
        times.sort_by(f64::total_cmp);
        let middle = times.len() / 2;
        let median =
            if times.len() % 2 == 1 { times[middle] } else { 0.5 * (times[middle - 1] + times[middle]) };
        FieldReportSeconds { min: times[0], median }
    };
    FieldReport {
        method: settings.field.method.name().to_owned(),
        parameters: parameters(field.choice()),
        seconds: seconds.into_iter().map(|(stage, times)| (stage, summary(times))).collect(),
        pairs_per_particle: statistics.pairs_per_particle,
        grid_cells: statistics.grid_cells,
        error_estimated: field.error_estimated(),
        error_measured: measured,
        threads: rayon::current_num_threads(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
    }
}

fn summarise(out: &Path, report: &FieldReport, count: usize) {
    let total = report.seconds.get("total").map_or(0.0, |seconds| seconds.median);
    let error = match (report.error_measured, report.error_estimated) {
        (Some(measured), _) => format!(", relative error {measured:.2e} measured"),
        (None, Some(estimated)) => format!(", relative error {estimated:.2e} estimated"),
        (None, None) => String::new(),
    };
    print::line(format_args!("{}: {count} grains in {total:.4} s{error}", report.method));
    print::line(format_args!("results: {}", out.display()));
}
