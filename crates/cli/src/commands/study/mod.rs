//! `amberfield study`.

mod extremes;
mod motion;

use crate::arguments::StudyOptions;
use crate::failure::Failure;
use crate::machine;
use crate::print::line;
use crate::run::{
    Charges, SolverFolder, charges_of, connect_solver, domain_of, field_of, parameters, read_scene,
};
use amberfield_core::{Boundary, Domain, FieldSettings, Method, Tuning, Vector3};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_oracle::field_scale;
use amberfield_scene::{Purpose, Scene, files};
use amberfield_study::peers::{PeerProblem, measure_field};
use amberfield_study::sweep::{
    self, Endured, Evaluation, Exact, Extreme, GroundedBox, Laboratory, Moved, Peer, Provenance, Results,
    Row, Study,
};
use amberfield_study::{Store, StudyError, today};
use serde::de::DeserializeOwned;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Tolerance of the p3m that is the truth for many grains.
const TRUTH: f64 = 1e-8;

/// Runs a study and writes its rows, plots and page.
pub(crate) fn study(options: &StudyOptions) -> Result<(), Failure> {
    let study = Study::read(&options.study).map_err(|error| Failure::of_study(&error))?;
    let out = options.out.clone().unwrap_or_else(|| PathBuf::from(format!("{}-study", study.name)));
    let store = Store::new(out.clone()).map_err(|error| Failure::of_study(&error))?;
    let results = if options.page {
        let newest_of = |kind: &str| format!("{}{kind}", study.name);
        Results {
            points: newest(&store, &newest_of(""))?,
            motions: newest(&store, &newest_of("-motions"))?,
            extremes: newest(&store, &newest_of("-extremes"))?,
            energies: newest(&store, &newest_of("-energies"))?,
        }
    } else {
        measured(options, &study, &store)?
    };
    let repeat = format!("amberfield study {}", options.study.display());
    let page =
        sweep::write_report(&out, &study, &results, &repeat).map_err(|error| Failure::of_study(&error))?;
    let Results { points, motions, extremes, .. } = &results;
    line(format_args!(
        "{} points, {} runs, {} extremes; page: {}",
        points.len(),
        motions.len(),
        extremes.len(),
        page.display()
    ));
    let broken: Vec<_> = points.iter().filter(|row| row.breaks_its_bound()).map(told).collect();
    if let Some(first) = broken.first() {
        return Err(Failure::outside_tolerance(format!(
            "{} of {} points have an error above their bound; the first: {first}",
            broken.len(),
            points.len(),
        )));
    }
    let broken: Vec<_> = extremes.iter().filter(|row| !row.broken.is_empty()).collect();
    match broken.first() {
        None => Ok(()),
        Some(first) => Err(Failure::outside_tolerance(format!(
            "{} of {} extremes are not as expected; the first: {} {}: {}",
            broken.len(),
            extremes.len(),
            first.extreme,
            first.value,
            first.broken
        ))),
    }
}

/// Measures all; what is known is on the disk, should the rest never come.
fn measured(options: &StudyOptions, study: &Study, store: &Store) -> Result<Results, Failure> {
    let folder = options.study.parent().unwrap_or_else(|| Path::new(""));
    let name_of = |kind: &str| format!("{}{kind}", study.name);
    let failed = |error: StudyError| Failure::of_study(&error);
    let mut known = Results::default();
    let mut unwritten = Ok(());
    sweep::run(study, folder, &mut OurMethods, |rows| {
        for row in rows {
            tracing::info!("{}", told(row));
        }
        known.points.extend_from_slice(rows);
        unwritten = store.save_as(&name_of(""), &files::POINTS, &known.points);
    });
    unwritten.map_err(failed)?;
    let mut unwritten = Ok(());
    sweep::run_motions(study, folder, &mut OurMethods, |row| {
        let seconds = row.seconds.unwrap_or(f64::NAN);
        tracing::info!("{}, {} {}: {seconds:.2} s", row.problem, row.method, row.value);
        known.motions.push(row.clone());
        unwritten = store.save_as(&name_of("-motions"), &files::MOTIONS, &known.motions);
    });
    unwritten.map_err(failed)?;
    let mut unwritten = Ok(());
    sweep::run_extremes(study, folder, &mut OurMethods, |row, energies| {
        let verdict = if row.broken.is_empty() { "as expected" } else { &row.broken };
        tracing::info!("{} {}: {}, {verdict}", row.extreme, row.value, row.ended);
        known.extremes.push(row.clone());
        known.energies.extend_from_slice(energies);
        unwritten = store
            .save_as(&name_of("-extremes"), &files::EXTREMES, &known.extremes)
            .and_then(|()| store.save_as(&name_of("-energies"), &files::ENERGIES, &known.energies));
    });
    unwritten.map_err(failed)?;
    Ok(known)
}

