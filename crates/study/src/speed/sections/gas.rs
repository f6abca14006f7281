//! Goldschmidt's bed beside DPMFoam, the solver of OpenFOAM's own that moves grains and gas: time, and what
//! comes out.

use super::change_file;
use crate::Context;
use crate::page::{Table, figure};
use amberfield_core::Particles;
use amberfield_coupling::{Announced, SolverSettings, foam_command, solver_program};
use amberfield_dem::{GasSetup, Setup, Simulation};
use amberfield_gas::{ConnectFlow, ExchangeSeconds};
use amberfield_scene::{Purpose, read_scene};
use amberfield_study::Store;
use amberfield_study::templates::fill;
use anyhow::{Context as _, Result, ensure};
use minijinja::context;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

const NAME: &str = "gas";
/// Folder of the case in Debian's package of examples.
const EXAMPLE: &str = "/usr/share/doc/openfoam-examples/examples/lagrangian/DPMFoam/Goldschmidt";
/// Simulated time between two looks [s], and how many there are.
const LOOKS: (f64, usize) = (0.01, 5);
const QUICK: (f64, usize) = (2e-4, 1);
/// Share of a run that the way there and back may take.
const GOAL: f64 = 0.02;

/// State of a program's run at a moment.
#[derive(Debug, Serialize, Deserialize)]
struct Row {
    program: String,
    /// Simulated time [s].
    time_s: f64,
    /// Wall clock since the start of the run, without setting up; of DPMFoam its own clock, of the
    /// processor [s].
    seconds: f64,
    /// Mean height of the grains [mm].
    height_mm: f64,
    /// Pressure at the bottom less that at the top [Pa].
    pressure_pa: f64,
    /// Part of the wall clock for contacts, neighbours, walls and motion [s].
    grains_s: Option<f64>,
    /// Part of the wall clock for the flow [s].
    flow_s: Option<f64>,
    /// Part of the wall clock for taking grains to cells and the flow to grains [s].
    mapping_s: Option<f64>,
    /// Part of the wall clock for the messages' way there and back [s].
    wire_s: Option<f64>,
}

pub(crate) fn measure(context: &Context, root: &Path) -> Result<()> {
    if !solver_program(true).is_file() || !Path::new(EXAMPLE).is_dir() {
        println!("amberPimpleFoam or OpenFOAM's examples are missing (cargo xtask openfoam): not measured");
        return Ok(());
    }
    let place = root.join("target/bench/gas");
    let _ = std::fs::remove_dir_all(&place);
    std::fs::create_dir_all(&place)?;
    let looks = if context.quick { QUICK } else { LOOKS };
    let dpm = Dpm::prepare(&place, looks)?;
    let lattice = dpm.lattice()?;
    let mut rows = ours(root, &place, &lattice, looks)?;
    rows.extend(dpm.run(looks)?);
    for row in &rows {
        println!("{row:?}");
    }
    Ok(context.store.save(NAME, &rows)?)
}

/// The case of this project, with grains at the places given [m].
fn ours(root: &Path, place: &Path, lattice: &[[f64; 3]], looks: (f64, usize)) -> Result<Vec<Row>> {
    copy(&root.join("cases/goldschmidt/foam"), &place.join("foam"))?;
    let foam = place.join("foam");
    change_file(&foam.join("system/controlDict"), &[("0.1", &format!("{}", looks.0)), ("binary", "ascii")])?;
    let scene = read_scene(&root.join("cases/goldschmidt/scene.toml"), &[], Purpose::Run)?;
    let at = |(place, mut grain): (&[f64; 3], amberfield_core::Grain)| {
        grain.position = (*place).into();
        grain
    };
    let grains = (0..scene.particles.len()).map(|i| scene.particles.grain(i));
    ensure!(
        lattice.len() == scene.particles.len(),
        "{} places for {} grains",
        lattice.len(),
        scene.particles.len()
    );
    let particles: Particles = lattice.iter().zip(grains).map(at).collect();
    let gas = scene.gas.context("the case has a gas")?;
    let mut run = Simulation::new(Setup {
        domain: scene.domain.context("the case has a box")?,
        materials: scene.materials,
        rolling_model: scene.rolling_model,
        cohesion: scene.cohesion,
        pairs: scene.pairs.clone(),
        particles,
        walls: scene.walls,
        time: scene.time.context("the case has a time")?,
        gas: Some(GasSetup { gas, solver: Some(solver_of(foam, place)?) }),
        field: None,
        feeds: Default::default(),
        outlets: Vec::new(),
    })?;
    let begun = Instant::now();
    let mut rows = Vec::new();
    for look in 1..=looks.1 {
        let until = looks.0 * look as f64 - 0.5 * run.step_s();
        while run.time_s() < until {
            run.step()?;
        }
        rows.push(row_of(&run, begun.elapsed().as_secs_f64())?);
    }
    Ok(rows)
}

