//! Failures of the solver or the run: nothing is lost, and nothing stays behind.

use super::{AGREEMENT, difference, good};
use amberfield_tests::{CsvTable, DEADLINE, FoamBox};
use rustix::process::{Pid, Signal, kill_process, test_kill_process};
use std::process::Stdio;
use std::time::{Duration, Instant};

#[test]
fn bad_cases_are_refused_by_name() {
    let scene = FoamBox::grounded();
    let phi = scene.bench.read("foam/0/phiE");
    scene.bench.write("foam/0/phiE", phi.replacen("fixedValue", "advective", 1));
    let answer = scene.field("out.csv", &[]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("patch x0 of field phiE has the condition advective"),
        "{}",
        answer.stderr
    );

    let answer = FoamBox::grounded().field("out.csv", &["--set", "domain.boundary.x=\"periodic\""]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("[domain] is periodic along x"), "{}", answer.stderr);

    let scene = FoamBox::grounded();
    std::fs::remove_file(scene.bench.path("foam/system/blockMeshDict")).unwrap();
    let answer = scene.field("out.csv", &[]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("neither constant/polyMesh nor system/blockMeshDict"),
        "{}",
        answer.stderr
    );

    let answer = scene.bench.run(&["doctor"]);
    good(&answer);
    assert!(
        answer.stdout.contains("field solver: ") && answer.stdout.contains("shared memory"),
        "{}",
        answer.stdout
    );
}

#[test]
fn a_killed_solver_ends_the_run_which_goes_on_bit_for_bit() {
    let scene = FoamBox::grounded();
    let mut run = scene.endless();
    kill_process(scene.solver(), Signal::KILL).unwrap();
    let begun = Instant::now();
    while run.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < DEADLINE, "the run must end");
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = run.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("the field solver is gone") && said.contains("--resume"), "{said}");
    let last = scene.bench.names("out/checkpoints").pop().expect("the state before the solve is saved");
    let checkpoint = format!("out/checkpoints/{last}");
    let step: u64 = last.trim_matches(|c: char| !c.is_ascii_digit()).parse().unwrap();

    let more = (step + 40).to_string();
    let steps = ["--steps", "40"];
    good(
        &scene
            .bench
            .run(&[&["run", "endless.toml", "--resume", &checkpoint, "--no-progress"], &steps[..]].concat()),
    );
    let whole = ["run", "endless.toml", "--out", "whole", "--no-progress", "--steps", &more];
    good(&scene.bench.run(&[&whole[..], &["--set", "output.history_every_s=1e-5"]].concat()));
    let last = |out: &str| {
        let name = format!("{out}/checkpoints/step_{:012}.amber", step + 40);
        CsvTable::parse(&scene.bench.read(&format!("{out}/history.csv")))
            .without_clocks()
            .rows
            .pop()
            .map(|row| (row, name))
    };
    assert_eq!(last("out").unwrap().0, last("whole").unwrap().0);
}

