//! Cost of having the far field solved by another process.

use super::change_file;
use crate::Context;
use crate::beds::{self, ChargedBed};
use crate::page::{Table, figure};
use crate::timing::{median, median_seconds};
use amberfield_core::{
    Boundary, CouplingInterval, Domain, FarQuestion, FieldSettings, Method, SourceCloud, Tuning, Vector3,
};
use amberfield_coupling::{
    Announced, BoxSolver, FieldSide, MeshArrays, Reply, SolverSettings, solver_program,
};
use amberfield_dem::{FieldStageSetup, Simulation};
use amberfield_field::far::{Connect, FarField, FarRequest, FarSolver, FarValues};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_study::Store;
use amberfield_study::templates::fill;
use anyhow::Result;
use minijinja::context;
use serde::{Deserialize, Serialize};
use std::io::{Read as _, Write as _};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::time::{Duration, Instant};

const NAME: &str = "coupling";
const FRACTION: f64 = 0.4;
/// Shares of a field evaluation that an exchange may take: an empty message, and one with everything in it.
const GOALS: [f64; 2] = [0.01, 0.03];
/// Grains per second that a core maps to cells.
const MAPPED: f64 = 5e6;
/// Radius of the clouds over the cell size, as p3m over a mesh has it.
const RADIUS: f64 = 9.0;
/// Far-field step over the bare linear solve.
const STEP: f64 = 1.3;

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    what: String,
    grains: usize,
    cells: usize,
    seconds: f64,
}

pub(crate) fn measure(context: &Context, root: &Path) -> Result<()> {
    let (grains, cells_along) = if context.quick { (1000, 8) } else { (100_000, 46) };
    let cloud = beds::cloud(grains, FRACTION);
    let edge = cloud.domain.extent().x;
    let faces = [[Boundary::Periodic; 2], [Boundary::Periodic; 2], [Boundary::Grounded; 2]];
    let domain = Domain::new(cloud.domain.min(), cloud.domain.max(), faces)?;
    let cells = cells_along * cells_along * cells_along;
    let mut rows = Vec::new();
    let mut add = |what: &str, seconds: f64| {
        let row = Row { what: what.to_owned(), grains, cells, seconds };
        println!("{row:?}");
        rows.push(row);
    };

    let twin = BoxSolver::new(&domain, [cells_along; 3])?;
    let mesh = twin.mesh();
    let mut last: Vec<u32> = cloud.position.iter().map(|place| mesh.locate(place, None).0).collect();
    let one_core = || {
        for (cell, place) in last.iter_mut().zip(&cloud.position) {
            *cell = mesh.locate(place, Some(*cell)).0;
        }
    };
    add("mapping, warm, one core", median_seconds(0.3, one_core));

    let (empty, full, bytes) = exchange(&domain, cells_along, &cloud)?;
    add("exchange without payload", empty);
    add("exchange", full);
    add("the same bytes through a Unix socket", socket(bytes)?);

    if solver_program(false).is_file() {
        for path in &PATHS {
            over_openfoam(&cloud, (edge, cells_along), path, root, &mut add)?;
        }
        for (overlap, what) in [(false, "step, solver waited for"), (true, "step, solver beside")] {
            add(what, step(grains, cells_along, overlap, root)?);
        }
    } else {
        println!("electricFieldFoam is not built (cargo xtask openfoam): what needs it is not measured");
    }
    Ok(context.store.save(NAME, &rows)?)
}

fn settings_of(case: &Path, start: bool) -> SolverSettings {
    SolverSettings {
        workplace: start.then(|| case.with_extension("solver")),
        timeout: Duration::from_secs(120),
        ..SolverSettings::awaited(case)
    }
}

