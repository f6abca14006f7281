//! Bad input: exit code 2, a message that says where, and no files left behind.

use crate::scenes::{CHARGED, PAIR, PAIR_CSV};
use amberfield_tests::Workbench;

/// Checks that a scene that is changed in one place is refused with a message that holds `parts`.
fn refused(from: &str, to: &str, parts: &[&str]) {
    assert!(CHARGED.contains(from), "{from}");
    let bench = Workbench::new(&CHARGED.replacen(from, to, 1));
    let answer = bench.run(&["run", "scene.toml", "--out", "out"]);
    assert_eq!(answer.code, Some(2), "{to}: {}", answer.stderr);
    for part in parts {
        assert!(answer.stderr.contains(part), "{part}: {}", answer.stderr);
    }
    assert!(answer.stderr.lines().all(|line| line.starts_with("error: ")), "{}", answer.stderr);
    assert!(!bench.path("out").exists(), "nothing is written");
}

#[test]
fn bad_values_name_file_line_key_and_value() {
    refused(
        "friction = 0.3",
        "fricton = 0.3",
        &["scene.toml:19", "materials[0].fricton", "materials[0].friction"],
    );
    refused("young_Pa = 1e6", "young_Pa = -1e6", &["scene.toml:16", "materials[0].young_Pa", "-1000000"]);
    refused("count = 60", "count = 60000", &["scene.toml", "particles.generate", "fraction"]);
    refused("step_s = 2e-6", "step_s = 1e-3", &["time step", "limit"]);
    refused("tolerance = 1e-2", "tolerance = 1e-2\nmethod = \"kolehmainen\"", &["field_cutoff_radius"]);
}

#[test]
fn what_charge_transfer_and_gas_need_is_said_by_name() {
    let transfer = "enable_collision_charge_transfer = true";
    refused("tuning = \"model\"", transfer, &["materials[0].work_function_eV"]);
    refused(
        "rolling_friction = 0.01",
        "[gas]\ndrag = \"ergun\"",
        &["gas.drag", "schiller_naumann", "gidaspow"],
    );
}

#[test]
fn what_has_no_effect_is_said() {
    let bench = Workbench::new(&CHARGED.replace("tuning = \"model\"", "tuning = \"model\"\noverlap = true"));
    let answer = bench.run(&["explain", "scene.toml"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let said = "electric_field.overlap has no effect without [solver]";
    assert!(answer.stdout.contains(said), "{}", answer.stdout);
}

#[test]
fn overlapping_and_coincident_grains_are_refused_before_anything_runs() {
    let scene = CHARGED.split_once("[particles.generate]").unwrap().0.to_owned()
        + "[particles]\nfile = \"g.csv\"\n[time]"
        + CHARGED.split_once("[time]").unwrap().1;
    for (second, part) in [("1e-3", "same centre"), ("1.05e-3", "overlap")] {
        let bench = Workbench::new(&scene);
        bench.write(
            "g.csv",
            format!(
                "id,x_m,y_m,z_m,radius_m,charge_C\n1,1e-3,1e-3,1e-3,1e-4,0\n2,1e-3,1e-3,{second},1e-4,0\n"
            ),
        );
        let answer = bench.run(&["run", "scene.toml", "--out", "out"]);
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        assert!(answer.stderr.contains(part), "{}", answer.stderr);
        assert!(!bench.path("out").exists());
    }
}

#[test]
fn bad_command_lines_are_exit_2() {
    let bench = Workbench::new(PAIR);
    bench.write("pair.csv", PAIR_CSV);
    for arguments in [
        &["run"][..],
        &["fly", "scene.toml"],
        &["run", "scene.toml", "--threads", "0"],
        &["run", "scene.toml", "--steps", "0"],
        &["run", "scene.toml", "--steps", "many"],
        &["field", "nowhere.toml"],
        &["field", "."],
        &["field", "scene.toml", "--repeat", "0"],
        &["field", "scene.toml", "--set", "electric_field.metod=p3m"],
        &["field", "scene.toml", "--out", "no/such/folder/e.csv"],
        &["field", "scene.toml", "--out", "."],
        &["run", "scene.toml"],
        &["run", "scene.toml", "--resume", "nothing.amber"],
    ] {
        let answer = bench.run(arguments);
        assert_eq!(answer.code, Some(2), "{arguments:?}: {}", answer.stderr);
        assert!(answer.stderr.contains("error"), "{arguments:?}: {}", answer.stderr);
    }
    assert_eq!(bench.run(&["--help"]).code, Some(0));
    assert_eq!(bench.run(&["--version"]).code, Some(0));
}
