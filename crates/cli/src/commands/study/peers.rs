//! Other programs in a study, where `cargo xtask bench --peers` has installed them.

use super::Charged;
use amberfield_core::constants::coulomb_constant;
use amberfield_core::{Axis, Boundary};
use amberfield_study::sweep::{Exact, Peer};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// The environment of the peers, unless this variable names another.
const FOLDER: &str = "target/peers";
const VARIABLE: &str = "AMBERFIELD_PEERS";
const LAMMPS: &str = include_str!("../../../../bench/peers/lammps_field.py");
const FMM3D: &str = include_str!("../../../../bench/peers/fmm3d.py");
/// Shares of the tolerance asked of FMM3D, which errs far less than what is asked of it; its error is measured.
const PRECISIONS: [f64; 4] = [50.0, 10.0, 2.0, 0.5];
/// Shares of the tolerance asked of LAMMPS.
const SHARES: &str = "0.8,1.1";

/// Runs `pppm` or `msm` (LAMMPS, periodic boxes) or `fmm3d` (open space).
pub(super) fn run(program: &str, problem: &Charged, exact: &Exact, tolerance: f64) -> Result<Peer, String> {
    let domain = problem.scene.domain.as_ref().ok_or("the scene has no [domain]")?;
    let all = |face: Boundary| Axis::ALL.iter().all(|axis| domain.faces()[axis.index()] == [face; 2]);
    match program {
        "pppm" | "msm" if all(Boundary::Periodic) => lammps(program, problem, exact, tolerance),
        "fmm3d" if all(Boundary::Open) => fmm3d(problem, exact, tolerance),
        "pppm" | "msm" | "fmm3d" => Err(format!("{program} has no such boundaries")),
        other => Err(format!("unknown program {other:?}; give pppm, msm or fmm3d")),
    }
}

/// LAMMPS, the fastest of a sweep over cut-off, order and way of differentiation, its neighbour list kept.
fn lammps(style: &str, problem: &Charged, exact: &Exact, tolerance: f64) -> Result<Peer, String> {
    let (cutoffs, orders) = match tolerance {
        t if style == "msm" && t > 2e-3 => ("3,4,5,6", "4,6,8,10"),
        _ if style == "msm" => ("5,6,8", "8,10"),
        t if t > 2e-3 => ("1.5,2,2.5,3,4", "4,5"),
        t if t > 2e-4 => ("2,2.5,3,4", "5,6"),
        t if t > 2e-5 => ("2.5,3,4,5", "5,6"),
        _ => ("4,5,6,7", "7"),
    };
    let points =
        points("lammps", LAMMPS, problem, exact, &[&tolerance.to_string(), cutoffs, orders, SHARES, style])?;
    let meets = points.iter().filter(|point| point.len() == 7 && point[4] <= tolerance);
    let fastest =
        meets.min_by(|a, b| a[5].total_cmp(&b[5])).ok_or("no setting of the sweep meets the tolerance")?;
    Ok(Peer {
        error: fastest[4],
        seconds: fastest[5],
        parameters: format!("cut-off {:.3e} m, order {}", fastest[0], fastest[1]),
    })
}

fn fmm3d(problem: &Charged, exact: &Exact, tolerance: f64) -> Result<Peer, String> {
    let precisions = PRECISIONS.map(|share| (share * tolerance).to_string()).join(",");
    let points = points("fmm3dpy", FMM3D, problem, exact, &[&precisions])?;
    let meets = points.iter().filter(|point| point.len() == 3 && point[1] <= tolerance);
    let fastest = meets.min_by(|a, b| a[2].total_cmp(&b[2])).ok_or("no precision meets the tolerance")?;
    Ok(Peer { error: fastest[1], seconds: fastest[2], parameters: format!("eps {}", fastest[0]) })
}

/// Lines of numbers that a script prints about a problem's charges.
fn points(
    module: &str,
    script: &str,
    problem: &Charged,
    exact: &Exact,
    arguments: &[&str],
) -> Result<Vec<Vec<f64>>, String> {
    let environment = std::env::var_os(VARIABLE).map_or_else(|| PathBuf::from(FOLDER), PathBuf::from);
    let python = environment.join("bin/python");
    if !python.exists() {
        return Err(format!(
            "missing: no {} under {}; `cargo xtask bench --peers` installs it, {VARIABLE} names another environment",
            module,
            environment.display()
        ));
    }
    let cloud = std::env::temp_dir().join(format!("amberfield-peer-{}.bin", std::process::id()));
    write(&cloud, problem, exact).map_err(|error| format!("cannot write {}: {error}", cloud.display()))?;
    let mut command = Command::new(python);
    command.args(["-c", script]).arg(&cloud).args(arguments);
    command.env("LD_LIBRARY_PATH", environment.join("lib")).env("OMP_NUM_THREADS", "1").stdin(Stdio::null());
    let output = command.output();
    // A temporary file that stays is no harm.
    let _removed = std::fs::remove_file(&cloud);
    let output = output.map_err(|error| format!("cannot start {module}: {error}"))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{module} failed: {}", said.lines().last().unwrap_or("without a word")));
    }
    let numbers = |line: &str| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
    Ok(String::from_utf8_lossy(&output.stdout).lines().filter_map(numbers).collect())
}

/// The charges as the scripts read them: count, edge, diameter, then x y z q Ex Ey Ez with 4πε = 1.
fn write(path: &Path, problem: &Charged, exact: &Exact) -> std::io::Result<()> {
    let domain = problem.scene.domain.as_ref().expect("checked before");
    let coulomb = coulomb_constant(problem.settings.relative_permittivity);
    let largest = problem.scene.particles.radius.iter().copied().fold(0.0, f64::max);
    let mut writer = std::io::BufWriter::new(std::fs::File::create(path)?);
    let mut put = |number: f64| writer.write_all(&number.to_le_bytes());
    for number in [problem.charges.len() as f64, domain.extent().x, 2.0 * largest] {
        put(number)?;
    }
    for ((position, &charge), e) in problem.positions.iter().zip(&problem.charges).zip(&exact.e) {
        let (x, e) = (position - domain.min(), e / coulomb);
        for number in [x.x, x.y, x.z, charge, e.x, e.y, e.z] {
            put(number)?;
        }
    }
    writer.flush()
}
