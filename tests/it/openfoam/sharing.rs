//! Resources that a run shares with the field solver: who can use them, and how they grow over many steps.

use amberfield_tests::{CsvTable, FoamBox};
use rustix::process::{Pid, Signal, kill_process};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Growth of a process's memory that counts as none [bytes].
const FLAT: u64 = 4 << 20;
/// Change of the net charge of 100 grains of 1 pC that is round-off [C].
const ROUND_OFF: f64 = 1e-24;
/// Kinetic energy of a bed at rest, over the largest that it had.
const RESTING: f64 = 1e-6;

#[test]
fn two_runs_at_once_do_not_meet() {
    let scenes = [FoamBox::grounded(), FoamBox::grounded()];
    let start = |scene: &FoamBox| {
        let run = ["run", "scene.toml", "--out", "out", "--no-progress", "--set", "solver.ranks=2"];
        scene.bench.command(&run).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
    };
    let runs = scenes.each_ref().map(start);
    for mut run in runs {
        assert!(run.wait().unwrap().success());
    }
    let [one, other] =
        scenes.each_ref().map(|scene| CsvTable::parse(&scene.bench.read("out/history.csv")).without_clocks());
    assert_eq!(one, other);
}

#[test]
fn what_a_run_shares_is_its_users_alone() {
    use std::os::unix::fs::MetadataExt as _;
    let scene = FoamBox::grounded();
    let mut run = scene.endless();
    let solver = scene.solver();
    let shared: Vec<_> = std::fs::read_dir("/dev/shm")
        .unwrap()
        .flatten()
        .filter(|entry| entry.file_name().to_string_lossy().starts_with("amberfield-"))
        .collect();
    let me = rustix::process::getuid().as_raw();
    assert!(!shared.is_empty());
    for entry in &shared {
        // Files of other tests may disappear meanwhile.
        let Ok(known) = entry.metadata() else { continue };
        assert!(known.uid() == me && known.mode() & 0o077 == 0, "{entry:?}: mode {:o}", known.mode());
    }
    for process in [Pid::from_child(&run), solver] {
        let inodes = sockets_of(process);
        for table in ["tcp", "tcp6", "udp", "udp6"] {
            let text = std::fs::read_to_string(format!("/proc/net/{table}")).unwrap_or_default();
            let known = text.lines().skip(1).filter_map(|line| line.split_whitespace().nth(9));
            assert!(known.clone().all(|inode| !inodes.contains(&inode.to_owned())), "{table}: {inodes:?}");
        }
    }
    kill_process(Pid::from_child(&run), Signal::INT).unwrap();
    run.wait().unwrap();
}

#[test]
fn a_run_that_is_a_rank_itself_starts_a_solver_of_several() {
    // Open MPI's launcher starts nothing from within a rank of its own.
    let scene = FoamBox::grounded();
    assert_eq!(scene.field("alone.csv", &["--set", "solver.ranks=2"]).code, Some(0));
    let field = scene.bench.command(&["field", "scene.toml", "--out", "rank.csv", "--set", "solver.ranks=2"]);
    let mut launcher = Command::new("mpirun");
    launcher.args(["--allow-run-as-root", "-np", "1"]).arg(field.get_program()).args(field.get_args());
    let output = launcher.current_dir(scene.bench.path("")).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(scene.e("alone.csv"), scene.e("rank.csv"));
}

/// Inode numbers of a process's sockets.
fn sockets_of(process: Pid) -> Vec<String> {
    let folder = format!("/proc/{}/fd", process.as_raw_nonzero());
    let files = std::fs::read_dir(folder).unwrap().flatten();
    let links = files.filter_map(|file| std::fs::read_link(file.path()).ok());
    let numbers = links.filter_map(|link| {
        let text = link.to_string_lossy().into_owned();
        Some(text.strip_prefix("socket:[")?.strip_suffix(']')?.to_owned())
    });
    numbers.collect()
}

/// Resources that the processes of a run hold.
#[derive(Clone, Copy, Debug, PartialEq)]
struct HeldResources {
    step: u64,
    /// Memory of the run and of the solver [bytes].
    memory: [u64; 2],
    /// Number of open files of the run and of the solver.
    files: [usize; 2],
    /// Number of files in shared memory.
    shared_files: usize,
    /// Size of the files in shared memory [bytes].
    shared_bytes: u64,
}