/// Seconds of an exchange with a field side that answers at once, without charges and with all of them, and
/// the bytes there and back.
fn exchange(domain: &Domain, cells_along: usize, cloud: &ChargedBed) -> Result<(f64, f64, [usize; 2])> {
    let announced = Announced::new(settings_of(Path::new("none"), false))?;
    let (run, box_of) = (announced.run().to_owned(), domain.clone());
    let field = std::thread::spawn(move || -> Result<()> {
        let solver = BoxSolver::new(&box_of, [cells_along; 3])?;
        let mesh = solver.mesh();
        let mut side = FieldSide::open(&run, 0, 1)?;
        side.send_mesh(&MeshArrays::of(mesh).part(mesh), 0)?;
        let (potential, e) = (vec![0.0; mesh.cell_count()], vec![[0.0; 3]; mesh.cell_count()]);
        while side.wait()?.is_some() {
            side.reply(&Reply { potential: &potential, e: &e, iterations: 0, residual: 0.0, seconds: 0.0 })?;
        }
        Ok(())
    });
    let mut remote = announced.connect()?;
    let boundary = vec![0.0; remote.mesh().boundary().len()];
    let mut values = FarValues::default();
    let mut time = |positions: &[Vector3<f64>], charges: &[f64]| {
        let request = FarRequest {
            question: FarQuestion {
                // Clouds belong to no cell: nobody maps the charges for them.
                cloud: SourceCloud { radius_m: RADIUS * domain.extent().x / cells_along as f64, shape: 10.0 },
                permittivity_f_m: 1.0,
                neutralising_background: 0,
                time_s: 0.0,
                tolerance: 0.0,
                wants_e: 1,
            },
            positions,
            charges,
            image_positions: &[],
            image_charges: &[],
            density: &[],
            boundary: &boundary,
            guess: &[],
        };
        median_seconds(0.5, || remote.solve(&request, &mut values).expect("it answers"))
    };
    let full = time(&cloud.position, &cloud.charge);
    drop(remote);
    field.join().expect("no panic")?;
    let (grains, cells) = (cloud.position.len(), cells_along.pow(3));
    Ok((round_trip()?, full, [32 * grains + 8 * boundary.len(), 32 * cells + 8 * grains]))
}

/// Seconds of a round trip with a mesh of one cell and no charge.
fn round_trip() -> Result<f64> {
    let announced = Announced::new(settings_of(Path::new("none"), false))?;
    let run = announced.run().to_owned();
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(1.0), [[Boundary::Grounded; 2]; 3])?;
    let field = std::thread::spawn(move || -> Result<()> {
        let solver = BoxSolver::new(&domain, [1; 3])?;
        let mut side = FieldSide::open(&run, 0, 1)?;
        side.send_mesh(&MeshArrays::of(solver.mesh()).part(solver.mesh()), 0)?;
        while side.wait()?.is_some() {
            side.reply(&Reply {
                potential: &[0.0],
                e: &[[0.0; 3]],
                iterations: 0,
                residual: 0.0,
                seconds: 0.0,
            })?;
        }
        Ok(())
    });
    let mut remote = announced.connect()?;
    let mut values = FarValues::default();
    let request = FarRequest {
        question: FarQuestion {
            cloud: SourceCloud::nearest_cell(),
            permittivity_f_m: 1.0,
            neutralising_background: 0,
            time_s: 0.0,
            tolerance: 0.0,
            wants_e: 1,
        },
        positions: &[],
        charges: &[],
        image_positions: &[],
        image_charges: &[],
        density: &[],
        boundary: &[0.0; 6],
        guess: &[],
    };
    let seconds = median_seconds(0.3, || remote.solve(&request, &mut values).expect("it answers"));
    drop(remote);
    field.join().expect("no panic")?;
    Ok(seconds)
}

/// Seconds to write so many bytes into a socket, read them at its other end, and have as many as the second
/// number back.
fn socket([out, back]: [usize; 2]) -> Result<f64> {
    let (mut here, mut there) = UnixStream::pair()?;
    let echo = std::thread::spawn(move || {
        let (mut received, answer) = (vec![0_u8; out], vec![1_u8; back]);
        while there.read_exact(&mut received).is_ok() && there.write_all(&answer).is_ok() {}
    });
    let (sent, mut received) = (vec![2_u8; out], vec![0_u8; back]);
    let seconds = median_seconds(0.5, || {
        here.write_all(&sent).and_then(|()| here.read_exact(&mut received)).expect("the other end is there");
    });
    drop(here);
    echo.join().expect("no panic");
    Ok(seconds)
}

