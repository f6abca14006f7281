//! Command `amberfield run`.

use crate::scenes::{CHARGED, plain};
use amberfield_tests::{CsvTable, Workbench};

/// Text of the last particle file.
fn last_frame(bench: &Workbench, folder: &str) -> String {
    let names = bench.names(&format!("{folder}/particles"));
    let last = names.iter().rfind(|name| name.ends_with(".csv")).unwrap();
    bench.read(&format!("{folder}/particles/{last}"))
}

#[test]
fn a_run_writes_what_it_promises() {
    let bench = Workbench::new(CHARGED);
    let answer = bench.run(&["run", "scene.toml", "--out", "out", "--threads", "2"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    assert_eq!(answer.stdout.lines().count(), 2, "{}", answer.stdout);
    let names = bench.names("out");
    for name in ["scene.toml", "log.jsonl", "history.csv", "particles.pvd", "summary.json", "tuning.json"] {
        assert!(names.contains(&name.to_owned()), "{name} of {names:?}");
    }
    assert!(!names.contains(&"run.lock".to_owned()));
    assert_eq!(bench.names("out/checkpoints").len(), 4);
    assert_eq!(bench.names("out/particles").len(), 2 * 9);
    let history = CsvTable::parse(&bench.read("out/history.csv"));
    let expected = "step,time_s,kinetic_J,contact_J,gravity_J,electric_J,net_charge_C,contacts,wall_s";
    assert_eq!(history.columns[..9].join(","), expected);
    assert!(history.columns[9..].iter().all(|column| column.starts_with("wall_s_")));
    assert_eq!(history.rows.len(), 1001);
    let steps = history.numbers("step");
    assert!(steps.windows(2).all(|pair| pair[0] < pair[1]));
    assert_eq!(steps.last(), Some(&1000.0));
    let forces = CsvTable::parse(&bench.read("out/wall_forces.csv"));
    assert_eq!((forces.rows.len(), &forces.numbers("wall")[..3]), (2002, &[0.0, 1.0, 0.0][..]));
    let summary: serde_json::Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!((summary["ending"].as_str(), summary["grains"].as_u64()), (Some("complete"), Some(60)));
    for line in bench.read("out/log.jsonl").lines() {
        let _: serde_json::Value = serde_json::from_str(line).unwrap();
    }
}

#[test]
fn columns_without_a_stage_are_not_there() {
    let bench = Workbench::new(&plain());
    let answer = bench.run(&[
        "run",
        "scene.toml",
        "--out",
        "out",
        "--steps",
        "20",
        "--set",
        "time.gravity_m_s2=[0,0,0]",
    ]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let history = CsvTable::parse(&bench.read("out/history.csv"));
    assert_eq!(history.without_clocks().columns, ["step", "time_s", "kinetic_J", "contact_J", "contacts"]);
    assert!(!bench.names("out").contains(&"tuning.json".to_owned()));
}

#[test]
fn a_continued_run_is_bitwise_the_uninterrupted_one() {
    let bench = Workbench::new(CHARGED);
    assert_eq!(bench.run(&["run", "scene.toml", "--out", "whole"]).code, Some(0));
    // 377 lies on no schedule.
    assert_eq!(bench.run(&["run", "scene.toml", "--out", "parts", "--steps", "377"]).code, Some(0));
    let checkpoint = "parts/checkpoints/step_000000000377.amber";
    let answer = bench.run(&["run", "scene.toml", "--resume", checkpoint, "--steps", "250"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let checkpoint = "parts/checkpoints/step_000000000627.amber";
    // The run folder's own scene is the same scene.
    let answer = bench.run(&["run", "parts/scene.toml", "--out", "parts", "--resume", checkpoint]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let history =
        |folder: &str| CsvTable::parse(&bench.read(&format!("{folder}/history.csv"))).without_clocks();
    assert_eq!(history("parts"), history("whole"));
    assert_eq!(bench.read("parts/wall_forces.csv"), bench.read("whole/wall_forces.csv"));
    assert_eq!(last_frame(&bench, "parts"), last_frame(&bench, "whole"));
    assert_eq!(bench.names("parts/particles"), bench.names("whole/particles"));
    assert_eq!(bench.read("parts/particles.pvd"), bench.read("whole/particles.pvd"));
}

#[test]
fn a_run_goes_on_from_an_older_checkpoint_and_to_a_later_end() {
    let bench = Workbench::new(CHARGED);
    let later = ["--set", "time.end_s=2.5e-3"];
    assert_eq!(bench.run(&["run", "scene.toml", "--out", "out"]).code, Some(0));
    let before = CsvTable::parse(&bench.read("out/history.csv")).without_clocks();
    let older = "out/checkpoints/step_000000000250.amber";
    let answer = bench.run(&["run", "scene.toml", "--resume", older, later[0], later[1]]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let after = CsvTable::parse(&bench.read("out/history.csv")).without_clocks();
    assert_eq!(after.rows[..before.rows.len()], before.rows);
    assert_eq!(after.numbers("step").last(), Some(&1250.0));
}

#[test]
fn an_end_that_is_a_multiple_of_the_intervals_is_written_once() {
    // 0.1·3 is not 0.3, and neither is a whole number of the steps.
    let scene = plain()
        .replace("step_s = 2e-6", "step_s = 1.7e-6")
        .replace("end_s = 2e-3", "end_s = 0.3e-3")
        .replace("every_s = 2.5e-4", "every_s = 0.1e-3\nhistory_every_s = 0.1e-3")
        .replace("checkpoint_every_s = 5e-4", "checkpoint_every_s = 0.1e-3");
    let bench = Workbench::new(&scene);
    let steps_of = |folder: &str| {
        let step = |name: &String| name.split(['_', '.']).nth(1).unwrap().parse::<u64>().unwrap();
        let csv = |name: &&String| name.ends_with(".csv");
        let frames = bench.names(&format!("{folder}/particles"));
        let frames: Vec<u64> = frames.iter().filter(csv).map(step).collect();
        let saved: Vec<u64> = bench.names(&format!("{folder}/checkpoints")).iter().map(step).collect();
        let rows = CsvTable::parse(&bench.read(&format!("{folder}/history.csv"))).numbers("step");
        let forces = CsvTable::parse(&bench.read(&format!("{folder}/wall_forces.csv"))).numbers("step");
        let listed = bench.read(&format!("{folder}/particles.pvd")).matches("<DataSet").count();
        (frames, saved, rows, forces, listed)
    };
    assert_eq!(bench.run(&["run", "scene.toml", "--out", "whole"]).code, Some(0));
    let (frames, saved, rows, forces, listed) = steps_of("whole");
    // The first steps at 0.1, 0.2 and 0.3 ms.
    assert_eq!(frames, [0, 59, 118, 177]);
    assert_eq!((saved, listed), (vec![59, 118, 177], 4));
    assert_eq!(rows, [0.0, 59.0, 118.0, 177.0]);
    assert_eq!(forces, rows.iter().flat_map(|row| [*row; 2]).collect::<Vec<_>>());
    // A run that has ended is asked to go on, one that stopped where all is due goes on, and a later end has
    // what an earlier one had.
    let whole = steps_of("whole");
    let resume = |from: &str, set: &str| {
        let arguments = ["run", "scene.toml", "--out", "parts", "--resume", from, "--set", set];
        let answer = bench.run(&arguments);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    };
    assert_eq!(bench.run(&["run", "scene.toml", "--out", "parts", "--steps", "118"]).code, Some(0));
    resume("parts/checkpoints/step_000000000118.amber", "time.end_s=0.2e-3");
    resume("parts/checkpoints/step_000000000118.amber", "time.end_s=0.3e-3");
    resume("parts/checkpoints/step_000000000177.amber", "time.end_s=0.3e-3");
    assert_eq!(steps_of("parts"), whole);
    resume("parts/checkpoints/step_000000000177.amber", "time.end_s=0.4e-3");
    let (frames, _, rows, _, listed) = steps_of("parts");
    assert_eq!((frames, listed), (vec![0, 59, 118, 177, 236], 5));
    assert_eq!(rows.len(), 5);
}

#[test]
fn a_run_says_how_it_computes_the_field_in_words() {
    for (method, words) in [
        ("\"direct\"", "electric field: the direct sum"),
        ("\"cutoff\"", "electric field: cut-off 5.0000e-4 m"),
    ] {
        let more = if method.contains("cutoff") { "\nfield_cutoff_radius = 5e-4" } else { "" };
        let scene =
            CHARGED.replace("tolerance = 1e-2\ntuning = \"model\"", &format!("method = {method}{more}"));
        let bench = Workbench::new(&scene);
        let answer = bench.run(&["run", "scene.toml", "--out", "out", "--steps", "2"]);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        assert!(answer.stderr.contains(words), "{}", answer.stderr);
        let braces =
            answer.stderr.lines().filter(|line| line.contains("electric field") && line.contains('{'));
        assert_eq!(braces.count(), 0, "{}", answer.stderr);
    }
}

#[test]
fn thread_counts_do_not_change_results() {
    let bench = Workbench::new(CHARGED);
    for threads in ["1", "3"] {
        let arguments = ["run", "scene.toml", "--out", threads, "--threads", threads, "--steps", "300"];
        assert_eq!(bench.run(&arguments).code, Some(0));
    }
    assert_eq!(last_frame(&bench, "1"), last_frame(&bench, "3"));
}

#[test]
fn an_existing_run_folder_is_kept_unless_asked() {
    let bench = Workbench::new(&plain());
    let first = ["run", "scene.toml", "--out", "out", "--steps", "5"];
    assert_eq!(bench.run(&first).code, Some(0));
    let again = bench.run(&first);
    assert_eq!(again.code, Some(2));
    assert!(again.stderr.contains("--resume") && again.stderr.contains("--overwrite"), "{}", again.stderr);
    let overwrite = ["run", "scene.toml", "--out", "out", "--steps", "7", "--overwrite"];
    assert_eq!(bench.run(&overwrite).code, Some(0));
    assert_eq!(bench.names("out/checkpoints"), ["step_000000000007.amber"]);
    // The folder of the scene itself is never cleared.
    let here = bench.run(&["run", "scene.toml", "--out", ".", "--overwrite"]);
    assert_eq!(here.code, Some(2));
    assert!(bench.path("scene.toml").exists());
}

#[test]
fn bad_checkpoints_are_refused() {
    let bench = Workbench::new(&plain());
    assert_eq!(bench.run(&["run", "scene.toml", "--out", "out", "--steps", "5"]).code, Some(0));
    let path = "out/checkpoints/step_000000000005.amber";
    let good = std::fs::read(bench.path(path)).unwrap();
    let resume = |set: &str| bench.run(&["run", "scene.toml", "--resume", path, "--set", set]);
    assert!(resume("time.step_s=1e-6").stderr.contains("another scene"));
    for (damaged, part) in [
        (good[..good.len() / 2].to_vec(), "cut short"),
        (b"hello".to_vec(), "cut short"),
        (vec![b'x'; 100], "not a checkpoint"),
        (
            {
                let mut bytes = good.clone();
                *bytes.last_mut().unwrap() ^= 1;
                bytes
            },
            "checksum",
        ),
    ] {
        bench.write(path, damaged);
        let answer = resume("output.every_s=1");
        assert_eq!(answer.code, Some(2));
        assert!(answer.stderr.contains(part), "{}", answer.stderr);
    }
}

#[test]
fn a_grain_that_leaves_is_exit_4() {
    let bench = Workbench::new(
        &plain()
            .replace("[time]", "[time]\nskin_m = 5e-5")
            .replace("z = \"grounded\"", "z = \"open\"")
            .replace("[[walls]]\nplane = { point_m = [0, 0, 1e-5], normal = [0, 0, 1] }\n", ""),
    );
    let answer = bench.run(&["run", "scene.toml", "--out", "out"]);
    assert_eq!(answer.code, Some(4), "{}", answer.stderr);
    assert!(answer.stderr.contains("left the domain"), "{}", answer.stderr);
    let summary: serde_json::Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    assert_eq!(summary["ending"], "failed");
    let answer = bench.run(&["run", "scene.toml", "--out", "gone", "--set", "particles.on_exit=delete"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
}

/// Scene of two grains that fall on a floor with steps four times too long, so that the floor throws them
/// out.
const THROWN: &str = "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.01, 0.01, 0.05]\n[domain.boundary]\n\
    x = 'periodic'\ny = 'periodic'\nz = 'open'\n\
    [[walls]]\nplane = { point_m = [0, 0, 0], normal = [0, 0, 1] }\nmaterial = 'glass'\n\
    [[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 1e7\npoisson = 0.22\n\
    restitution = 1.0\nfriction = 0.0\n\
    [particles]\non_exit = 'delete'\nfile = 'grains.csv'\n[time]\nstep_s = 2e-4\nend_s = 0.5\n\
    allow_unstable = true\ngravity_m_s2 = [0, 0, -9.81]\n\
    [output]\nevery_s = 1e-2\nhistory_every_s = 1e-3\ncheckpoint_every_s = 1e-3\nformats = ['csv']\n";
/// Grains of [`THROWN`].
const THROWN_CSV: &str = "id,x_m,y_m,z_m,radius_m,charge_C,material,vz_m_s\n\
    7,0.005,0.005,0.002,1e-3,0,glass,0\n8,0.005,0.005,0.0041,1e-3,0,glass,0\n";

#[test]
fn grains_that_leave_do_not_hide_that_a_run_is_unsound() {
    let bench = Workbench::new(THROWN);
    let mut grains = THROWN_CSV.to_owned();
    // One of a millionth of the mass leaves in every row.
    for k in 0..50_u32 {
        let (t, x, y) = (1e-3 * f64::from(10 + k), 1.2e-3 * f64::from(k % 7), 1.2e-3 * f64::from(k / 7));
        let up = 0.02 / t + 0.5 * 9.81 * t;
        grains += &format!("{},{x:e},{y:e},0.03,1e-5,0,glass,{up:e}\n", 100 + k);
    }
    bench.write("grains.csv", &grains);
    let answer = bench.run(&["run", "scene.toml", "--out", "out", "--no-progress"]);
    assert_eq!(answer.code, Some(4), "{}", answer.stderr);
    assert!(answer.stderr.contains("no longer sound"), "{}", answer.stderr);
}

#[test]
fn a_run_that_is_no_longer_sound_stops_and_names_grain_and_checkpoint() {
    let bench = Workbench::new(THROWN);
    bench.write("grains.csv", THROWN_CSV);
    let answer = bench.run(&["run", "scene.toml", "--out", "out", "--no-progress"]);
    assert_eq!(answer.code, Some(4), "{}", answer.stderr);
    for part in [
        "no longer sound",
        "grain ",
        " m/s)",
        "the last files in particles/ show that moment",
        "the last checkpoint before that is out/checkpoints/step_",
    ] {
        assert!(answer.stderr.contains(part), "no {part:?} in {}", answer.stderr);
    }
    assert!(bench.read("out/summary.json").contains("no longer sound"));
}