/// The newest rows of a name; none where there is no such file.
fn newest<R: DeserializeOwned>(store: &Store, name: &str) -> Result<Vec<R>, Failure> {
    let known = store.newest(name).map_err(|error| Failure::of_study(&error))?;
    Ok(known.map_or_else(Vec::new, |(_, rows)| rows))
}

/// A point in a line.
fn told(row: &Row) -> String {
    let name = format!("{}, {} {}", row.problem, row.method, row.value);
    match (row.error, row.ns_per_grain()) {
        (Some(error), Some(ns)) => format!("{name}: error {error:.2e}, {ns:.0} ns a grain"),
        _ => format!("{name}: {}", row.failure),
    }
}

/// Our own methods.
struct OurMethods;

/// A scene's charges.
struct Charged {
    scene: Scene,
    settings: FieldSettings,
    positions: Vec<Vector3<f64>>,
    charges: Vec<f64>,
    /// Folder of its field solver.
    folder: SolverFolder,
}

/// A field and its results.
struct Built {
    field: ElectricField,
    values: FieldValues,
}

impl Laboratory for OurMethods {
    type Problem = Charged;
    type Method = Built;

    fn provenance(&self) -> Provenance {
        Provenance {
            processor: machine::cpu_name().unwrap_or_else(|| "a processor without a name".to_owned()),
            threads: rayon::current_num_threads(),
            version: format!("{}{}", env!("CARGO_PKG_VERSION"), commit()),
            date: today(),
        }
    }

    fn problem(&mut self, scene: &Path, set: &[String]) -> Result<Charged, String> {
        let said = |failure: Failure| failure.message().to_owned();
        let folder = SolverFolder::temporary().map_err(said)?;
        let scene = read_scene(scene, set, Purpose::Field, &folder).map_err(said)?;
        let settings = scene.electric_field.as_ref().expect("the purpose needs it").field.clone();
        let Charges { position: positions, charge: charges, .. } = charges_of(&scene);
        if positions.is_empty() {
            return Err("no grain takes part in the field".to_owned());
        }
        Ok(Charged { settings, positions, charges, scene, folder })
    }

    fn grains(&self, problem: &Charged) -> usize {
        problem.charges.len()
    }

    fn exact(&mut self, problem: &Charged, direct_up_to: usize) -> Result<Exact, String> {
        let Charged { positions, charges, settings, scene, .. } = problem;
        let domain =
            scene.domain.as_ref().ok_or("the scene has no [domain], whose box would be the truth; add it")?;
        let (e, by) = exact_in(domain, settings, positions, charges, direct_up_to)?;
        let scale = field_scale(&e, charges, domain.volume(), settings.permittivity.coulomb());
        Ok(Exact { e, scale, by })
    }

    fn exact_in_boxes(
        &mut self,
        problem: &Charged,
        boxes: &[GroundedBox],
        direct_up_to: usize,
    ) -> Result<Exact, String> {
        let Charged { positions, charges, settings, .. } = problem;
        let grounded = |GroundedBox { min_m, max_m }: &GroundedBox| {
            let faces = [[Boundary::Grounded; 2]; 3];
            Domain::new(Vector3::from(*min_m), Vector3::from(*max_m), faces)
                .map_err(|error| error.to_string())
        };
        let boxes = boxes.iter().map(grounded).collect::<Result<Vec<_>, _>>()?;
        let mut e = vec![Vector3::zeros(); positions.len()];
        let mut by = String::new();
        let mut known = 0;
        for domain in &boxes {
            let here: Vec<usize> =
                (0..positions.len()).filter(|&grain| domain.contains(&positions[grain])).collect();
            let its_positions: Vec<_> = here.iter().map(|&grain| positions[grain]).collect();
            let its_charges: Vec<_> = here.iter().map(|&grain| charges[grain]).collect();
            let found = exact_in(domain, settings, &its_positions, &its_charges, direct_up_to)?;
            here.iter().zip(found.0).for_each(|(&grain, found)| e[grain] = found);
            by = format!("{} in {} boxes", found.1, boxes.len());
            known += here.len();
        }
        if known != positions.len() {
            return Err(format!("{known} of {} grains are in one of the truth's boxes", positions.len()));
        }
        let volume = boxes.iter().map(Domain::volume).sum();
        let scale = field_scale(&e, charges, volume, settings.permittivity.coulomb());
        Ok(Exact { e, scale, by })
    }

