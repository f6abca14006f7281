//! Beds at rest: how high they lie and what still moves, against LAMMPS' granular package from the same
//! starts, for restitutions and stiffnesses.

use crate::Context;
use crate::page::{Table, figure};
use amberfield_core::{
    Boundary, Domain, Grain, GroupId, Material, MaterialId, OnExit, Particles, RollingModel, Skin, Step,
    TimeSettings, Vector3, Wall, WallCharging, WallShape,
};
use amberfield_dem::{ElectricEnergy, Setup, Simulation};
use amberfield_study::Store;
use amberfield_study::peers::Script;
use amberfield_study::templates::fill;
use anyhow::Result;
use minijinja::context;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

const NAME: &str = "rest";
const RADIUS: f64 = 1e-3;
const HALF: f64 = 5.0 * RADIUS;
const DENSITY: f64 = 2500.0;
const POISSON: f64 = 0.25;
const FRICTION: f64 = 0.5;
const GRAVITY: f64 = 9.81;
const GRAINS: usize = 128;
const END_S: f64 = 0.4;
/// Displacement of grains at the start from bed to bed [m].
const ELSEWHERE: f64 = 2e-5;
/// Part of our automatic step that LAMMPS takes: its own limit is tighter where damping is strong.
const PEER_STEP: f64 = 0.2;

#[derive(Debug, Serialize, Deserialize)]
struct Row {
    restitution: f64,
    young_pa: f64,
    beds: usize,
    step_s: f64,
    /// Mean height over beds, and its standard error [mm].
    ours_mm: f64,
    ours_error_mm: f64,
    lammps_mm: Option<f64>,
    lammps_error_mm: Option<f64>,
    /// Largest kinetic energy of our beds over N m g d.
    kinetic: f64,
}

pub(crate) fn measure(context: &Context) -> Result<()> {
    let (restitutions, moduli, beds): (&[f64], &[f64], usize) =
        if context.quick { (&[0.4], &[5e5], 2) } else { (&[0.1, 0.2, 0.4, 0.6, 0.9], &[5e5, 5e6, 5e7], 8) };
    let mut rows = Vec::new();
    for &young_pa in moduli {
        for &restitution in restitutions {
            let starts: Vec<Setup> = (0..beds).map(|bed| start(restitution, young_pa, bed as u64)).collect();
            let row = row(context, restitution, young_pa, &starts)?;
            println!("{row:?}");
            rows.push(row);
            context.store.save(NAME, &rows)?;
        }
    }
    Ok(())
}

fn row(context: &Context, restitution: f64, young_pa: f64, starts: &[Setup]) -> Result<Row> {
    let weight = GRAINS as f64 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * DENSITY * GRAVITY;
    let (mut heights, mut kinetic, mut step_s) = (Vec::new(), 0.0_f64, 0.0);
    for start in starts {
        let mut run = Simulation::new(start.clone())?;
        while run.time_s() < END_S {
            run.step()?;
        }
        let grains = run.particles();
        heights.push(1e3 * grains.position.iter().map(|x| x.z).sum::<f64>() / GRAINS as f64);
        kinetic = kinetic.max(run.energies(ElectricEnergy::LeftOut)?.kinetic / (weight * 2.0 * RADIUS));
        step_s = run.step_s();
    }
    let theirs = match &context.peers {
        None => None,
        Some(peers) => {
            let step = PEER_STEP * step_s;
            // γ_t = √(S_t/S_n) γ_n with S_t = 8 G* a and S_n = 2 Y* a.
            let ratio = (2.0 * (1.0 - POISSON) / (2.0 - POISSON)).sqrt();
            let head = [
                starts.len() as f64,
                GRAINS as f64,
                HALF,
                2.0 * RADIUS,
                DENSITY,
                young_pa,
                POISSON,
                restitution,
                FRICTION,
                ratio,
                GRAVITY,
                step,
                (END_S / step).ceil(),
            ];
            let grains = starts.iter().flat_map(|start| {
                start.particles.position.iter().flat_map(|x| [x.x, x.y, x.z, 0.0, 0.0, 0.0])
            });
            let file = peers.file("beds.bin", head.into_iter().chain(grains))?;
            let lines = peers.run(Script::LammpsRest, 1, &[&file])?;
            Some(mean(&lines.iter().map(|line| 1e3 * line[0]).collect::<Vec<_>>()))
        }
    };
    let [ours_mm, ours_error_mm] = mean(&heights);
    Ok(Row {
        restitution,
        young_pa,
        beds: starts.len(),
        step_s,
        ours_mm,
        ours_error_mm,
        lammps_mm: theirs.map(|[mean, _]| mean),
        lammps_error_mm: theirs.map(|[_, error]| error),
        kinetic,
    })
}

