//! Runs in containers, as described in docker/compose.yaml, and over two machines; `cargo xtask images`
//! builds the images.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

mod hosts;

use amberfield_tests::{CsvTable, DEADLINE, FoamBox};
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// Two containers with a run and its solver; they are removed at the end with all that belongs to them.
struct Pair {
    scene: FoamBox,
    /// Name of the project, which is unique to the test.
    project: String,
    /// Size of the shared memory.
    memory: &'static str,
}

/// End of a service.
#[derive(Debug)]
struct Ended {
    /// Exit code.
    code: i32,
    /// Output of the service.
    said: String,
}

impl Pair {
    /// Starts both containers; `memory` is the size of the memory that they share.
    fn start(scene: FoamBox, memory: &'static str) -> Self {
        let folder = scene.bench.path("");
        let project = folder.file_name().unwrap().to_string_lossy().to_lowercase().replace('.', "");
        let pair = Self { scene, project: format!("amberfield{project}"), memory };
        let output = pair.compose(&["up", "-d"]);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        pair
    }

    fn compose(&self, arguments: &[&str]) -> Output {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../docker/compose.yaml");
        let alone = Command::new("docker-compose").arg("version").output().is_ok();
        let mut command = if alone { Command::new("docker-compose") } else { Command::new("docker") };
        if !alone {
            command.arg("compose");
        }
        command.args(["-f", file, "-p", &self.project]).args(arguments);
        command.env("CASE", self.scene.bench.path("").canonicalize().unwrap()).env("MEMORY", self.memory);
        command.output().expect("docker-compose starts; `cargo xtask images` installs it")
    }

    /// Id of the container of a service.
    fn container(&self, service: &str) -> String {
        let output = self.compose(&["ps", "-a", "-q", service]);
        let output = if output.status.success() { output } else { self.compose(&["ps", "-q", service]) };
        String::from_utf8_lossy(&output.stdout).trim().to_owned()
    }

    /// Waits for the end of a service.
    fn end(&self, service: &str) -> Ended {
        let container = self.container(service);
        let running = || text(&["inspect", "-f", "{{.State.Running}}", &container]).contains("true");
        let begun = Instant::now();
        while running() {
            assert!(
                begun.elapsed() < DEADLINE,
                "{service} must end; it said\n{}",
                text(&["logs", &container])
            );
            std::thread::sleep(Duration::from_millis(50));
        }
        let code = text(&["inspect", "-f", "{{.State.ExitCode}}", &container]);
        Ended { code: code.trim().parse().unwrap(), said: text(&["logs", &container]) }
    }

    fn wait_until_it_steps(&self) {
        let history = self.scene.bench.path("out/history.csv");
        let rows = || std::fs::read_to_string(&history).map_or(0, |text| text.lines().count());
        let begun = Instant::now();
        while rows() < 4 {
            assert!(begun.elapsed() < DEADLINE, "the run must begin: {:?}", self.end("dem"));
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits until the run steps, then kills a service.
    fn kill(&self, service: &str) {
        self.wait_until_it_steps();
        let _ = text(&["kill", "-s", "KILL", &self.container(service)]);
    }

    /// Names of the files that are left in the shared memory.
    fn left(&self) -> String {
        let volume = format!("{}_memory:/dev/shm", self.project);
        text(&[
            "run",
            "--rm",
            "--network",
            "none",
            "-v",
            &volume,
            "--entrypoint",
            "ls",
            "amberfield-dem",
            "/dev/shm",
        ])
    }
}

impl Drop for Pair {
    fn drop(&mut self) {
        let _ = self.compose(&["down", "-v", "-t", "0"]);
    }
}

/// Output of docker.
fn text(arguments: &[&str]) -> String {
    let output = Command::new("docker").args(arguments).output().expect("docker starts");
    String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr)
}

fn rows(scene: &FoamBox, out: &str) -> CsvTable {
    CsvTable::parse(&scene.bench.read(&format!("{out}/history.csv"))).without_clocks()
}

/// Scene of the grounded box, with a row of the history for each step.
fn scene(end_s: f64) -> FoamBox {
    let scene = FoamBox::grounded();
    let text = scene.bench.read("scene.toml").replace("end_s = 1e-3", &format!("end_s = {end_s}"));
    // Grains with little charge and no weight stay at their places, however long it takes to kill a process.
    let text =
        text.replace("1e-12", "1e-15").replace("-9.81", "0").replace("timeout_s = 20.0", "timeout_s = 10.0");
    scene.bench.write("scene.toml", text + "[output]\nhistory_every_s = 1e-5\n");
    scene
}

#[test]
fn the_answer_is_that_of_one_machine_without_containers() {
    let pair = Pair::start(scene(1e-3), "256m");
    let Ended { code, said } = pair.end("dem");
    assert_eq!(code, 0, "{said}");
    assert_eq!(pair.end("field").code, 0);
    assert_eq!(pair.left().trim(), "");
    let alone = pair.scene.bench.run(&["run", "scene.toml", "--out", "alone", "--no-progress"]);
    assert_eq!(alone.code, Some(0), "{}", alone.stderr);
    assert_eq!(rows(&pair.scene, "out"), rows(&pair.scene, "alone"));
}

#[test]
fn a_killed_solver_ends_the_run_and_leaves_a_checkpoint() {
    let pair = Pair::start(scene(1e3), "256m");
    pair.kill("field");
    let Ended { code, said } = pair.end("dem");
    assert_eq!(code, 3, "{said}");
    assert!(said.contains("field solver") && said.contains("--resume"), "{said}");
    assert!(!pair.scene.bench.names("out/checkpoints").is_empty());
    assert_eq!(pair.left().trim(), "");
}

#[test]
fn a_killed_run_ends_the_solver_which_cleans_up() {
    let pair = Pair::start(scene(1e3), "256m");
    pair.kill("dem");
    let Ended { code, said } = pair.end("field");
    assert_ne!(code, 0, "{said}");
    assert!(said.contains("DEM process is gone"), "{said}");
    assert_eq!(pair.left().trim(), "");
}

#[test]
fn too_little_shared_memory_is_said_before_the_first_step() {
    // The first size has no room for the channels; the second has, but not for the mesh.
    let dem = Pair::start(scene(1e-3), "64k").end("dem");
    assert!(dem.code == 3 && dem.said.contains("make /dev/shm larger"), "{dem:?}");
    let pair = Pair::start(scene(1e-3), "1200k");
    let Ended { code, said } = pair.end("field");
    assert!(code != 0 && said.contains("make /dev/shm larger"), "{code} {said}");
    // Whatever the field side gives as its reason before its mesh has come is a refusal.
    assert_eq!(pair.end("dem").code, 2);
}

#[test]
fn another_user_cannot_open_a_run() {
    let pair = Pair::start(scene(1e3), "256m");
    pair.wait_until_it_steps();
    let listing = pair.left();
    let mut names = listing.split_whitespace();
    let run = names.find(|name| name.starts_with("amberfield-") && !name.contains('.')).unwrap();
    let memory = format!("{}_memory:/dev/shm", pair.project);
    let case = format!("{}:/case", pair.scene.bench.path("").canonicalize().unwrap().display());
    let other = ["--rm", "--network", "none", "--user", "12345:12345", "-v", &memory, "-v", &case];
    let said = text(&[&["run"], &other[..], &["amberfield-openfoam", "/case/foam", "-run", run]].concat());
    assert!(said.contains(&format!("cannot open run {run}: Permission denied")), "{said}");
}