/// Messages of a run of 6 ms whose solver is killed as soon as it has begun.
fn lose_the_solver(scene: &FoamBox, on_loss: &str) -> String {
    let text = scene.bench.read("scene.toml")
        + &format!(
            "on_solver_loss = '{on_loss}'\n[output]\nhistory_every_s = 1e-5\ncheckpoint_every_s = 5e-3\n"
        );
    scene.bench.write("scene.toml", text.replace("end_s = 1e-3", "end_s = 6e-3").replace("1e-12", "1e-13"));
    good(&scene.bench.run(&["run", "scene.toml", "--out", "quiet", "--no-progress"]));
    let mut run = scene
        .bench
        .command(&["run", "scene.toml", "--out", "out", "--no-progress"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    scene.wait_until_it_steps(&mut run);
    kill_process(scene.solver(), Signal::KILL).unwrap();
    let output = run.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    said
}

fn rows(scene: &FoamBox, out: &str) -> CsvTable {
    CsvTable::parse(&scene.bench.read(&format!("{out}/history.csv"))).without_clocks()
}

#[test]
fn a_run_that_waits_starts_a_killed_solver_again_and_nothing_is_lost() {
    let scene = FoamBox::grounded();
    let said = lose_the_solver(&scene, "wait");
    assert!(said.contains("waiting for a new one"), "{said}");
    assert_eq!(rows(&scene, "out"), rows(&scene, "quiet"));
}

#[test]
fn a_run_that_falls_back_goes_on_with_the_internal_grid_and_resumes_without_a_solver() {
    let scene = FoamBox::grounded();
    let said = lose_the_solver(&scene, "fallback");
    assert!(said.contains("internal grid and field solver differ by"), "{said}");
    assert!(said.contains("the internal grid takes the field solver's place"), "{said}");
    let (lost, quiet) = (rows(&scene, "out"), rows(&scene, "quiet"));
    let energy = |table: &CsvTable| table.numbers("electric_J");
    let error = difference(&energy(&lost), &energy(&quiet));
    assert!(error > 0.0 && error < AGREEMENT, "{error:e}");

    let checkpoint = format!("out/checkpoints/{}", scene.bench.names("out/checkpoints")[0]);
    let resume = ["run", "scene.toml", "--resume", &checkpoint, "--no-progress"];
    let output = scene.bench.command(&resume).env("AMBERFIELD_SOLVER", "none").output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("the field solver was lost before this checkpoint"), "{said}");
    assert_eq!(rows(&scene, "out"), lost);
}

#[test]
fn a_fallback_with_other_boundaries_is_said() {
    let scene = FoamBox::grounded();
    let text = scene.bench.read("scene.toml").replace("z = 'grounded'", "z = 'insulating'");
    scene.bench.write("scene.toml", text + "on_solver_loss = 'fallback'\n");
    let answer = scene.bench.run(&["run", "scene.toml", "--out", "out", "--no-progress", "--steps", "2"]);
    good(&answer);
    assert!(
        answer.stderr.contains("its boundaries, [domain.boundary], are not those of the case"),
        "{}",
        answer.stderr
    );

    let text = scene.bench.read("scene.toml");
    let without = text[text.find("[[materials]]").unwrap()..].to_owned();
    scene.bench.write("grains.csv", "id,x_m,y_m,z_m,radius_m,charge_C\n1,5e-3,5e-3,5e-3,2.5e-4,1e-12\n");
    let generate = without.find("generate").unwrap();
    let line = without[generate..].find('\n').unwrap() + generate;
    scene
        .bench
        .write("scene.toml", format!("{}file = 'grains.csv'{}", &without[..generate], &without[line..]));
    let answer = scene.bench.run(&["run", "scene.toml", "--out", "other", "--no-progress"]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("add [domain] and [domain.boundary]"), "{}", answer.stderr);
}

#[test]
fn a_killed_dem_process_leaves_neither_solver_nor_shared_memory() {
    let scene = FoamBox::grounded();
    let mut run = scene.endless();
    let solver = scene.solver();
    let of_run = || {
        let line = std::fs::read(format!("/proc/{}/cmdline", solver.as_raw_nonzero())).unwrap_or_default();
        let line = String::from_utf8_lossy(&line).into_owned();
        line.split('\0').find(|word| word.starts_with("amberfield-")).unwrap_or_default().to_owned()
    };
    let name = of_run();
    assert!(!name.is_empty());
    kill_process(Pid::from_child(&run), Signal::KILL).unwrap();
    run.wait().unwrap();
    let left = || {
        let entries = std::fs::read_dir("/dev/shm").unwrap().flatten();
        entries.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with(&name))
    };
    let begun = Instant::now();
    // The process that inherits the solver may be slow to collect its exit status, which leaves a zombie (Z).
    let lives = || {
        let state = std::fs::read_to_string(format!("/proc/{}/stat", solver.as_raw_nonzero()));
        state.is_ok_and(|state| !state.contains(") Z "))
    };
    while lives() || left() {
        assert!(begun.elapsed() < DEADLINE, "the solver leaves and cleans");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(scene.bench.read("out/solver/log.electricFieldFoam").contains("DEM process is gone"));
}

#[test]
fn a_hung_solver_is_missed_in_time_and_killed() {
    let scene = FoamBox::grounded();
    let text = scene.bench.read("scene.toml").replace("timeout_s = 20.0", "timeout_s = 1.0");
    scene.bench.write("scene.toml", text);
    let run = scene.endless();
    let solver = scene.solver();
    kill_process(solver, Signal::STOP).unwrap();
    let output = run.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("no answer from the field solver"), "{said}");
    assert!(test_kill_process(solver).is_err());
}

