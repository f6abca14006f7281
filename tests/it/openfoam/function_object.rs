//! Function object in another solver: Debian's DPMFoam on the Goldschmidt bed of OpenFOAM's examples.

use super::{copy_example, difference, good};
use amberfield_tests::{CsvTable, Workbench};

/// Folder of the bed among OpenFOAM's examples.
const EXAMPLE: &str = "lagrangian/DPMFoam/Goldschmidt";
const POTENTIAL: &str = "FoamFile { version 2.0; format ascii; class volScalarField; object phiE; }
dimensions [1 2 -3 0 0 -1 0];
internalField uniform 0;
boundaryField { \"(top|bottom|walls)\" { type fixedValue; value uniform 0; } frontAndBack { type symmetry; } }
";
const FUNCTION: &str =
    "functions { electricField { type electricField; libs (\"libelectricField.so\"); } }\n";
const SCENE: &str = "
[domain]
min_m = [-0.0075, -0.075, 0]
max_m = [0.0075, 0.075, 0.45]
boundary = { x = 'insulating', y = 'grounded', z = 'grounded' }
[[materials]]
name = 'glass'
density_kg_m3 = 2500.0
young_Pa = 5e5
poisson = 0.22
restitution = 0.6
friction = 0.3
[particles]
on_exit = 'delete'
[particles.generate]
material = 'glass'
count = 1000
radius_m = 1.25e-3
seed = 3
charge_C = { bipolar = 1e-11 }
region = { box = { min_m = [-0.0075, -0.075, 0.1], max_m = [0.0075, 0.075, 0.2] } }
[electric_field]
tuning = 'model'
[time]
step_s = 1e-5
end_s = 3e-4
gravity_m_s2 = [0, 0, -9.81]
[solver]
openfoam_case = 'foam'
[output]
history_every_s = 1e-5
";

/// Copy of the example with 10 steps of the gas, cut into two parts for two ranks.
fn bed() -> Workbench {
    let bench = Workbench::new(SCENE);
    copy_example(&bench, EXAMPLE);
    bench.write("foam/0/phiE", POTENTIAL);
    let change = |file: &str, changes: &[(&str, &str)]| {
        let text = changes.iter().fold(bench.read(file), |text, (old, new)| {
            assert!(text.contains(old), "{file} of the example has no {old}");
            text.replace(old, new)
        });
        bench.write(file, text);
    };
    change(
        "foam/system/decomposeParDict",
        &[("numberOfSubdomains 6;", "numberOfSubdomains 2;"), ("(1 6 1)", "(1 2 1)")],
    );
    change(
        "foam/system/controlDict",
        &[
            ("latestTime", "startTime"),
            ("endTime         5;", "endTime 2e-4;"),
            ("writeInterval   0.01;", "writeInterval 1e-4;"),
        ],
    );
    bench
}

fn run(bench: &Workbench, out: &str, options: &[&str]) -> CsvTable {
    good(&bench.run(&[&["run", "scene.toml", "--out", out, "--no-progress"], options].concat()));
    CsvTable::parse(&bench.read(&format!("{out}/history.csv"))).without_clocks()
}

#[test]
fn grains_in_dpmfoam_move_as_over_the_program_of_our_own() {
    let bench = bed();
    let own = run(&bench, "own", &[]);

    let controls = bench.read("foam/system/controlDict") + FUNCTION;
    bench.write("foam/system/controlDict", controls);
    let inside = ["--set", "solver.application=\"DPMFoam\""];
    assert_eq!(run(&bench, "inside", &inside), own, "one solver, one answer");
    let log = bench.read("inside/solver/log.DPMFoam");
    assert!(log.contains("Time = 0.0001\n") && log.contains("the grains' run is over"), "{log}");
    assert!(
        bench.path("inside/solver/0.0001/electricField:E").is_file(),
        "{:?}",
        bench.names("inside/solver")
    );

    // Two ranks, and grains that move longer than the gas: the solver continues to answer.
    let longer = ["--set", "solver.ranks=2", "--set", "time.end_s=1e-3"];
    let two = run(&bench, "two", &[&inside[..], &longer].concat());
    assert!(bench.read("two/solver/log.DPMFoam").contains("the solver has ended, the grains go on"));
    let energy = |table: &CsvTable| table.numbers("electric_J")[..own.rows.len()].to_vec();
    let error = difference(&energy(&two), &energy(&own));
    assert!(error < 1e-4, "one rank and two: {error:e}");
}

#[test]
fn potentials_that_change_are_those_of_the_grains_time_inside_another_solver() {
    let bench = bed();
    let energy = |table: &CsvTable| table.numbers("electric_J");
    let grounded = run(&bench, "grounded", &[]);
    let lid =
        "boundaryField { top { type uniformFixedValue; uniformValue table ((0 0) (1e-4 2e4) (3e-4 -1e4)); }";
    bench.write("foam/0/phiE", POTENTIAL.replace("boundaryField {", lid));
    let own = run(&bench, "own", &[]);
    let apart = difference(&energy(&own), &energy(&grounded));
    assert!(apart > 1e-3, "the lid is felt: {apart:e}");

    let controls = bench.read("foam/system/controlDict") + FUNCTION;
    bench.write("foam/system/controlDict", controls);
    assert_eq!(run(&bench, "inside", &["--set", "solver.application=\"DPMFoam\""]), own);
}

#[test]
fn a_function_object_without_a_run_says_what_to_set() {
    let bench = bed();
    let controls =
        bench.read("foam/system/controlDict") + &FUNCTION.replace("type", "run amberfield-0-none; type");
    bench.write("foam/system/controlDict", controls);
    let answer = bench.run(&["run", "scene.toml", "--out", "out", "--set", "solver.application=\"DPMFoam\""]);
    assert_eq!(answer.code, Some(3), "{}", answer.stderr);
    assert!(answer.stderr.contains("amberfield-0-none"), "{}", answer.stderr);
}
