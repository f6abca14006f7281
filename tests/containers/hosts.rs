//! A run over two machines: two containers with a private network, an SSH server each, and nothing shared.
//!
//! The run is on `one`; `mpirun` there starts half of the solver on `two`.

use crate::{Ended, text};
use amberfield_tests::{CsvTable, DEADLINE, FoamBox, GAS_SCENE, Workbench, gas_box};
use std::io::Write as _;
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Words of every run.
const OPTIONS: [&str; 8] =
    ["run", "scene.toml", "--no-progress", "--overwrite", "--out", "out", "--set", "solver.ranks=2"];
/// Variables for MPI: both machines have the same cores, on the first of which each would put its rank.
const SHARED_CORES: [&str; 2] = ["OMPI_MCA_hwloc_base_binding_policy=none", "OMPI_MCA_mpi_yield_when_idle=1"];
/// Option with which the ranks are on both machines.
const HOSTS: [&str; 2] = ["--set", "solver.hosts=hosts.txt"];
/// Processes of which none may be left.
const OURS: [&str; 6] = ["amberfield", "electricField", "amberPimple", "mpirun", "orted", "ssh "];

/// Two machines; they are removed at the end with all that belongs to them.
struct Machines {
    /// Folder of the run on the first machine, as `/case` there.
    bench: Workbench,
    /// Folder on the second, as `/case` there.
    copy: tempfile::TempDir,
    /// Beginning of all names, which are unique to the test.
    project: String,
}

impl Machines {
    /// Starts two machines, on the first of which is a scene; the first may log in on the second.
    fn start(bench: Workbench) -> Self {
        bench.write("hosts.txt", "one slots=1\ntwo slots=1\n");
        let folder = bench.path("").canonicalize().unwrap();
        let name = folder.file_name().unwrap().to_string_lossy().to_lowercase().replace('.', "");
        let machines =
            Self { bench, copy: tempfile::tempdir().unwrap(), project: format!("amberfield{name}") };
        let network = machines.network();
        done(Command::new("docker").args(["network", "create", "--internal", &network]));
        for (host, folder) in [("one", folder.as_path()), ("two", machines.copy.path())] {
            let (container, case) = (machines.container(host), format!("{}:/case", folder.display()));
            let run =
                ["run", "-d", "--init", "--name", &container, "--hostname", host, "--network", &network];
            let more = ["--network-alias", host, "-v", &case, "-w", "/case"];
            let environment = SHARED_CORES.iter().flat_map(|variable| ["-e", variable]);
            done(Command::new("docker").args(run).args(more).args(environment).arg("amberfield-host"));
        }
        machines.on(
            "one",
            "mkdir -p -m 700 ~/.ssh && ssh-keygen -q -t ed25519 -N '' -f ~/.ssh/id_ed25519",
            "",
        );
        let key = machines.on("one", "cat ~/.ssh/id_ed25519.pub", "");
        machines.on("two", "mkdir -p -m 700 ~/.ssh && cat > ~/.ssh/authorized_keys", &key);
        let known = machines.on("two", "sed 's/^/two /' /etc/ssh/ssh_host_ed25519_key.pub", "");
        machines.on("one", "cat > ~/.ssh/known_hosts", &known);
        let begun = Instant::now();
        while machines.ask("one", "ssh two true").is_none() {
            assert!(begun.elapsed() < DEADLINE, "the second machine must take a login");
            std::thread::sleep(Duration::from_millis(100));
        }
        machines
    }

    fn network(&self) -> String {
        format!("{}-network", self.project)
    }

    fn container(&self, host: &str) -> String {
        format!("{}-{host}", self.project)
    }

    /// Runs a line of the shell on a machine and returns what it prints; `None` where it fails.
    fn ask(&self, host: &str, line: &str) -> Option<String> {
        let mut shell = Command::new("docker");
        shell.args(["exec", &self.container(host), "sh", "-c", line]);
        let output = shell.output().expect("docker starts");
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
    }

    /// Runs a line of the shell that must work on a machine, with an input.
    fn on(&self, host: &str, line: &str, input: &str) -> String {
        let mut shell = Command::new("docker");
        shell.args(["exec", "-i", &self.container(host), "sh", "-c", line]);
        let mut child = shell.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("docker starts");
        child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{host}: {line}");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }

    /// Starts `amberfield` on the first machine.
    fn amberfield(&self, options: &[&str]) -> Child {
        let mut run = Command::new("docker");
        run.args(["exec", &self.container("one"), "amberfield"]).args(OPTIONS).args(options);
        run.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped()).spawn().expect("docker starts")
    }

    /// Runs on the first machine alone, then copies all to the second: with nothing shared, both need the
    /// case and its parts at the same path. Returns the history.
    fn alone(&self, options: &[&str]) -> CsvTable {
        let Ended { code, said } = ended(self.amberfield(options));
        assert_eq!(code, 0, "{said}");
        let mut copy = Command::new("cp");
        done(copy.arg("-a").arg(self.bench.path(".")).arg(self.copy.path()));
        self.history()
    }

    fn history(&self) -> CsvTable {
        CsvTable::parse(&self.bench.read("out/history.csv")).without_clocks()
    }