/// A way to have the far field solved: what its rows are called, method, ranks.
struct SolvedBy {
    suffix: &'static str,
    method: Method,
    ranks: u32,
}

/// The default, and the others.
const PATHS: [SolvedBy; 3] = [
    SolvedBy { suffix: "", method: Method::P3m, ranks: 1 },
    SolvedBy { suffix: ", 2 ranks", method: Method::P3m, ranks: 2 },
    SolvedBy { suffix: ", kolehmainen", method: Method::Kolehmainen, ranks: 1 },
];
/// Cut-off of kolehmainen over the cell size.
const HYBRID_CUTOFF: f64 = 1.8;

/// Whole evaluations over OpenFOAM: all of it, its far-field step, and the bare linear solve in that.
fn over_openfoam(
    cloud: &ChargedBed,
    (edge, cells_along): (f64, usize),
    path: &SolvedBy,
    root: &Path,
    add: &mut impl FnMut(&str, f64),
) -> Result<()> {
    const EVALUATIONS: usize = 9;
    let case = root.join("target/bench-case");
    provide_case(root, &case, edge, cells_along, cloud.domain.min())?;
    let remote =
        Announced::new(SolverSettings { ranks: path.ranks, ..settings_of(&case, true) })?.connect()?;
    let hybrid = path.method == Method::Kolehmainen;
    let field = FieldSettings {
        method: path.method,
        tolerance: 1e-2,
        cutoff_radius_m: hybrid.then_some(HYBRID_CUTOFF * edge / cells_along as f64),
        tuning: Tuning::Model,
        ..FieldSettings::default()
    };
    let mut field = ElectricField::over_mesh(Box::new(remote), &field, &cloud.position, &cloud.charge)?;
    let mut out = FieldValues::default();
    let mut samples: [Vec<f64>; 3] = Default::default();
    for evaluation in 0..=EVALUATIONS {
        // Grains that move a little: the solver starts warm and has something to do.
        let shift = Vector3::new(1e-2 * edge / cells_along as f64 * evaluation as f64, 0.0, 0.0);
        let moved: Vec<_> = cloud.position.iter().map(|place| place + shift).collect();
        field.evaluate(&moved, &cloud.charge, Wanted::default(), &mut out)?;
        let seconds = field.statistics().seconds;
        let of = |name: &str| seconds.iter().filter(|(stage, _)| *stage == name).map(|(_, s)| s).sum::<f64>();
        let parts = [
            seconds.iter().map(|(_, s)| s).sum(),
            of(if hybrid { "mesh" } else { "far" }),
            field.far_solver().map_or(0.0, FarSolver::seconds),
        ];
        if evaluation > 0 {
            samples.iter_mut().zip(parts).for_each(|(all, part)| all.push(part));
        }
    }
    for (what, samples) in
        ["field evaluation", "far-field step", "bare Poisson solve"].iter().zip(&mut samples)
    {
        add(&format!("{what}{}", path.suffix), median(samples));
    }
    Ok(())
}

/// Seconds per DEM step when the field is evaluated every so many steps over OpenFOAM.
fn step(grains: usize, cells_along: usize, overlap: bool, root: &Path) -> Result<f64> {
    const INTERVAL: u32 = 10;
    const INTERVALS: u32 = 8;
    let case = root.join("target/bench-case");
    let mut scene = beds::sparse(grains);
    provide_case(root, &case, scene.domain.extent().x, cells_along, scene.domain.min())?;
    let settings = FieldSettings {
        tolerance: 1e-2,
        tuning: Tuning::Model,
        coupling_interval: CouplingInterval::Steps(INTERVAL),
        overlap,
        ..FieldSettings::default()
    };
    scene.particles.charge = (0..grains).map(|i| if i % 2 == 0 { 1e-15 } else { -1e-15 }).collect();
    let solver = settings_of(&case, true);
    let connect = Connect::new(move || {
        let remote = Announced::new(solver.clone())?.connect()?;
        Ok(Box::new(remote) as Box<dyn FarField>)
    });
    let field = FieldStageSetup::new(settings, vec![true; grains]);
    scene.field = Some(FieldStageSetup { solver: Some(connect), ..field });
    let mut simulation = Simulation::new(scene)?;
    let mut steps = |intervals: u32| -> Result<f64> {
        let start = Instant::now();
        for _ in 0..intervals * INTERVAL {
            simulation.step()?;
        }
        Ok(start.elapsed().as_secs_f64() / f64::from(intervals * INTERVAL))
    };
    steps(3)?;
    steps(INTERVALS)
}

