//! A scene sent through a command of its own process, as a user would: it may fail in any way.

use crate::failure::Failure;
use crate::run::{SolverFolder, read_scene};
use amberfield_core::{Permittivity, Vector3};
use amberfield_oracle::{ErrorNorms, field_scale};
use amberfield_scene::{Purpose, read_table};
use amberfield_study::sweep::{Endured, Extreme, Look};
use serde::Deserialize;
use std::fs::File;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Waiting for the command.
const PAUSE: Duration = Duration::from_millis(2);

/// Sends a scene through the command of an extreme, and looks at what it wrote.
pub(super) fn endure(scene: &Path, set: &[String], extreme: &Extreme) -> Endured {
    match tempfile::tempdir() {
        Ok(folder) => endure_in(folder.path(), scene, set, extreme),
        Err(error) => {
            Endured { said: format!("no folder for what it writes: {error}"), ..Endured::default() }
        }
    }
}

fn endure_in(folder: &Path, scene: &Path, set: &[String], extreme: &Extreme) -> Endured {
    let out = folder.join("out");
    let most = Duration::from_secs_f64(extreme.most_s);
    if extreme.command() == "run" {
        let mut endured = sent(folder, &["run", "--no-progress"], scene, set, &out, most);
        let rows: Vec<Row> = read_table(&out.join("history.csv")).unwrap_or_default();
        endured.looks = rows.iter().map(Row::look).collect();
        if let Ok(folder) = SolverFolder::temporary()
            && let Ok(scene) = read_scene(scene, set, Purpose::Run, &folder)
        {
            endured.grains = scene.particles.len();
            let moved = rows.iter().filter_map(|row| row.contact_charge_c).map(f64::abs).fold(0.0, f64::max);
            endured.charges_c = scene.particles.charge.iter().map(|charge| charge.abs()).sum::<f64>() + moved;
        }
        return endured;
    }
    let mut endured = sent(folder, &["field"], scene, set, &out, most);
    if endured.code == Some(0) {
        let exact = folder.join("exact");
        let direct = sent(folder, &["field", "--method", "direct"], scene, set, &exact, most);
        match error_of(scene, set, &out, &exact) {
            Ok(error) if direct.code == Some(0) => endured.error = Some(error),
            Ok(_) => endured.said = format!("no direct sum: {}", direct.said),
            Err(reason) => endured.said = reason,
        }
    }
    endured
}

/// Runs a command to its end, or until it takes too long.
fn sent(
    folder: &Path,
    command: &[&str],
    scene: &Path,
    set: &[String],
    out: &Path,
    most: Duration,
) -> Endured {
    let log = folder.join("stderr");
    let begun = Instant::now();
    let mut endured = Endured::default();
    match start(command, scene, set, out, &log) {
        Ok(mut process) => loop {
            match process.try_wait() {
                Ok(Some(status)) => {
                    endured.code = status.code();
                    break;
                }
                Ok(None) if begun.elapsed() < most => std::thread::sleep(PAUSE),
                Ok(None) | Err(_) => {
                    // It is gone, or goes now.
                    let _killed = process.kill().and_then(|()| process.wait());
                    break;
                }
            }
        },
        Err(error) => endured.said = format!("cannot start the command: {error}"),
    }
    endured.seconds = begun.elapsed().as_secs_f64();
    if endured.code != Some(0) {
        let said = std::fs::read(&log).unwrap_or_default();
        let said = String::from_utf8_lossy(&said).into_owned();
        let last = said.lines().rfind(|line| line.starts_with("error")).or(said.lines().last());
        endured.said = last.unwrap_or_default().trim_start_matches("error: ").to_owned();
    }
    endured
}

fn start(
    command: &[&str],
    scene: &Path,
    set: &[String],
    out: &Path,
    log: &Path,
) -> std::io::Result<std::process::Child> {
    Command::new(std::env::current_exe()?)
        .args(command)
        .arg(scene)
        .arg("--out")
        .arg(out)
        .args(set.iter().flat_map(|set| ["--set", set]))
        .args(["--threads", &rayon::current_num_threads().to_string()])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(File::create(log)?)
        .spawn()
}

/// Relative RMS difference of two files of E.
fn error_of(scene: &Path, set: &[String], out: &Path, exact: &Path) -> Result<f64, String> {
    let said = |error: amberfield_scene::SceneError| error.to_string();
    let of_read = |failure: Failure| failure.message().to_owned();
    let solver_folder = SolverFolder::temporary().map_err(of_read)?;
    let scene = read_scene(scene, set, Purpose::Field, &solver_folder).map_err(of_read)?;
    let [e, exact] = [out, exact].map(|file| {
        let rows: Vec<FieldRow> = read_table(file)?;
        Ok(rows.iter().map(FieldRow::e).collect::<Vec<_>>())
    });
    let (e, exact) = (e.map_err(said)?, exact.map_err(said)?);
    let medium = scene.electric_field.as_ref().map_or(Permittivity::VACUUM, |field| field.field.permittivity);
    let volume = scene.domain.as_ref().map_or(1.0, amberfield_core::Domain::volume);
    let scale = field_scale(&exact, &scene.particles.charge, volume, medium.coulomb());
    Ok(ErrorNorms::new(&e, &exact, scale).relative_rms)
}

/// A row of `history.csv`; columns that a scene does not have are absent.
#[derive(Debug, Deserialize)]
struct Row {
    time_s: f64,
    #[serde(rename = "kinetic_J")]
    kinetic_j: f64,
    #[serde(rename = "contact_J", default)]
    contact_j: Option<f64>,
    #[serde(rename = "gravity_J", default)]
    gravity_j: Option<f64>,
    #[serde(rename = "electric_J", default)]
    electric_j: Option<f64>,
    #[serde(rename = "net_charge_C", default)]
    net_charge_c: Option<f64>,
    #[serde(rename = "contact_charge_C", default)]
    contact_charge_c: Option<f64>,
    #[serde(rename = "wall_charge_C", default)]
    wall_charge_c: Option<f64>,
    #[serde(default)]
    limited: Option<u64>,
}

impl Row {
    fn look(&self) -> Look {
        let sum = |parts: &[Option<f64>]| parts.iter().flatten().sum::<f64>();
        Look {
            time_s: self.time_s,
            kinetic_j: self.kinetic_j,
            potential_j: sum(&[self.contact_j, self.gravity_j, self.electric_j]),
            charge_c: sum(&[self.net_charge_c, self.wall_charge_c]),
            limited: self.limited,
        }
    }
}

/// E in a row of the command `field`.
#[derive(Debug, Deserialize)]
struct FieldRow {
    #[serde(rename = "ex_V_per_m")]
    x: f64,
    #[serde(rename = "ey_V_per_m")]
    y: f64,
    #[serde(rename = "ez_V_per_m")]
    z: f64,
}

impl FieldRow {
    fn e(&self) -> Vector3<f64> {
        Vector3::new(self.x, self.y, self.z)
    }
}
