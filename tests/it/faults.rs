//! Faults from outside: nothing is lost, and nothing is half-written under its final name.

use crate::scenes::CHARGED;
use amberfield_tests::{Answer, CsvTable, DEADLINE, Workbench};
use rustix::process::{Pid, Signal, kill_process};
use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Number of kills of the run that is killed again and again.
const KILLS: usize = 100;
/// Longest life of a run after it has begun to step [ms].
const LIFE_MS: u64 = 40;

/// Scene of a run that writes often and takes longer than all lives together.
fn endless() -> String {
    CHARGED
        .replace("end_s = 2e-3", "end_s = 1e3")
        .replace("every_s = 2.5e-4", "every_s = 1e-4\nhistory_every_s = 2e-5")
        .replace("checkpoint_every_s = 5e-4", "checkpoint_every_s = 1e-4")
}

/// Results of a run: the history without clock readings, and the files of the grains.
fn results(bench: &Workbench, out: &str) -> (CsvTable, BTreeMap<String, Vec<u8>>) {
    let history = CsvTable::parse(&bench.read(&format!("{out}/history.csv"))).without_clocks();
    let file = |name: String| {
        let content = std::fs::read(bench.path(&format!("{out}/particles/{name}"))).unwrap();
        (name, content)
    };
    (history, bench.names(&format!("{out}/particles")).into_iter().map(file).collect())
}

/// Checks that each file under its final name is complete.
fn all_whole(bench: &Workbench, out: &str) {
    for folder in ["particles", ""] {
        for name in bench.names(&format!("{out}/{folder}")) {
            let path = bench.path(&format!("{out}/{folder}/{name}"));
            let content = || std::fs::read(&path).unwrap();
            if name.starts_with('.') {
                continue;
            }
            if name.ends_with(".vtu") || name.ends_with(".pvd") {
                let content = content();
                let tail = String::from_utf8_lossy(&content[content.len().saturating_sub(16)..]).into_owned();
                assert!(tail.trim_end().ends_with("</VTKFile>"), "{name} ends with {tail:?}");
            } else if name.ends_with(".json") {
                serde_json::from_slice::<serde_json::Value>(&content()).unwrap();
            } else if folder == "particles" {
                assert_eq!(content().last(), Some(&b'\n'), "{name}");
            }
        }
    }
}

/// Newest checkpoint of a run folder.
fn newest(bench: &Workbench, out: &str) -> Option<String> {
    let names = bench.names(&format!("{out}/checkpoints"));
    let last = names.into_iter().rfind(|name| name.ends_with(".amber"))?;
    Some(format!("{out}/checkpoints/{last}"))
}

/// Step in the name of a checkpoint.
fn step_of(checkpoint: &str) -> u64 {
    let name = checkpoint.rsplit('/').next().unwrap();
    name.trim_matches(|c: char| !c.is_ascii_digit()).parse().unwrap()
}