/// The case of coupled-settling-bed on a cube with other cells.
fn provide_case(root: &Path, case: &Path, edge: f64, cells_along: usize, low: Vector3<f64>) -> Result<()> {
    let source = root.join("cases/coupled-settling-bed/foam");
    let _ = std::fs::remove_dir_all(case);
    for folder in ["0", "system"] {
        std::fs::create_dir_all(case.join(folder))?;
        for entry in std::fs::read_dir(source.join(folder))? {
            let entry = entry?;
            std::fs::copy(entry.path(), case.join(folder).join(entry.file_name()))?;
        }
    }
    let corner = |x: f64, y: f64, z: f64| {
        let place = low + Vector3::new(x, y, z) * edge;
        format!("({} {} {})", 1e3 * place.x, 1e3 * place.y, 1e3 * place.z)
    };
    let floor = |z: f64| {
        [corner(0.0, 0.0, z), corner(1.0, 0.0, z), corner(1.0, 1.0, z), corner(0.0, 1.0, z)].join(" ")
    };
    change_file(
        &case.join("system/blockMeshDict"),
        &[
            ("(0 0 0) (6 0 0) (6 6 0) (0 6 0)", &floor(0.0)),
            ("(0 0 10) (6 0 10) (6 6 10) (0 6 10)", &floor(1.0)),
            ("(12 12 20)", &format!("({cells_along} {cells_along} {cells_along})")),
        ],
    )
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let seconds = |what: &str| rows.iter().find(|row| row.what == what).map(|row| row.seconds);
    let evaluation = seconds("field evaluation");
    let mut table = Table::new(&["", "time [ms]", "of a field evaluation [%]"]);
    for row in &rows {
        let share = evaluation.map(|evaluation| 100.0 * row.seconds / evaluation);
        table.row(&[row.what.clone(), figure(Some(1e3 * row.seconds), 3), figure(share, 2)]);
    }
    let share = |what: &str| Some(seconds(what)? / evaluation?);
    let over = |what: &str, of: &str| Some(seconds(what)? / seconds(of)?);
    let rate = seconds("mapping, warm, one core").map(|seconds| rows[0].grains as f64 / seconds);
    let [empty, full] = ["exchange without payload", "exchange"].map(share);
    let socket = over("the same bytes through a Unix socket", "exchange");
    let step = over("far-field step", "bare Poisson solve");
    let values = context! {
        date,
        grains => rows[0].grains,
        cells => rows[0].cells,
        table => table.to_string(),
        empty_goal => 100.0 * GOALS[0],
        empty_met => empty.map(|share| share < GOALS[0]),
        empty => empty.map(|share| 100.0 * share),
        full_goal => 100.0 * GOALS[1],
        full_met => full.map(|share| share < GOALS[1]),
        full => full.map(|share| 100.0 * share),
        socket,
        beside => over("step, solver beside", "step, solver waited for"),
        rate => rate.map(|rate| 1e-6 * rate),
        mapped => 1e-6 * MAPPED,
        mapped_met => rate.map(|rate| rate >= MAPPED),
        step,
        step_goal => STEP,
        step_met => step.map(|step| step <= STEP),
        two_ranks => over("far-field step, 2 ranks", "bare Poisson solve, 2 ranks"),
        kolehmainen => over("far-field step, kolehmainen", "bare Poisson solve, kolehmainen"),
    };
    Ok(Some(fill(include_str!("../../../templates/speed/coupling.md"), values)))
}