/// The flow of a case.
fn solver_of(case: PathBuf, place: &Path) -> Result<ConnectFlow> {
    let settings = SolverSettings {
        flow: true,
        timeout: Duration::from_secs(60),
        ..SolverSettings::started(case, place.join("solver"))
    };
    Ok(ConnectFlow::once(Announced::new(settings)?.connect()?.flow()))
}

/// Row of a run as it is now, after this wall clock [s].
fn row_of(run: &Simulation, seconds: f64) -> Result<Row> {
    /// Area of the bottom [m²].
    const AREA: f64 = 0.015 * 0.15;
    let exchange = run.gas_exchange().context("a gas that flows")?;
    let ExchangeSeconds { mapping, solver, wire } = exchange.seconds();
    let all: f64 = run.stage_seconds().iter().map(|(_, seconds)| seconds).sum();
    // ∇p over the box: what the bottom has more than the top.
    let cells = exchange.values().pressure_gradient.iter().zip(exchange.volumes());
    let heights: f64 = run.particles().position.iter().map(|place| place.z).sum();
    Ok(Row {
        program: "amberfield".to_owned(),
        time_s: run.time_s(),
        seconds,
        height_mm: 1e3 * heights / run.len() as f64,
        pressure_pa: -cells.map(|(slope, volume)| slope.z * volume).sum::<f64>() / AREA,
        grains_s: Some(all - mapping - solver - wire),
        flow_s: Some(solver),
        mapping_s: Some(mapping),
        wire_s: Some(wire),
    })
}

/// DPMFoam on a copy of its example.
struct Dpm {
    case: PathBuf,
}

impl Dpm {
    fn prepare(place: &Path, (between, count): (f64, usize)) -> Result<Self> {
        let case = place.join("dpm");
        copy(Path::new(EXAMPLE), &case)?;
        let end = between * count as f64;
        change_file(
            &case.join("system/controlDict"),
            &[
                ("endTime         5;", &format!("endTime {end};")),
                ("writeInterval   0.01;", &format!("writeInterval {between};")),
                ("writeFormat     binary;", "writeFormat ascii;"),
            ],
        )?;
        let dpm = Self { case };
        dpm.program("blockMesh")?;
        Ok(dpm)
    }

    /// Places of its grains at the start [m].
    fn lattice(&self) -> Result<Vec<[f64; 3]>> {
        let packed = self.case.join("constant/kinematicCloudPositions.gz");
        let output = Command::new("gzip").arg("-dc").arg(&packed).output().context("gzip")?;
        Ok(vectors(&String::from_utf8_lossy(&output.stdout)))
    }

