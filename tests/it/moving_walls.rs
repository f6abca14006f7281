//! Walls that move, by the command: what is written, what goes on, and what is refused.

use crate::scenes::{CHARGED, plain};
use amberfield_tests::{CsvTable, Workbench};

const FLOOR: &str = "plane = { point_m = [0, 0, 1e-5], normal = [0, 0, 1] }";

/// A scene whose floor has a motion.
fn with(scene: &str, motion: &str) -> String {
    assert!(scene.contains(FLOOR));
    scene.replacen(FLOOR, &format!("{FLOOR}\nmotion = [{motion}]"), 1)
}

#[test]
fn walls_that_move_are_written_and_a_run_goes_on_bit_for_bit() {
    let shake =
        "{ table = \"motion.csv\" }, { vibrate = { amplitude_m = [0, 0, 2e-5], frequency_Hz = 300 } }";
    let bench = Workbench::new(&with(&plain(), shake));
    bench.write("motion.csv", "t_s,x_m,z_m,ry_rad\n0,0,0,0\n1e-3,1e-4,1e-5,0.01\n3e-3,0,1e-5,0\n");
    let whole = bench.run(&["run", "scene.toml", "--out", "whole"]);
    assert_eq!(whole.code, Some(0), "{}", whole.stderr);
    let part = bench.run(&["run", "scene.toml", "--out", "part", "--steps", "430"]);
    assert_eq!(part.code, Some(0), "{}", part.stderr);
    let checkpoint = "part/checkpoints/step_000000000430.amber";
    let rest = bench.run(&["run", "scene.toml", "--out", "part", "--resume", checkpoint]);
    assert_eq!(rest.code, Some(0), "{}", rest.stderr);
    let history =
        |folder: &str| CsvTable::parse(&bench.read(&format!("{folder}/history.csv"))).without_clocks();
    assert_eq!(history("part"), history("whole"));
    assert!(history("whole").numbers("wall_work_J").last().is_some_and(|work| *work != 0.0));
    for table in ["wall_forces.csv", "walls.pvd"] {
        assert_eq!(bench.read(&format!("part/{table}")), bench.read(&format!("whole/{table}")), "{table}");
    }
    let frames = bench.names("whole/walls");
    assert_eq!((frames.len(), bench.names("part/walls")), (9, frames));
    assert!(bench.read("whole/walls.pvd").contains("part=\"1\" file=\"walls/surface_000000000000.vtu\""));
}

#[test]
fn motion_without_speed_changes_nothing_but_its_columns() {
    let run = |scene: &str| {
        let bench = Workbench::new(scene);
        let answer = bench.run(&["run", "scene.toml", "--out", "out", "--threads", "2"]);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        let name = bench.names("out/particles").into_iter().rfind(|name| name.ends_with(".csv")).unwrap();
        bench.read(&format!("out/particles/{name}"))
    };
    assert_eq!(run(&with(CHARGED, "{ velocity_m_s = [0, 0, 0] }")), run(CHARGED));
}

#[test]
fn motions_that_make_no_sense_are_refused_before_anything_runs() {
    for (motion, parts) in [
        ("{ rotate = { rpm = 3 } }", &["walls[0].motion[0].rotate.axis"][..]),
        ("{ rotate = { axis = [0, 0, 0], rpm = 3 } }", &["axis", "no direction"]),
        ("{ start_s = 1.0 }", &["walls[0].motion[0].rotate", "vibrate"]),
        (
            "{ velocity_m_s = [0, 0, 1], servo = { force_N = 1, direction = [0, 0, 1], most_m_s = 1 } }",
            &["table of its own"],
        ),
        ("{ velocity_m_s = [0, 0, 1], start_s = 1.0, end_s = 0.5 }", &["end_s = 0.5", "later"]),
        ("{ velocity_m_s = [0, 0, -100] }", &["wall motion", "step_s smaller"]),
        ("{ wiggle = 1 }", &["walls[0].motion[0].vibrate"]),
        ("{ table = \"none.csv\" }", &["there is no file"]),
        ("{ table = \"flat.csv\" }", &["flat.csv:3", "must rise"]),
        ("{ table = \"inside.csv\" }", &["overlap"]),
    ] {
        let bench = Workbench::new(&with(&plain(), motion));
        bench.write("flat.csv", "t_s,x_m\n0,0\n0,0\n");
        bench.write("inside.csv", "t_s,z_m\n0,2e-3\n1,2e-3\n");
        let answer = bench.run(&["run", "scene.toml", "--out", "out"]);
        assert_eq!(answer.code, Some(2), "{motion}: {}", answer.stderr);
        for part in parts {
            assert!(answer.stderr.contains(part), "{motion}: {part}: {}", answer.stderr);
        }
        assert!(!bench.path("out").exists(), "{motion}: nothing is written");
    }
}

#[test]
fn surface_in_millimetres_asks_for_its_scale() {
    let corner = |x: f64, y: f64| format!("vertex {x} {y} 0\n");
    let facet = format!(
        "solid\nfacet normal 0 0 1\nouter loop\n{}{}{}endloop\nendfacet\nendsolid\n",
        corner(-5.0, -5.0),
        corner(5.0, -5.0),
        corner(0.0, 5.0)
    );
    let bench = Workbench::new(&plain().replacen(FLOOR, "stl = \"plate.stl\"", 1));
    bench.write("plate.stl", facet);
    let answer = bench.run(&["run", "scene.toml", "--out", "out"]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("walls[0].stl") && answer.stderr.contains("scale = 1e-3"),
        "{}",
        answer.stderr
    );
}

#[test]
fn grounded_wall_that_moves_is_warned_of_once_and_one_that_keeps_charge_takes_it_along() {
    let moving = with(CHARGED, "{ velocity_m_s = [0, 0, 0.01] }");
    let count = |scene: &str, words: &str| {
        let bench = Workbench::new(scene);
        let answer = bench.run(&["run", "scene.toml", "--out", "out", "--steps", "50"]);
        (answer.code, answer.stderr.matches(words).count(), answer.stderr)
    };
    let grounded = moving.replacen(FLOOR, &format!("{FLOOR}\ncharging = \"grounded\""), 1);
    let (code, warned, said) = count(&grounded, "does not bound the field");
    assert_eq!((code, warned), (Some(0), 1), "{said}");
    let keeps = moving
        .replacen(FLOOR, &format!("{FLOOR}\ncharging = \"insulating\""), 1)
        .replace("rolling_friction = 0.01", "rolling_friction = 0.01\nwork_function_eV = 4.0")
        .replace("tolerance = 1e-2", "tolerance = 1e-2\nenable_collision_charge_transfer = true");
    let (code, _, said) = count(&keeps, "");
    assert_eq!(code, Some(0), "{said}");
}
