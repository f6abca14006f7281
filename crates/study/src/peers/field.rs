//! The field of a problem's charges by other programs, where `cargo xtask bench --peers` has installed them.

use super::{Environment, SHARES, Script, fastest, pppm_sweep, write_numbers};
use crate::sweep::{Exact, Peer};
use amberfield_core::{Axis, Boundary, Domain, Permittivity, Vector3};
use std::path::PathBuf;

/// Folder of the environment, unless [`VARIABLE`] names another.
const FOLDER: &str = "target/peers";
/// Variable that names another environment.
const VARIABLE: &str = "AMBERFIELD_PEERS";
/// Shares of the tolerance asked of FMM3D, which errs far less than what is asked of it. Its error is
/// measured.
const PRECISIONS: [f64; 4] = [50.0, 10.0, 2.0, 0.5];

/// Charges whose field another program is to compute.
#[derive(Clone, Copy, Debug)]
pub struct PeerProblem<'a> {
    /// Box of the charges.
    pub domain: &'a Domain,
    /// Medium.
    pub permittivity: Permittivity,
    /// Positions [m].
    pub positions: &'a [Vector3<f64>],
    /// Charges [C].
    pub charges: &'a [f64],
    /// Diameter of the largest grain [m], the unit of the cut-offs that are swept.
    pub diameter_m: f64,
}

/// Measures `pppm` or `msm` (LAMMPS, periodic boxes) or `fmm3d` (open space)
/// and returns its fastest setting whose error against the exact field is at most the tolerance.
///
/// # Errors
/// Boundaries that the program does not have, a program that is not installed, no setting that is good
/// enough.
pub fn measure_field(
    program: &str,
    problem: &PeerProblem<'_>,
    exact: &Exact,
    tolerance: f64,
) -> Result<Peer, String> {
    let all = |face: Boundary| Axis::ALL.iter().all(|axis| problem.domain.faces()[axis.index()] == [face; 2]);
    match program {
        "pppm" | "msm" if all(Boundary::Periodic) => lammps(program, problem, exact, tolerance),
        "fmm3d" if all(Boundary::Open) => fmm3d(problem, exact, tolerance),
        "pppm" | "msm" | "fmm3d" => Err(format!("{program} has no such boundaries")),
        other => Err(format!("unknown program {other:?}; give pppm, msm or fmm3d")),
    }
}

/// LAMMPS, the fastest of a sweep over cut-off, order and way of differentiation, its neighbour list kept.
fn lammps(style: &str, problem: &PeerProblem<'_>, exact: &Exact, tolerance: f64) -> Result<Peer, String> {
    let (cutoffs, orders) = match style {
        "msm" if tolerance > 2e-3 => ("3,4,5,6", "4,6,8,10"),
        "msm" => ("5,6,8", "8,10"),
        _ => pppm_sweep(tolerance),
    };
    let arguments = [&tolerance.to_string(), cutoffs, orders, SHARES, style];
    let points = points(Script::LammpsField, problem, exact, &arguments)?;
    let fastest = fastest(Script::LammpsField, &points, tolerance)
        .ok_or("no setting of the sweep meets the tolerance")?;
    Ok(Peer {
        error: fastest[4],
        seconds: fastest[5],
        parameters: format!("cut-off {:.3e} m, order {}", fastest[0], fastest[1]),
    })
}

fn fmm3d(problem: &PeerProblem<'_>, exact: &Exact, tolerance: f64) -> Result<Peer, String> {
    let precisions = PRECISIONS.map(|share| (share * tolerance).to_string()).join(",");
    let points = points(Script::Fmm3d, problem, exact, &[&precisions])?;
    let fastest = fastest(Script::Fmm3d, &points, tolerance).ok_or("no precision meets the tolerance")?;
    Ok(Peer { error: fastest[1], seconds: fastest[2], parameters: format!("eps {}", fastest[0]) })
}

/// Lines of numbers that a script prints about a problem's charges.
fn points(
    script: Script,
    problem: &PeerProblem<'_>,
    exact: &Exact,
    arguments: &[&str],
) -> Result<Vec<Vec<f64>>, String> {
    let folder = std::env::var_os(VARIABLE).map_or_else(|| PathBuf::from(FOLDER), PathBuf::from);
    let environment = Environment::at(&folder).ok_or_else(|| {
        format!(
            "missing: no {} under {}; `cargo xtask bench --peers` installs it, {VARIABLE} names another \
             environment",
            script.module(),
            folder.display()
        )
    })?;
    let cloud = std::env::temp_dir().join(format!("amberfield-peer-{}.bin", std::process::id()));
    write_numbers(&cloud, numbers(problem, exact))
        .map_err(|error| format!("cannot write {}: {error}", cloud.display()))?;
    let lines = environment.run(script, 1, &[&[&*cloud.to_string_lossy()], arguments].concat());
    // A temporary file that stays is no harm.
    let _removed = std::fs::remove_file(&cloud);
    lines
}

/// The charges as the scripts read them: count, edge, diameter, then x y z q Ex Ey Ez with 4πε = 1.
fn numbers(problem: &PeerProblem<'_>, exact: &Exact) -> Vec<f64> {
    let domain = problem.domain;
    let coulomb = problem.permittivity.coulomb();
    let mut numbers = vec![problem.charges.len() as f64, domain.extent().x, problem.diameter_m];
    for ((position, &charge), e) in problem.positions.iter().zip(problem.charges).zip(&exact.e) {
        let (x, e) = (position - domain.min(), e / coulomb);
        numbers.extend([x.x, x.y, x.z, charge, e.x, e.y, e.z]);
    }
    numbers
}