#[test]
fn an_interrupt_ends_both_in_peace() {
    let scene = FoamBox::grounded();
    let run = scene.endless();
    let solver = scene.solver();
    kill_process(solver, Signal::STOP).unwrap();
    // The run waits for an answer when it is interrupted.
    std::thread::sleep(Duration::from_millis(300));
    kill_process(Pid::from_child(&run), Signal::INT).unwrap();
    std::thread::sleep(Duration::from_millis(200));
    kill_process(solver, Signal::CONT).unwrap();
    let output = run.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(test_kill_process(solver).is_err());
    assert!(scene.bench.read("out/solver/log.electricFieldFoam").contains("The run is over."));
}

/// Command of a run in which a script takes the place of the solver.
fn stand_in(scene: &FoamBox, script: &str) -> std::process::Command {
    scene.bench.write("solver.sh", format!("#!/bin/sh\n{script}\n"));
    let program = scene.bench.path("solver.sh");
    std::fs::set_permissions(&program, std::os::unix::fs::PermissionsExt::from_mode(0o755)).unwrap();
    let mut run = scene.bench.command(&["run", "scene.toml", "--out", "out", "--no-progress"]);
    run.env("AMBERFIELD_SOLVER", program);
    run
}

#[test]
fn a_solver_that_dies_or_hangs_before_it_says_a_word_is_missed() {
    let scene = FoamBox::grounded();
    let text = scene.bench.read("scene.toml").replace("timeout_s = 20.0", "timeout_s = 1.0");
    scene.bench.write("scene.toml", text);
    for (script, expected) in [
        ("exit 7", "the field solver is gone at solve 0 (exit status: 7; its log is"),
        ("kill -9 $$", "the field solver is gone at solve 0 (signal: 9 (SIGKILL); its log is"),
        ("exec sleep 60", "no answer from the field solver to solve 0 within"),
    ] {
        let output = stand_in(&scene, script).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(3), "{said}");
        assert!(said.contains(expected), "{said}");
        assert_eq!(scene.bench.names("out"), ["solver"], "nothing has begun");
    }
}

#[test]
fn a_solver_refuses_a_run_of_a_later_version() {
    let scene = FoamBox::grounded();
    let solver = amberfield_coupling::solver_program(false);
    let script = format!("echo 1000 > /dev/shm/$6/protocol\nexec '{}' \"$@\"", solver.display());
    let output = stand_in(&scene, &script).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("the field solver is gone"), "{said}");
    assert!(said.contains("the peer speaks version 1000 of the protocol, this program"), "{said}");
}

#[test]
fn a_grain_outside_the_mesh_is_named() {
    for method in ["p3m", "kolehmainen"] {
        let scene = FoamBox::grounded();
        let text = scene
            .bench
            .read("scene.toml")
            .replace("max_m = [0.012, 0.012, 0.01]", "max_m = [0.012, 0.012, 0.02]");
        let generate = text.find("generate").unwrap();
        let line = text[generate..].find('\n').unwrap() + generate;
        scene.bench.write("scene.toml", format!("{}file = 'grains.csv'{}", &text[..generate], &text[line..]));
        let grains = |z: &str| {
            format!(
                "id,x_m,y_m,z_m,radius_m,charge_C\n1,5e-3,5e-3,5e-3,2.5e-4,1e-12\n\
                 2,5e-3,5e-3,{z},2.5e-4,-1e-12\n"
            )
        };
        let options = ["--method", method, "--set", "electric_field.field_cutoff_radius=2e-3"];
        if method == "p3m" {
            // A hair outside belongs to the wall, on one rank and on two.
            scene.bench.write("grains.csv", grains("10.001e-3"));
            good(&scene.field("hair.csv", &options));
            good(&scene.field("two.csv", &[&options[..], &["--set", "solver.ranks=2"]].concat()));
            let error = difference(&scene.e("two.csv"), &scene.e("hair.csv"));
            assert!(error < 1e-4, "{error:e}");
        }
        scene.bench.write("grains.csv", grains("12e-3"));
        let answer = scene.field("far.csv", &options);
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        assert!(
            answer.stderr.contains("grain at index 1") && answer.stderr.contains("outside the"),
            "{}",
            answer.stderr
        );
    }
}