    /// Starts a run over both machines that does not end by itself, and waits until it steps.
    fn endless(&self) -> Child {
        let history = self.bench.path("out/history.csv");
        std::fs::remove_file(&history).unwrap();
        let mut run = self.amberfield(&[&HOSTS[..], &["--set", "time.end_s=1e3"]].concat());
        let begun = Instant::now();
        while std::fs::read_to_string(&history).map_or(0, |text| text.lines().count()) < 4 {
            let lives = run.try_wait().unwrap().is_none();
            assert!(lives && begun.elapsed() < DEADLINE, "the run must begin: {}", ended(run).said);
            std::thread::sleep(Duration::from_millis(20));
        }
        run
    }

    /// Waits until nothing of a run is left on a machine: no process, nothing in its shared memory.
    fn assert_nothing_left(&self, host: &str) {
        let begun = Instant::now();
        loop {
            let processes = self.on(host, "ps -e -o args", "");
            let ours = processes.lines().filter(|line| OURS.iter().any(|name| line.contains(name)));
            let left: Vec<&str> = ours.filter(|line| !line.contains("sshd")).collect();
            let memory = self.on(host, "ls /dev/shm", "");
            if left.is_empty() && memory.is_empty() {
                return;
            }
            assert!(begun.elapsed() < DEADLINE, "{host} must be left clean: {left:?}, {memory}");
            std::thread::sleep(Duration::from_millis(100));
        }
    }
}

impl Drop for Machines {
    fn drop(&mut self) {
        // What root has written in the folders goes with them.
        for host in ["one", "two"] {
            let _ = text(&["rm", "-f", &self.container(host)]);
        }
        let _ = text(&["network", "rm", &self.network()]);
    }
}

/// Runs a command that must work.
fn done(command: &mut Command) {
    let Output { status, stderr, .. } = command.output().expect("the command starts");
    assert!(status.success(), "{command:?}: {}", String::from_utf8_lossy(&stderr));
}

/// End of a program.
fn ended(child: Child) -> Ended {
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    Ended { code: output.status.code().unwrap_or(-1), said }
}

/// Few grains in a grounded box, with a row of the history for each step.
fn field_scene() -> Workbench {
    let bench = FoamBox::grounded().bench;
    let text = bench.read("scene.toml").replace("count = 3000", "count = 300").replace("1e-12", "1e-15");
    let text = text.replace("-9.81", "0").replace("end_s = 1e-3", "end_s = 2e-4");
    bench.write("scene.toml", text + "[output]\nhistory_every_s = 1e-5\n");
    bench
}

#[test]
fn a_field_over_two_machines_is_that_of_one() {
    let machines = Machines::start(field_scene());
    let alone = machines.alone(&[]);
    let Ended { code, said } = ended(machines.amberfield(&HOSTS));
    assert_eq!(code, 0, "{said}");
    let log = machines.bench.read("out/solver/log.electricFieldFoam");
    assert!(log.contains("1 of 2 ranks are on other machines"), "{log}");
    // The same numbers are added in the same order, wherever they are.
    assert_eq!(machines.history(), alone);
    for host in ["one", "two"] {
        machines.assert_nothing_left(host);
    }
}

#[test]
fn a_gas_over_two_machines_is_that_of_one_and_goes_on_from_a_checkpoint() {
    let scene = GAS_SCENE.replace("end_s = 8e-3", "end_s = 1e-3");
    let machines = Machines::start(gas_box(&scene));
    let alone = machines.alone(&[]);
    let Ended { code, said } = ended(machines.amberfield(&[&HOSTS[..], &["--steps", "10"]].concat()));
    assert_eq!(code, 0, "{said}");
    let log = machines.bench.read("out/solver/log.amberPimpleFoam");
    assert!(log.contains("1 of 2 ranks are on other machines"), "{log}");
    let checkpoint = machines.bench.names("out/checkpoints").pop().expect("a checkpoint");
    let resume = format!("amberfield run scene.toml --no-progress --resume out/checkpoints/{checkpoint}");
    machines.on("one", &format!("{resume} --set solver.ranks=2 {} {}", HOSTS[0], HOSTS[1]), "");
    assert_eq!(machines.history(), alone);
}

#[test]
fn a_machine_that_dies_ends_the_run_and_leaves_nothing() {
    let machines = Machines::start(field_scene());
    let _ = machines.alone(&[]);
    let run = machines.endless();
    let _ = text(&["kill", "-s", "KILL", &machines.container("two")]);
    let Ended { code, said } = ended(run);
    assert_eq!(code, 3, "{said}");
    assert!(said.contains("field solver") && said.contains("--resume"), "{said}");
    machines.assert_nothing_left("one");
    done(Command::new("docker").args(["start", &machines.container("two")]));
    machines.assert_nothing_left("two");
}

#[test]
fn a_run_that_is_killed_leaves_nothing_on_the_other_machine() {
    let machines = Machines::start(field_scene());
    let _ = machines.alone(&[]);
    let run = machines.endless();
    machines.on("one", "pkill -KILL -x amberfield", "");
    assert_ne!(ended(run).code, 0);
    for host in ["one", "two"] {
        machines.assert_nothing_left(host);
    }
}
