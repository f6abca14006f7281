//! Files of results: everything that stands in them stands in the table of files, and on its page.

use crate::scenes::CHARGED;
use amberfield_scene::files::{self, FileTable, Form};
use amberfield_tests::Workbench;
use serde_json::Value;
use std::collections::BTreeSet;

/// Feed of the scene.
const FEED: &str = "\n[[feeds]]\nname = \"more\"\nrate_per_s = 1e4\ncount = 2\nradius_m = 1e-4\n\
    region = { box = { min_m = [5e-4, 5e-4, 2.5e-3], max_m = [1.5e-3, 1.5e-3, 3.5e-3] } }\n";

/// Outlet of the scene, beside its feed.
const OUTLET: &str = "\n[[outlets]]\nname = \"bin\"\neach = true\n\
    region = { box = { min_m = [1.5e-3, 0, 0], max_m = [2e-3, 2e-3, 2e-3] } }\n";

/// Scene with everything on that needs no OpenFOAM.
fn everything() -> String {
    let walls = "material = \"glass\"\ncharging = \"insulating\"\n[[walls]]";
    CHARGED
        .replacen(
            "[[walls]]\nplane = { point_m = [0, 0, 3.99e-3]",
            &format!("{walls}\nplane = {{ point_m = [0, 0, 3.99e-3]"),
            1,
        )
        .replace(
            "normal = [0, 0, -1] }",
            "normal = [0, 0, -1] }\n\
             motion = [{ vibrate = { amplitude_m = [0, 0, 1e-6], frequency_Hz = 50 } }]",
        )
        .replace("friction = 0.3\n", "friction = 0.3\nwork_function_eV = 4.5\n")
        .replace("x = \"periodic\"", "x = \"open\"")
        .replace("[particles.generate]", "[particles]\non_exit = \"delete\"\n[particles.generate]")
        .replace("end_s = 2e-3", "end_s = 4e-4")
        .replace(
            "tuning = \"model\"",
            "tuning = \"model\"\ncoupling_interval = 1\nlimit_field_force = true\n\
             enable_collision_charge_transfer = true\n[gas]",
        )
        .replace("[\"vtk\", \"csv\"]", "[\"vtk\", \"csv\", \"png\"]")
        .replace("velocity_m_s = [0.1,", "velocity_m_s = [2.0,")
        + FEED
        + OUTLET
}

/// Paths of all files in a folder and below, from the folder.
fn paths(bench: &Workbench, folder: &str) -> Vec<String> {
    let names = bench.names(folder);
    let of = |name: String| {
        let path = format!("{folder}/{name}");
        if bench.path(&path).is_dir() { paths(bench, &path) } else { vec![path] }
    };
    names.into_iter().flat_map(of).collect()
}

/// Keys of a JSON value with those of the objects in it, joined by dots. Numbers and lists are values, and so
/// are parameters, whose keys depend on their kind.
fn keys(before: &str, value: &Value) -> Vec<String> {
    match value {
        Value::Object(map) if !map.is_empty() && !before.ends_with("parameters") => map
            .iter()
            .flat_map(|(key, below)| {
                keys(&if before.is_empty() { key.clone() } else { format!("{before}.{key}") }, below)
            })
            .collect(),
        _ => vec![before.to_owned()],
    }
}

/// Columns, arrays or keys of a file as it stands on the disk.
fn headings(bench: &Workbench, path: &str, file: &FileTable) -> Vec<String> {
    let bytes = std::fs::read(bench.path(path)).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    let first = text.lines().next().unwrap_or_default();
    match file.form {
        Form::Csv => first.split(',').map(str::to_owned).collect(),
        Form::Json if path.ends_with(".jsonl") => {
            text.lines().flat_map(|line| keys("", &serde_json::from_str(line).unwrap())).collect()
        }
        Form::Json => keys("", &serde_json::from_str(&text).unwrap()),
        Form::Vtu => {
            let names = text.split(" Name=\"").skip(1).filter_map(|rest| rest.split('"').next());
            names.map(str::to_owned).collect()
        }
        Form::Other => Vec::new(),
    }
}

