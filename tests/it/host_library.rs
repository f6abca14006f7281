//! C library in a host program: `crates/capi/examples/host.c`, compiled by the system's C compiler.

use super::openfoam::{AGREEMENT, difference};
use amberfield_core::{Boundary, Domain, FieldSettings, Tuning, Vector3};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_tests::Workbench;
use amberfield_tests::foam_case::{Random, cube, write_case};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const EDGE: f64 = 0.012;

/// Builds the library with the profile of this test, and the program with the library. The whole workspace
/// is named, as where the tests were built: for a part of it, crates would be compiled with other features.
fn host(bench: &Workbench) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut folder = std::env::current_exe().unwrap();
    folder.pop();
    folder.pop();
    let mut build = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    build.args(["build", "--quiet", "--workspace", "--all-targets"]).current_dir(&root);
    if folder.ends_with("release") {
        build.arg("--release");
    }
    assert!(build.env("CARGO_TARGET_DIR", folder.parent().unwrap()).status().unwrap().success());
    let program = bench.path("host");
    let mut compile = Command::new("cc");
    compile.args(["-std=c99", "-Wall", "-Wextra", "-Werror", "-I"]).arg(root.join("crates/capi/include"));
    compile.arg(root.join("crates/capi/examples/host.c")).arg(folder.join("libamberfield_capi.a"));
    compile.args(["-lgcc_s", "-lutil", "-lrt", "-lpthread", "-lm", "-ldl", "-o"]).arg(&program);
    assert!(compile.status().expect("a C compiler is there").success());
    program
}

fn run(program: &Path, arguments: &[&str], particles: &str) -> Output {
    let solver = amberfield_coupling::solver_program(false);
    let mut command = Command::new(program);
    // The field solver works below the host's own folder.
    let folder = program.parent().expect("the program is in a folder");
    command.args(arguments).current_dir(folder).env("AMBERFIELD_SOLVER", solver);
    let mut child =
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    child.stdin.take().unwrap().write_all(particles.as_bytes()).unwrap();
    child.wait_with_output().unwrap()
}

/// Fields and potentials that the program printed.
fn values(output: &Output) -> (Vec<f64>, Vec<f64>) {
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout);
    let numbers = |line: &str| line.split(' ').map(|word| word.parse().unwrap()).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = text.lines().map(numbers).collect();
    (rows.iter().flat_map(|row| row[..3].to_vec()).collect(), rows.iter().map(|row| row[3]).collect())
}

#[test]
fn a_host_program_gets_the_field_from_the_grid_and_from_openfoam() {
    let bench = Workbench::new("");
    let program = host(&bench);
    let mut random = Random(5);
    let positions: Vec<Vector3<f64>> =
        (0..1500).map(|_| Vector3::from_fn(|_, _| EDGE * (0.02 + 0.96 * random.number()))).collect();
    let charges: Vec<f64> = (0..1500).map(|i| if i % 2 == 0 { 1e-12 } else { -1e-12 }).collect();
    let mut particles = String::new();
    for (p, q) in positions.iter().zip(&charges) {
        writeln!(particles, "{} {} {} {q}", p.x, p.y, p.z).unwrap();
    }
    let edge = EDGE.to_string();
    let (grid, potential) = values(&run(&program, &[&edge], &particles));

    // The same field from Rust is equal to the last digit.
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(EDGE), [[Boundary::Grounded; 2]; 3]).unwrap();
    let settings = FieldSettings { tuning: Tuning::Model, ..FieldSettings::default() };
    let mut field = ElectricField::new(&domain, &settings, &positions, &charges).unwrap();
    let mut expected = FieldValues::default();
    let wanted = Wanted { potential: true, ..Wanted::default() };
    field.evaluate(&positions, &charges, wanted, &mut expected).unwrap();
    assert_eq!(grid, expected.e.iter().flat_map(|e| [e.x, e.y, e.z]).collect::<Vec<_>>());
    assert_eq!(potential, expected.potential);

    write_case(
        &bench,
        &cube(1e3 * EDGE, 12, 1.0),
        "wall { type fixedValue; value uniform 0; }",
        "Gauss linear",
    );
    let case = bench.path("foam").display().to_string();
    let (over_mesh, _) = values(&run(&program, &[&edge, &case], &particles));
    let error = difference(&over_mesh, &grid);
    assert!(error < AGREEMENT, "{error:e}");
}

#[test]
fn a_host_program_is_told_what_is_wrong() {
    let bench = Workbench::new("");
    let program = host(&bench);
    for (arguments, particles, expected) in [
        (["-1", ""], "", "-1"),
        (["0.012", ""], "0.001 0.001 nan 1e-12\n", "not finite"),
        (["0.012", "no such case"], "0.001 0.001 0.001 1e-12\n", "no such case"),
    ] {
        let arguments: Vec<&str> = arguments.into_iter().filter(|word| !word.is_empty()).collect();
        let output = run(&program, &arguments, particles);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{said}");
        assert!(said.contains(expected), "{said}");
    }
}