#[test]
fn a_run_killed_a_hundred_times_is_bit_for_bit_the_undisturbed_one() {
    let bench = Workbench::new(&endless());
    // Numerical Recipes' generator: lives of any length, the same in every run of the test.
    let mut random = 1_u64;
    for _ in 0..KILLS {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223) % (1 << 32);
        let from = newest(&bench, "out");
        let arguments = match &from {
            Some(checkpoint) => vec!["run", "scene.toml", "--no-progress", "--resume", checkpoint],
            None => vec!["run", "scene.toml", "--no-progress", "--overwrite", "--out", "out"],
        };
        let mut command = bench.command(&arguments);
        let mut run = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        let begun = Instant::now();
        while !bench.path("out/run.lock").exists() || owner(&bench) != Some(run.id()) {
            assert!(begun.elapsed() < DEADLINE && run.try_wait().unwrap().is_none(), "{arguments:?}");
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_micros(random % (1000 * LIFE_MS)));
        kill_process(Pid::from_child(&run), Signal::KILL).unwrap();
        run.wait().unwrap();
        all_whole(&bench, "out");
    }
    let last = newest(&bench, "out").expect("a hundred lives reach a checkpoint");
    let answer = bench.run(&["run", "scene.toml", "--no-progress", "--resume", &last, "--steps", "40"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let steps = (step_of(&last) + 40).to_string();
    let answer = bench.run(&["run", "scene.toml", "--no-progress", "--out", "whole", "--steps", &steps]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    assert_eq!(results(&bench, "out"), results(&bench, "whole"));
    let parts = |name: &String| name.ends_with(".part");
    assert!(!bench.names("out/checkpoints").iter().chain(&bench.names("out/particles")).any(parts));
}

/// Process that has marked the run folder.
fn owner(bench: &Workbench) -> Option<u32> {
    std::fs::read_to_string(bench.path("out/run.lock")).ok()?.parse().ok()
}

/// Runs a command in a file system of its own; `mount` is the shell command that prepares the folder `out`.
fn mounted(bench: &Workbench, mount: &str, arguments: &[&str]) -> Answer {
    std::fs::create_dir_all(bench.path("out")).unwrap();
    let run = bench.command(arguments);
    let script = format!("{mount} && {{ \"$@\"; code=$?; cp -a out kept; exit $code; }}");
    let mut shell = Command::new("unshare");
    shell.args(["--map-root-user", "--mount", "sh", "-c", &script, "sh"]);
    let output = shell
        .arg(run.get_program())
        .args(arguments)
        .current_dir(bench.path(""))
        .output()
        .expect("unshare of util-linux");
    Answer {
        code: output.status.code(),
        stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
        stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
    }
}

#[test]
fn a_full_disk_ends_the_run_which_goes_on_when_there_is_room() {
    let whole = Workbench::new(CHARGED);
    assert_eq!(whole.run(&["run", "scene.toml", "--out", "kept", "--no-progress"]).code, Some(0));
    let mut failed = 0;
    for kibibytes in [0, 4, 12, 20, 36, 60, 100, 160, 240, 320, 400, 520] {
        let bench = Workbench::new(CHARGED);
        // One block is the least that can be mounted; 0 is no room for a folder.
        let mount =
            format!("mount -t tmpfs -o size={}k,nr_inodes={} none out", kibibytes.max(4), 4 + 2 * kibibytes);
        let run = ["run", "scene.toml", "--out", "out", "--no-progress", "--overwrite"];
        let answer = mounted(&bench, &mount, &run);
        if answer.code == Some(0) {
            continue;
        }
        failed += 1;
        assert_eq!(answer.code, Some(2), "{kibibytes} KiB: {}", answer.stderr);
        assert!(answer.stderr.contains("No space left"), "{kibibytes} KiB: {}", answer.stderr);
        assert!(!answer.stderr.contains("panicked"), "{}", answer.stderr);
        all_whole(&bench, "kept");
        let answer = match newest(&bench, "kept") {
            Some(last) => bench.run(&["run", "scene.toml", "--no-progress", "--resume", &last]),
            None => bench.run(&["run", "scene.toml", "--no-progress", "--out", "kept", "--overwrite"]),
        };
        assert_eq!(answer.code, Some(0), "{kibibytes} KiB: {}", answer.stderr);
        assert_eq!(results(&bench, "kept"), results(&whole, "kept"), "{kibibytes} KiB");
    }
    assert!(failed >= 6, "{failed} of the disks were too small");
}

#[test]
fn a_folder_that_cannot_be_written_is_said_before_anything_runs() {
    let bench = Workbench::new(CHARGED);
    let run = ["run", "scene.toml", "--out", "out", "--no-progress"];
    let answer = mounted(&bench, "mount --bind out out && mount -o remount,ro,bind out", &run);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("cannot be used as run folder: Read-only file system"),
        "{}",
        answer.stderr
    );
    bench.write("file", "");
    let answer = bench.run(&["run", "scene.toml", "--out", "file/out", "--no-progress"]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("file/out"), "{}", answer.stderr);
}

#[test]
fn a_folder_that_is_removed_ends_the_run_with_its_name() {
    let bench = Workbench::new(&endless());
    let mut command = bench.command(&["run", "scene.toml", "--no-progress", "--out", "out"]);
    let mut run = command.stdout(Stdio::null()).stderr(Stdio::piped()).spawn().unwrap();
    let begun = Instant::now();
    while newest(&bench, "out").is_none() {
        assert!(begun.elapsed() < DEADLINE && run.try_wait().unwrap().is_none(), "the run must begin");
        std::thread::sleep(Duration::from_millis(1));
    }
    // The folder is renamed first so that it is gone at once. If it went file by file, the run could end in
    // between and name a checkpoint that is about to be removed.
    std::fs::rename(bench.path("out"), bench.path("gone")).unwrap();
    std::fs::remove_dir_all(bench.path("gone")).unwrap();
    while run.try_wait().unwrap().is_none() {
        assert!(begun.elapsed() < DEADLINE, "the run must end");
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = run.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("out/") && said.contains("there is no checkpoint before that"), "{said}");
}

#[test]
fn a_damaged_checkpoint_is_refused_and_an_older_one_offered() {
    let bench = Workbench::new(CHARGED);
    assert_eq!(bench.run(&["run", "scene.toml", "--out", "out", "--no-progress"]).code, Some(0));
    let names = bench.names("out/checkpoints");
    let [older, last] =
        [&names[names.len() - 2], &names[names.len() - 1]].map(|name| format!("out/checkpoints/{name}"));
    let good = std::fs::read(bench.path(&last)).unwrap();
    let lengths = (0..good.len()).step_by(good.len().div_ceil(40));
    for length in lengths {
        bench.write(&last, &good[..length]);
        offers(&bench, &last, &older, "cut short");
    }
    for bit in (0..8 * good.len()).step_by((8 * good.len()).div_ceil(40) | 1) {
        let mut flipped = good.clone();
        flipped[bit / 8] ^= 1 << (bit % 8);
        bench.write(&last, flipped);
        offers(&bench, &last, &older, "checkpoint");
    }
    bench.write(&last, &good);
    let answer = bench.run(&["run", "scene.toml", "--resume", &last, "--set", "time.step_s=1e-6"]);
    assert!(answer.code == Some(2) && answer.stderr.contains("another scene"), "{}", answer.stderr);
    assert_eq!(bench.run(&["run", "scene.toml", "--no-progress", "--resume", &older]).code, Some(0));
}

/// Checks that a damaged checkpoint is refused and an older one offered.
fn offers(bench: &Workbench, damaged: &str, older: &str, words: &str) {
    let answer = bench.run(&["run", "scene.toml", "--no-progress", "--resume", damaged]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    let errors = answer.stderr.lines().filter(|line| line.starts_with("error")).count();
    assert_eq!(errors, 1, "{}", answer.stderr);
    for part in [words, damaged, &format!("continue with --resume {older}")] {
        assert!(answer.stderr.contains(part), "no {part:?} in {}", answer.stderr);
    }
}