    fn run(&self, (between, count): (f64, usize)) -> Result<Vec<Row>> {
        let log = self.program("DPMFoam")?;
        let clock = |time: f64| {
            let mut now = 0.0_f64;
            let mut seconds = (0.0, 0.0);
            for line in log.lines() {
                if let Some(text) = line.strip_prefix("Time = ") {
                    now = text.trim().parse().unwrap_or(now);
                }
                let number = line.strip_prefix("ExecutionTime = ").and_then(|text| text.split(' ').next());
                if let Some(number) = number.and_then(|text| text.parse::<f64>().ok()) {
                    seconds.0 = if seconds.0 == 0.0 { number } else { seconds.0 };
                    if now <= time * (1.0 + 1e-9) {
                        seconds.1 = number;
                    }
                }
            }
            seconds.1 - seconds.0
        };
        let mut rows = Vec::new();
        for look in 1..=count {
            let time_s = between * look as f64;
            let folder = self.case.join(format!("{}", (time_s * 1e9).round() / 1e9));
            let places = std::fs::read_to_string(folder.join("lagrangian/kinematicCloud/positions"))
                .with_context(|| folder.display().to_string())?;
            let places = vectors(&places);
            let pressure = std::fs::read_to_string(folder.join("p"))?;
            let cells: Vec<f64> = pressure.lines().filter_map(|line| line.trim().parse().ok()).collect();
            // After the count: the cells of the lowest layer, 2 × 30 of them, and p is over the density.
            let bottom = cells[1..=60].iter().sum::<f64>() / 60.0 * 1.2;
            rows.push(Row {
                program: "DPMFoam".to_owned(),
                time_s,
                seconds: clock(time_s),
                height_mm: 1e3 * places.iter().map(|place| place[2]).sum::<f64>() / places.len() as f64,
                pressure_pa: bottom,
                grains_s: None,
                flow_s: None,
                mapping_s: None,
                wire_s: None,
            });
        }
        Ok(rows)
    }

    /// Runs a program on the case; what it prints.
    fn program(&self, name: &str) -> Result<String> {
        let mut command = foam_command(name);
        command.arg("-case").arg(&self.case).stdin(Stdio::null());
        let output = command.output().with_context(|| name.to_owned())?;
        ensure!(output.status.success(), "{name}: {}", String::from_utf8_lossy(&output.stderr));
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    }
}

/// Vectors of a file of OpenFOAM's, one a line.
fn vectors(text: &str) -> Vec<[f64; 3]> {
    let one = |line: &str| {
        let inner = line.trim().strip_prefix('(')?.split(')').next()?;
        let mut numbers = inner.split_whitespace().map(str::parse::<f64>);
        let vector = [numbers.next()?.ok()?, numbers.next()?.ok()?, numbers.next()?.ok()?];
        Some(vector)
    };
    text.lines().filter_map(one).collect()
}

fn copy(from: &Path, to: &Path) -> Result<()> {
    let status = Command::new("cp").arg("-r").arg(from).arg(to).status()?;
    ensure!(status.success(), "cannot copy {}", from.display());
    Ok(())
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table = Table::new(&[
        "program",
        "t [s]",
        "mean height [mm]",
        "pressure drop [Pa]",
        "wall clock per simulated second [s]",
    ]);
    for row in &rows {
        table.row(&[
            row.program.clone(),
            figure(Some(row.time_s), 3),
            figure(Some(row.height_mm), 2),
            figure(Some(row.pressure_pa), 0),
            figure(Some(row.seconds / row.time_s), 0),
        ]);
    }
    let last = |program: &str| rows.iter().rfind(|row| row.program == program);
    let (ours, theirs) = (last("amberfield"), last("DPMFoam"));
    let ratio = ours.zip(theirs).map(|(a, b)| b.seconds / b.time_s / (a.seconds / a.time_s));
    let share = |part: fn(&Row) -> Option<f64>| ours.and_then(|row| Some(part(row)? / row.seconds));
    let of = |program: &'static str| rows.iter().filter(move |row| row.program == program);
    let apart = of("amberfield").zip(of("DPMFoam")).map(|(a, b)| (a.height_mm / b.height_mm - 1.0).abs());
    let apart = apart.fold(0.0, f64::max);
    let mean =
        |program| of(program).map(|row| row.pressure_pa).sum::<f64>() / of(program).count().max(1) as f64;
    let percent = |part: fn(&Row) -> Option<f64>| share(part).map(|share| 100.0 * share);
    let values = context! {
        date,
        table => table.to_string(),
        ratio,
        apart => 100.0 * apart,
        our_pressure => mean("amberfield"),
        their_pressure => mean("DPMFoam"),
        grains => percent(|row| row.grains_s),
        flow => percent(|row| row.flow_s),
        mapping => percent(|row| row.mapping_s),
        wire => percent(|row| row.wire_s),
        goal => 100.0 * GOAL,
        met => share(|row| row.wire_s).map(|share| share < GOAL),
    };
    Ok(Some(fill(include_str!("../../../templates/speed/gas.md"), values)))
}