/// Checks all files of a folder; returns the paths of the tables that were met.
fn check(bench: &Workbench, folder: &str) -> BTreeSet<&'static str> {
    let mut met = BTreeSet::new();
    for path in paths(bench, folder) {
        let file = files::find(&path).unwrap_or_else(|| panic!("{path} is not in the table of files"));
        met.insert(file.path);
        let found = headings(bench, &path, file);
        for name in &found {
            assert!(file.has(name), "{path}: {name} is not in the table of {}", file.path);
        }
        // The scene has everything on, so that nothing of the table may be missing either.
        for name in file
            .names(|_| true)
            .filter(|name| ["STAGE", "NAME", "OUTLET", "WALL"].iter().all(|word| !name.contains(word)))
        {
            let is_of_others =
                ["solver_iterations", "energies_at_end", "field", "field_intervals", "limited", "books"];
            let is_there = found.iter().any(|other| other == name) || is_of_others.contains(&name);
            assert!(is_there || name.contains("LIMIT"), "{path}: {name} is in the table and not in the file");
        }
    }
    met
}

#[test]
fn every_file_of_every_command_is_in_the_table_with_all_that_it_holds() {
    let bench = Workbench::new(&everything());
    let run = bench.run(&["run", "scene.toml", "--threads", "1", "--out", "run"]);
    assert_eq!(run.code, Some(0), "{}", run.stderr);
    assert!(bench.read("run/exits.csv").lines().count() > 1, "no grain left");
    let mut met = check(&bench, "run");

    std::fs::create_dir(bench.path("field")).unwrap();
    let field = ["field", "scene.toml", "--threads", "1", "--components", "--out", "field/a-field.csv"];
    for arguments in [&field[..], &["tune", "scene.toml", "--threads", "1", "--out", "field/a-tune.csv"]] {
        let answer = bench.run(arguments);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    }
    met.extend(check(&bench, "field"));

    // A plain box, since a study computes it many times.
    bench.write("box.toml", CHARGED);
    bench.write(
        "study.toml",
        "name = 'all'\ntitle = 'All'\npasses = 1\nleast_s = 0.0\n\
         [[problems]]\nname = 'a box'\nscene = 'box.toml'\n\
         [[methods]]\nname = 'p3m'\n\
         [[motions]]\nname = 'falling'\nscene = 'box.toml'\n\
         set = ['time.end_s=2e-5', 'time.gravity_m_s2=[0,0,0]']\n\
         reference = ['electric_field.tolerance=1e-3']\n\
         replicas = { key = 'particles.generate.seed', values = [2, 3] }\n\
         [[motions.variants]]\nname = 'tolerance'\n\
         [[extremes]]\nname = 'short'\nscene = 'box.toml'\nset = ['time.end_s=2e-5']\nexpect = 'ends'\n\
         ends = 'well'\n",
    );
    let study = bench.run(&["study", "study.toml", "--threads", "1", "--out", "study"]);
    assert_eq!(study.code, Some(0), "{}", study.stderr);
    met.extend(check(&bench, "study"));

    let all = files::FILES.iter().flat_map(|(_, files)| files.iter()).map(|file| file.path);
    let missing: Vec<&str> = all.filter(|path| !met.contains(path) && *path != "run.lock").collect();
    assert!(missing.is_empty(), "in the table, but not written: {missing:?}");
}

#[test]
fn a_file_is_shown_in_the_terminal() {
    let bench = Workbench::new("");
    let shown = bench.run(&["keys", "run/wall_forces.csv"]);
    assert!(shown.code == Some(0) && shown.stdout.contains("torque_x_N_m"), "{}", shown.stdout);
    assert_eq!(bench.run(&["keys", "wall_force.csv"]).code, Some(2));
}
