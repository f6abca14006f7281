//! Interrupts by Ctrl-C.

use crate::scenes::plain;
use amberfield_tests::Workbench;
use rustix::process::{Pid, Signal, kill_process};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Longest wait for a run to begin or end; it takes a fraction of a second.
const DEADLINE: Duration = Duration::from_secs(60);

#[test]
fn one_interrupt_ends_with_a_checkpoint_that_goes_on() {
    // Far more steps than the test waits for.
    let bench = Workbench::new(
        &plain()
            .replace("end_s = 2e-3", "end_s = 1e3")
            .replace("every_s = 2.5e-4", "every_s = 1")
            .replace("checkpoint_every_s = 5e-4\n", ""),
    );
    let mut child = bench
        .command(&["run", "scene.toml", "--out", "out"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !bench.path("out/particles.pvd").exists() {
        assert!(begun.elapsed() < DEADLINE && child.try_wait().unwrap().is_none(), "the run must begin");
        std::thread::sleep(Duration::from_millis(10));
    }
    let second = bench.run(&["run", "scene.toml", "--out", "out", "--overwrite"]);
    assert_eq!(second.code, Some(2), "another process writes there: {}", second.stderr);
    kill_process(Pid::from_child(&child), Signal::INT).unwrap();
    while child.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < DEADLINE, "the run must end");
        std::thread::sleep(Duration::from_millis(10));
    }
    let output = child.wait_with_output().unwrap();
    let stdout = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(stdout.contains("--resume"), "{stdout}");
    let checkpoint = format!("out/checkpoints/{}", bench.names("out/checkpoints").pop().unwrap());
    let answer = bench.run(&["run", "scene.toml", "--resume", &checkpoint, "--steps", "3"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
}

#[test]
fn a_killed_run_is_stale_and_the_doctor_cleans_it() {
    let bench = Workbench::new(&plain().replace("end_s = 2e-3", "end_s = 1e3"));
    let mut child = bench
        .command(&["run", "scene.toml", "--out", "out"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while !bench.path("out/run.lock").exists() {
        assert!(begun.elapsed() < DEADLINE, "the run must begin");
        std::thread::sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(bench.run(&["doctor"]).stdout.contains("stale run: ./out"));
    assert!(bench.run(&["doctor", "--clean"]).stdout.contains("removed"));
    assert!(bench.run(&["doctor"]).stdout.contains("stale runs: none"));
}