fn held(run: &str, step: u64, processes: [Pid; 2]) -> Option<HeldResources> {
    let of = |process: Pid, name: &str| format!("/proc/{}/{name}", process.as_raw_nonzero());
    let memory = |process| {
        let text = std::fs::read_to_string(of(process, "statm")).ok()?;
        Some(4096 * text.split(' ').nth(1)?.parse::<u64>().ok()?)
    };
    let files = |process| Some(std::fs::read_dir(of(process, "fd")).ok()?.count());
    let ours = std::fs::read_dir("/dev/shm").ok()?.flatten();
    let ours = ours.filter(|entry| entry.file_name().to_string_lossy().starts_with(run));
    let sizes: Vec<u64> = ours.filter_map(|entry| Some(entry.metadata().ok()?.len())).collect();
    let [dem, solver] = processes;
    Some(HeldResources {
        step,
        memory: [memory(dem)?, memory(solver)?],
        files: [files(dem)?, files(solver)?],
        shared_files: sizes.len(),
        shared_bytes: sizes.iter().sum(),
    })
}

/// Case of a small bed at rest, with rolling friction so that grains do not spin forever.
///
/// It has a million steps with an exchange every twenty if `AMBERFIELD_CASES=full`, else twenty thousand
/// steps with an exchange every two.
#[test]
fn a_long_run_holds_no_more_at_its_end_than_early_on() {
    let full = std::env::var("AMBERFIELD_CASES").is_ok_and(|size| size == "full");
    let (steps, interval): (u64, u64) = if full { (1_000_000, 20) } else { (20_000, 2) };
    let scene = FoamBox::grounded();
    let text = scene.bench.read("scene.toml");
    let plane = |point: [f64; 3], normal: [i32; 3]| {
        format!("[[walls]]\nplane = {{ point_m = {point:?}, normal = {normal:?} }}\n")
    };
    let (low, high) = ([1e-5; 3], [11.99e-3, 11.99e-3, 9.99e-3]);
    let sides = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    let walls = sides.map(|n| plane(low, n) + &plane(high, n.map(|c: i32| -c))).concat();
    let text = text
        .replace("count = 3000", "count = 100")
        .replace("[[materials]]", "[[materials]]\nrolling_friction = 0.1")
        .replace("[time]", &format!("coupling_interval = {interval}\n{walls}[time]"))
        .replace("'auto'\nend_s = 1e-3", &format!("1e-5\nend_s = {}", steps as f64 * 1e-5))
        + &format!("[output]\nevery_s = 1e3\nhistory_every_s = {}\n", steps as f64 * 1e-5 / 50.0);
    scene.bench.write("scene.toml", text);
    let mut command = scene.bench.command(&["run", "scene.toml", "--out", "out", "--no-progress"]);
    let mut run = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    scene.wait_until_it_steps(&mut run);
    let processes = [Pid::from_child(&run), scene.solver()];
    let line = std::fs::read(format!("/proc/{}/cmdline", processes[1].as_raw_nonzero())).unwrap();
    let line = String::from_utf8_lossy(&line).into_owned();
    let name = line.split('\0').find(|word| word.starts_with("amberfield-")).unwrap().to_owned();
    let mut seen: Vec<HeldResources> = Vec::new();
    while run.try_wait().unwrap().is_none() {
        let history = std::fs::read_to_string(scene.bench.path("out/history.csv")).unwrap();
        let step = history.lines().rfind(|line| line.matches(',').count() > 2);
        let step = step.and_then(|line| line.split(',').next()?.parse().ok()).unwrap_or(0);
        seen.extend(held(&name, step, processes));
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(run.wait().unwrap().success());
    // The last readings are left out, since a process that ends gives back what it holds.
    let early = *seen.iter().find(|held| held.step >= steps / 10).unwrap();
    let last = *seen.iter().rfind(|held| held.step <= steps * 98 / 100).unwrap();
    println!("{early:?}\n{last:?}");
    assert!(last.step > steps / 2, "{last:?}");
    assert_eq!((last.shared_files, last.shared_bytes), (early.shared_files, early.shared_bytes));
    // A process that looks whether its peer lives has two files more for a moment.
    let least = |from: u64, to: u64| {
        let files = seen.iter().filter(|held| (from..to).contains(&held.step)).map(|held| held.files);
        files.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])])
    };
    assert_eq!(least(steps * 8 / 10, steps * 98 / 100), least(steps / 10, steps * 3 / 10));
    for (early, last) in early.memory.iter().zip(last.memory) {
        assert!(last <= early + FLAT, "{early} bytes early on, {last} at the end");
    }
    let history = CsvTable::parse(&scene.bench.read("out/history.csv"));
    let charges = history.numbers("net_charge_C");
    assert!(charges.iter().all(|charge| (charge - charges[0]).abs() <= ROUND_OFF), "{charges:?}");
    // The bed is at rest, and the field that is extrapolated between exchanges does not heat it.
    let kinetic = history.numbers("kinetic_J");
    let (most, last) = (kinetic.iter().copied().fold(0.0, f64::max), kinetic[kinetic.len() - 1]);
    println!("kinetic energy: most {most:e} J, at the end {last:e} J");
    assert!(steps < 1_000_000 || last <= RESTING * most, "{last:e} J of at most {most:e} J");
}
