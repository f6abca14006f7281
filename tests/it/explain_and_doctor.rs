//! Commands `amberfield explain` and `amberfield doctor`.

use crate::scenes::{CHARGED, PAIR, PAIR_CSV, plain};
use amberfield_tests::Workbench;

#[test]
fn explain_prints_plan_limits_and_both_forms() {
    let bench = Workbench::new(&CHARGED.replace("tuning = \"model\"", "field_cutoff_radius = 8e-4"));
    let answer = bench.run(&["explain", "scene.toml"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    for part in [
        "runs:",
        "left out:",
        "rayleigh",
        "memory:",
        "relative error",
        "method = \"p3m\"",
        "command = \"enable_electric_field ",
    ] {
        assert!(answer.stdout.contains(part), "{part}: {}", answer.stdout);
    }
    assert_eq!(bench.names("."), ["scene.toml"]);
}

#[test]
fn the_printed_forms_are_scenes_of_the_same_field() {
    let bench = Workbench::new(PAIR);
    bench.write("pair.csv", PAIR_CSV);
    let set = [
        "--set",
        "electric_field.field_cutoff_radius=0.1",
        "--set",
        "electric_field.relative_permittivity=2.5",
    ];
    let first = bench.run(&["explain", "scene.toml", set[0], set[1], set[2], set[3]]).stdout;
    let (_, rest) = first.split_once("electric field as keys:\n").unwrap();
    let (keys, rest) = rest.split_once("\n\n").unwrap();
    let (_, rest) = rest.split_once("electric field as one line:\n").unwrap();
    let (line, _) = rest.split_once("\n\n").unwrap();
    let head = PAIR.split_once("[electric_field]").unwrap().0;
    for section in [keys, line] {
        bench.write("scene.toml", format!("{head}{section}\n"));
        assert_eq!(bench.run(&["explain", "scene.toml"]).stdout, first);
    }
}

#[test]
fn explain_tells_which_limits_of_the_model_a_scene_runs_into() {
    let bench = Workbench::new(CHARGED);
    let plain = bench.run(&["explain", "scene.toml"]).stdout;
    assert!(!plain.contains("limit of the model"), "{plain}");
    let charging = CHARGED
        .replace("[electric_field]", "[electric_field]\nenable_collision_charge_transfer = true")
        .replace("young_Pa", "work_function_eV = 4.5\nyoung_Pa");
    bench.write("scene.toml", &charging);
    let answer = bench.run(&["explain", "scene.toml"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    for part in ["never at rest", "breakdown_field_V_m"] {
        assert!(answer.stdout.contains(part), "{part}: {}", answer.stdout);
    }
    assert!(!answer.stdout.contains("3/π²"), "{}", answer.stdout);
    bench.write("scene.toml", format!("{charging}\n[charge_transfer]\nbreakdown_field_V_m = 3e6\n"));
    let in_field = ["--set", "electric_field.external_field_V_m=[0,0,1e5]"];
    let grounded = ["--set", "walls.0.charging=grounded"];
    let options = ["explain", "scene.toml", in_field[0], in_field[1], grounded[0], grounded[1]];
    let answer = bench.run(&options);
    assert!(answer.stdout.contains("3/π²"), "{} {}", answer.stdout, answer.stderr);
    assert!(!answer.stdout.contains("no breakdown"), "{}", answer.stdout);
}

#[test]
fn explain_and_log_tell_what_the_step_costs_how_long_it_takes_and_where_walls_are() {
    let bench = Workbench::new(&plain());
    let answer = bench.run(&["explain", "scene.toml", "--set", "time.end_s=3e4"]).stdout;
    for part in
        ["restitution: ", "glass 0.8 acts as 0.8", "steps take some", "walls[0]", "normal [0.0, 0.0, 1.0]"]
    {
        assert!(answer.contains(part), "no {part:?} in {answer}");
    }
    assert!(!bench.run(&["explain", "scene.toml"]).stdout.contains("steps take some"));
    assert_eq!(bench.run(&["run", "scene.toml", "--out", "out", "--steps", "1"]).code, Some(0));
    let log = bench.read("out/log.jsonl");
    assert!(log.contains("walls[0]") && log.contains("plane through"), "{log}");
}

#[test]
fn a_scene_without_a_field_says_so() {
    let bench = Workbench::new(&plain());
    let answer = bench.run(&["explain", "scene.toml"]);
    assert!(answer.stdout.contains("no [electric_field]"), "{}", answer.stdout);
    assert!(answer.stdout.contains("0.0 kB for the field"), "{}", answer.stdout);
}

#[test]
fn doctor_knows_the_machine() {
    let bench = Workbench::new("");
    let answer = bench.run(&["doctor", "--threads", "2"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    for part in ["threads: 2", "memory:", "OpenFOAM", "stale runs: none"] {
        assert!(answer.stdout.contains(part), "{part}: {}", answer.stdout);
    }
}