/// Mean and its standard error.
fn mean(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    [mean, (square / (count * (count - 1.0).max(1.0))).sqrt()]
}

/// Plane at a distance from the origin [m].
fn plane(normal: Vector3<f64>, distance: f64) -> Wall {
    Wall {
        name: "side".to_owned(),
        shape: WallShape::Plane { point: -distance * normal, normal },
        material: MaterialId(0),
        charging: WallCharging::None,
        bounds_field: false,
        motion: Vec::new(),
    }
}

/// Grains on a jittered lattice in a box of four sides and a floor, at the automatic step.
fn start(restitution: f64, young_pa: f64, bed: u64) -> Setup {
    let spacing = 2.2 * RADIUS;
    let across = (2.0 * HALF / spacing) as usize;
    let (mut places, mut moved) = (ChaCha8Rng::seed_from_u64(11), ChaCha8Rng::seed_from_u64(bed));
    let particles: Particles = (0..GRAINS)
        .map(|n| {
            let cell = [n % across, n / across % across, n / across / across];
            let position = Vector3::from_fn(|axis, _| {
                let corner = if axis == 2 { 0.0 } else { -HALF };
                let jitter = 0.05 * RADIUS * places.random_range(-1.0..1.0);
                let elsewhere = ELSEWHERE * moved.random_range(-1.0..1.0);
                corner + (cell[axis] as f64 + 0.5) * spacing + jitter + elsewhere
            });
            Grain {
                id: n as u64,
                position,
                velocity: Vector3::zeros(),
                angular_velocity: Vector3::zeros(),
                radius: RADIUS,
                density: DENSITY,
                charge: 0.0,
                material: MaterialId(0),
                group: GroupId(0),
            }
        })
        .collect();
    let sides = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y()];
    Setup {
        domain: Domain::new(Vector3::repeat(-1.0), Vector3::repeat(1.0), [[Boundary::Open; 2]; 3])
            .expect("positive extents"),
        materials: vec![glass(restitution, young_pa)],
        rolling_model: RollingModel::default(),
        cohesion: Default::default(),
        pairs: Vec::new(),
        particles,
        walls: sides
            .map(|normal| plane(normal, HALF))
            .into_iter()
            .chain([plane(Vector3::z(), 0.0)])
            .collect(),
        time: TimeSettings {
            step: Step::Auto,
            end_s: END_S,
            gravity_m_s2: Vector3::new(0.0, 0.0, -GRAVITY),
            skin: Skin::Auto,
            allow_unstable: false,
            on_exit: OnExit::Stop,
            allow_overlap: false,
        },
        gas: None,
        field: None,
        feeds: Default::default(),
        outlets: Vec::new(),
    }
}

/// Material of the grains and the walls.
fn glass(restitution: f64, young_pa: f64) -> Material {
    Material {
        name: "glass".to_owned(),
        density_kg_m3: DENSITY,
        young_pa,
        young_real_pa: None,
        poisson: POISSON,
        restitution,
        friction: FRICTION,
        rolling_friction: 0.0,
        surface_energy_j_m2: 0.0,
        work_function_ev: None,
    }
}

/// The section's part of the page.
pub(crate) fn report(store: &Store) -> Result<Option<String>> {
    let Some((date, rows)) = store.newest::<Row>(NAME)? else { return Ok(None) };
    let mut table = Table::new(&[
        "restitution",
        "Young's modulus [Pa]",
        "our step [s]",
        "our mean height [mm]",
        "LAMMPS [mm]",
        "ours / LAMMPS",
        "kinetic energy [N m g d]",
    ]);
    let with_error =
        |value: Option<f64>, error: Option<f64>| format!("{} ± {}", figure(value, 3), figure(error, 3));
    for row in &rows {
        table.row(&[
            row.restitution.to_string(),
            format!("{:e}", row.young_pa),
            format!("{:.2e}", row.step_s),
            with_error(Some(row.ours_mm), Some(row.ours_error_mm)),
            with_error(row.lammps_mm, row.lammps_error_mm),
            figure(row.lammps_mm.map(|lammps| row.ours_mm / lammps), 4),
            format!("{:.1e}", row.kinetic),
        ]);
    }
    let beds = rows.first().map_or(0, |row| row.beds);
    let values = context! { date, beds, grains => GRAINS, table => table.to_string() };
    Ok(Some(fill(include_str!("../../../templates/speed/rest.md"), values)))
}
