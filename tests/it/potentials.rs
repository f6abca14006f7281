//! Potentials and an external field that change with time, by the command.

use crate::scenes::CHARGED;
use amberfield_tests::{CsvTable, Workbench};

/// Scene of charged grains, whose upper face has a potential over time.
fn with_potential(course: &str) -> Workbench {
    let faces = format!("z_min = \"grounded\"\nz_max = {{ potential_V = {course} }}");
    Workbench::new(&CHARGED.replacen("z = \"grounded\"", &faces, 1))
}

fn alternating() -> Workbench {
    let bench = with_potential("{ table = \"v.csv\" }");
    bench.write("v.csv", "t_s,potential_V\n0,0\n2e-4,300\n5e-4,-200\n");
    bench
}

const SET: [&str; 2] = [
    "--set",
    "electric_field.external_field_V_m={ amplitude = [0, 0, 1e5], frequency_Hz = 2e3, phase_rad = 0.5 }",
];

#[test]
fn a_run_in_alternating_fields_goes_on_bit_for_bit_and_its_energy_is_no_fault() {
    let bench = alternating();
    let run = |options: &[&str]| {
        let answer = bench.run(&[&["run", "scene.toml"], &SET[..], options].concat());
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    };
    run(&["--out", "whole", "--steps", "400"]);
    run(&["--out", "part", "--steps", "170"]);
    let checkpoint = "part/checkpoints/step_000000000170.amber";
    run(&["--out", "part", "--resume", checkpoint, "--steps", "230"]);
    let history =
        |folder: &str| CsvTable::parse(&bench.read(&format!("{folder}/history.csv"))).without_clocks();
    assert_eq!(history("part"), history("whole"));
}

#[test]
fn explain_names_what_changes_and_how_it_is_followed() {
    let bench = alternating();
    let answer = bench.run(&[&["explain", "scene.toml"], &SET[..]].concat());
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    for part in ["at the potential of v.csv, 3 rows", "frequency_Hz = 2000.0", "exact in every step"] {
        assert!(answer.stdout.contains(part), "{part}: {}", answer.stdout);
    }
}

#[test]
fn field_takes_what_is_there_at_the_start() {
    let bench = alternating();
    let field = |set: &str, name: &str| {
        let answer = bench.run(&["field", "scene.toml", "--set", set, "--out", name]);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        bench.read(name)
    };
    let key = "electric_field.external_field_V_m";
    let constant = field(&format!("{key}=[0, 0, 3e4]"), "constant.csv");
    let course = format!("{key}={{ amplitude = [0, 0, 1e5], frequency_Hz = 50, offset = [0, 0, 3e4] }}");
    assert_eq!(field(&course, "course.csv"), constant);
}

#[test]
fn courses_that_make_no_sense_are_refused_before_anything_runs() {
    for (course, parts) in [
        ("{ table = \"flat.csv\" }", &["flat.csv:3", "must rise"][..]),
        ("{ amplitude = 1, frequency_Hz = 0 }", &["potential_V.frequency_Hz"]),
        ("{ amplitude = 1, frequency_Hz = 1e9 }", &["time.step_s", "1.000e9 Hz"]),
    ] {
        let bench = with_potential(course);
        bench.write("flat.csv", "t_s,potential_V\n0,0\n0,1\n");
        let answer = bench.run(&["run", "scene.toml", "--out", "out"]);
        assert_eq!(answer.code, Some(2), "{course}: {}", answer.stderr);
        for part in parts {
            assert!(answer.stderr.contains(part), "{course}: {part}: {}", answer.stderr);
        }
        assert!(!bench.path("out").exists(), "{course}: nothing is written");
    }
}