    fn charges(&self, problem: &Charged) -> (Vec<Vector3<f64>>, Vec<f64>, f64) {
        let coulomb = problem.settings.permittivity.coulomb();
        (problem.positions.clone(), problem.charges.clone(), coulomb)
    }

    fn method(&mut self, problem: &mut Charged) -> Result<Built, String> {
        let said = |failure: Failure| failure.message().to_owned();
        let solver = connect_solver(&mut problem.scene, &problem.folder).map_err(said)?.field;
        let domain = domain_of(&problem.scene).map_err(said)?;
        let field = field_of(domain, &problem.settings, solver, &problem.positions, &problem.charges)
            .map_err(said)?;
        Ok(Built { field, values: FieldValues::default() })
    }

    fn peer(
        &mut self,
        program: &str,
        problem: &Charged,
        exact: &Exact,
        tolerance: f64,
    ) -> Result<Peer, String> {
        let domain = problem.scene.domain.as_ref().ok_or("the scene has no [domain]")?;
        let largest = problem.scene.particles.radius.iter().copied().fold(0.0, f64::max);
        let problem = PeerProblem {
            domain,
            permittivity: problem.settings.permittivity,
            positions: &problem.positions,
            charges: &problem.charges,
            diameter_m: 2.0 * largest,
        };
        measure_field(program, &problem, exact, tolerance)
    }

    fn simulate(&mut self, scene: &Path, set: &[String], nudge: f64, looks: usize) -> Result<Moved, String> {
        motion::simulate(scene, set, nudge, looks)
    }

    fn endure(&mut self, scene: &Path, set: &[String], extreme: &Extreme) -> Endured {
        extremes::endure(scene, set, extreme)
    }

    fn e<'m>(&self, method: &'m Built) -> &'m [Vector3<f64>] {
        &method.values.e
    }

    fn evaluate(&mut self, problem: &Charged, method: &mut Built) -> Result<Evaluation, String> {
        let Built { field, values } = method;
        let begun = Instant::now();
        field
            .evaluate(&problem.positions, &problem.charges, Wanted::default(), values)
            .map_err(|error| error.to_string())?;
        let seconds = begun.elapsed().as_secs_f64();
        let statistics = field.statistics();
        let promises = problem.settings.method == Method::P3m;
        Ok(Evaluation {
            seconds,
            stages: statistics.seconds.into_iter().map(|(stage, s)| (stage.to_owned(), s)).collect(),
            memory_bytes: field.memory_bytes(),
            parameters: parameters(field.choice()).to_string(),
            estimated: field.error_estimated(),
            promised: promises.then_some(problem.settings.tolerance),
            pairs_per_grain: statistics.pairs_per_particle,
        })
    }
}

/// E at grains in a box [V/m], by the direct sum for at most so many of them, and how it was found.
fn exact_in(
    domain: &Domain,
    settings: &FieldSettings,
    positions: &[Vector3<f64>],
    charges: &[f64],
    direct_up_to: usize,
) -> Result<(Vec<Vector3<f64>>, String), String> {
    let (method, by) = if charges.len() <= direct_up_to {
        (Method::Direct, "the direct sum".to_owned())
    } else {
        (Method::P3m, format!("p3m with a tolerance of {TRUTH:e}"))
    };
    let settings = FieldSettings {
        method,
        tolerance: TRUTH,
        tuning: Tuning::Model,
        cutoff_radius_m: None,
        grid_cells: None,
        ..settings.clone()
    };
    let mut values = FieldValues::default();
    ElectricField::new(domain, &settings, positions, charges)
        .and_then(|mut field| field.evaluate(positions, charges, Wanted::default(), &mut values))
        .map_err(|error| error.to_string())?;
    Ok((values.e, by))
}

/// Commit from which the program was made, where the study is run in its repository.
fn commit() -> String {
    let output = Command::new("git").args(["describe", "--always", "--dirty"]).output();
    let output = output.ok().filter(|output| output.status.success());
    output.map_or_else(String::new, |output| format!("+{}", String::from_utf8_lossy(&output.stdout).trim()))
}