#[test]
fn a_solver_beside_the_steps_leads_to_the_same_motion_and_loses_nothing_when_killed() {
    let scene = FoamBox::grounded();
    let text = scene.bench.read("scene.toml") + "[output]\nhistory_every_s = 1e-5\n";
    let text = text.replace("end_s = 1e-3", "end_s = 4e-3").replace("1e-12", "2e-13");
    scene.bench.write("scene.toml", text);
    let run = |out: &str, options: &[&str]| {
        scene.bench.run(&[&["run", "scene.toml", "--out", out, "--no-progress"], options].concat())
    };
    let overlap = ["--set", "electric_field.overlap=true"];
    good(&run("waits", &[]));
    good(&run("beside", &overlap));
    let energy = |out: &str, name: &str| rows(&scene, out).numbers(name);
    for name in ["kinetic_J", "electric_J"] {
        let error = difference(&energy("beside", name), &energy("waits", name));
        assert!(error > 0.0 && error < AGREEMENT, "{name}: {error:e}");
    }

    // Stopped in the middle, the solver killed in the middle: both continue bit for bit.
    let steps = rows(&scene, "beside").rows.len() / 2;
    good(&run("stopped", &[&overlap[..], &["--steps", &steps.to_string()]].concat()));
    let last = |out: &str| {
        format!("{out}/checkpoints/{}", scene.bench.names(&format!("{out}/checkpoints")).pop().unwrap())
    };
    let resume =
        |out: &str| {
            good(&scene.bench.run(
                &[&["run", "scene.toml", "--resume", &last(out), "--no-progress"], &overlap[..]].concat(),
            ));
        };
    resume("stopped");
    assert_eq!(rows(&scene, "stopped"), rows(&scene, "beside"));

    let mut killed = scene
        .bench
        .command(&[&["run", "scene.toml", "--out", "out", "--no-progress"], &overlap[..]].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    scene.wait_until_it_steps(&mut killed);
    kill_process(scene.solver(), Signal::KILL).unwrap();
    assert_eq!(killed.wait().unwrap().code(), Some(3));
    resume("out");
    assert_eq!(rows(&scene, "out"), rows(&scene, "beside"));
}

#[test]
fn a_solver_beside_the_steps_cannot_be_waited_for() {
    let scene = FoamBox::grounded();
    let answer = scene.bench.run(&[
        "run",
        "scene.toml",
        "--set",
        "electric_field.overlap=true",
        "--set",
        "solver.on_solver_loss=\"wait\"",
    ]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("electric_field.overlap = true needs"), "{}", answer.stderr);
}

#[test]
fn a_solver_that_comes_back_with_another_mesh_is_refused() {
    let scene = FoamBox::grounded();
    let text = scene.bench.read("scene.toml") + "on_solver_loss = 'wait'\n[output]\nhistory_every_s = 1e-5\n";
    let text = text.replace("end_s = 1e-3", "end_s = 1e3").replace("1e-12", "1e-15").replace("-9.81", "0");
    scene.bench.write("scene.toml", text);
    let interval = ["--set", "electric_field.coupling_interval=5"];
    let mut run = scene
        .bench
        .command(&[&["run", "scene.toml", "--out", "out", "--no-progress"], &interval[..]].concat())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    scene.wait_until_it_steps(&mut run);
    let mesh = scene.bench.read("foam/system/blockMeshDict");
    scene.bench.write("foam/system/blockMeshDict", mesh.replace("(12 12 10)", "(10 12 10)"));
    kill_process(scene.solver(), Signal::KILL).unwrap();
    let output = run.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("the field solver came back with another mesh") && said.contains("1440"), "{said}");
}
