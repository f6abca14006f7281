//! Runs whose far field OpenFOAM computes; `cargo xtask openfoam` builds the solver.

use amberfield_tests::{Answer, Bench, Table};
use rustix::process::{Pid, Signal, kill_process, test_kill_process};
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for something that takes a fraction of a second.
const DEADLINE: Duration = Duration::from_secs(60);
/// The two tolerances of 1e-2, whose squares add.
const AGREEMENT: f64 = 1.4e-2;

const HEAD: &str = "FoamFile { version 2.0; format ascii; class CLASS; object OBJECT; }\n";

/// Half-and-half charged grains in a box; every boundary as `phiE` and `[domain.boundary]` say it.
struct Box {
    bench: Bench,
}

impl Box {
    fn new(sides: &[(&str, &str)], faces: &str, charge: &str) -> Self {
        let scene = format!(
            "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.012, 0.012, 0.01]\n[domain.boundary]\n{faces}\n\
             [[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 5e5\npoisson = 0.22\nrestitution = 0.6\nfriction = 0.3\n\
             [particles]\non_exit = 'delete'\ngenerate = {{ material = 'glass', count = 3000, radius_m = 2.5e-4, seed = 3, charge_C = {{ {charge} }} }}\n\
             [electric_field]\ntuning = 'model'\n[time]\nstep_s = 'auto'\nend_s = 1e-3\ngravity_m_s2 = [0, 0, -9.81]\n\
             [solver]\nopenfoam_case = 'foam'\ntimeout_s = 20.0\n"
        );
        let bench = Bench::new(&scene);
        for folder in ["foam/0", "foam/system"] {
            std::fs::create_dir_all(bench.path(folder)).unwrap();
        }
        let file = |name: &str, class: &str, text: &str| {
            let object = name.rsplit('/').next().unwrap();
            let head = HEAD.replace("CLASS", class).replace("OBJECT", object);
            bench.write(&format!("foam/{name}"), head + text);
        };
        let quads = ["(0 4 7 3)", "(1 2 6 5)", "(0 1 5 4)", "(3 7 6 2)", "(0 3 2 1)", "(4 5 6 7)"];
        let names = ["x0", "x1", "y0", "y1", "z0", "z1"];
        let patches: String = (0..6)
            .map(|side| {
                let (kind, faces) = (sides[side].0, quads[side]);
                let other = names[side ^ 1];
                format!("{} {{ type {kind}; neighbourPatch {other}; faces ({faces}); }}\n", names[side])
            })
            .collect();
        let conditions: String =
            (0..6).map(|side| format!("{} {{ {} }}\n", names[side], sides[side].1)).collect();
        file(
            "system/blockMeshDict",
            "dictionary",
            &format!(
                "convertToMeters 1e-3;\nvertices ((0 0 0) (12 0 0) (12 12 0) (0 12 0) (0 0 10) (12 0 10) (12 12 10) (0 12 10));\n\
                 blocks (hex (0 1 2 3 4 5 6 7) (12 12 10) simpleGrading (1 1 1));\nboundary ({patches});\n"
            ),
        );
        file(
            "system/controlDict",
            "dictionary",
            "startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; writeInterval 1;\n",
        );
        file(
            "system/fvSchemes",
            "dictionary",
            "ddtSchemes { default none; } gradSchemes { default Gauss linear; } divSchemes { default none; }\n\
             laplacianSchemes { default Gauss linear corrected; } interpolationSchemes { default linear; } snGradSchemes { default corrected; }\n",
        );
        file("system/fvSolution", "dictionary", "solvers {}\n");
        file(
            "0/phiE",
            "volScalarField",
            &format!(
                "dimensions [1 2 -3 0 0 -1 0];\ninternalField uniform 0;\nboundaryField {{ {conditions} }}\n"
            ),
        );
        Self { bench }
    }

    fn grounded() -> Self {
        let wall = ("wall", "type fixedValue; value uniform 0;");
        Self::new(&[wall; 6], "x = 'grounded'\ny = 'grounded'\nz = 'grounded'", "bipolar = 1e-12")
    }

    fn field(&self, out: &str, options: &[&str]) -> Answer {
        self.bench.run(&[&["field", "scene.toml", "--out", out], options].concat())
    }

    /// E of a result.
    fn e(&self, out: &str) -> Vec<f64> {
        let table = Table::parse(&self.bench.read(out));
        ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].iter().flat_map(|name| table.numbers(name)).collect()
    }

    /// Without `[solver]`.
    fn alone(&self) {
        let scene = self.bench.read("scene.toml");
        self.bench.write("scene.toml", &scene[..scene.find("[solver]").unwrap()]);
    }

    /// Starts a run that goes on for ever and waits until it has begun to step.
    fn endless(&self) -> Child {
        let scene = self.bench.read("scene.toml").replace("end_s = 1e-3", "end_s = 1e3");
        self.bench.write("endless.toml", scene);
        let out =
            ["run", "endless.toml", "--out", "out", "--no-progress", "--set", "output.history_every_s=1e-5"];
        let mut child =
            self.bench.command(&out).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let begun = Instant::now();
        let rows = || {
            std::fs::read_to_string(self.bench.path("out/history.csv")).map_or(0, |text| text.lines().count())
        };
        while rows() < 4 {
            assert!(begun.elapsed() < DEADLINE && child.try_wait().unwrap().is_none(), "the run must begin");
            std::thread::sleep(Duration::from_millis(5));
        }
        child
    }

    /// The field solver of this folder's case.
    fn solver(&self) -> Pid {
        let case = self.bench.path("foam").canonicalize().unwrap().display().to_string();
        let is_it = |entry: &std::fs::DirEntry| {
            let line = std::fs::read(entry.path().join("cmdline")).unwrap_or_default();
            String::from_utf8_lossy(&line)
                .replace('\0', " ")
                .contains(&format!("electricFieldFoam -case {case}"))
        };
        let found = std::fs::read_dir("/proc").unwrap().flatten().find(is_it).expect("the solver runs");
        Pid::from_raw(found.file_name().to_string_lossy().parse().unwrap()).unwrap()
    }
}

fn good(answer: &Answer) {
    assert_eq!(answer.code, Some(0), "{}{}", answer.stdout, answer.stderr);
}

fn difference(a: &[f64], b: &[f64]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    (square(&mut a.iter().zip(b).map(|(a, b)| a - b)) / square(&mut b.iter().copied())).sqrt()
}

fn agrees_with_the_internal_grid(scene: &Box) {
    good(&scene.field("one.csv", &[]));
    good(&scene.field("two.csv", &["--set", "solver.ranks=2"]));
    scene.alone();
    good(&scene.field("alone.csv", &[]));
    let (one, two, alone) = (scene.e("one.csv"), scene.e("two.csv"), scene.e("alone.csv"));
    assert!(difference(&one, &alone) < AGREEMENT, "{:e}", difference(&one, &alone));
    assert!(difference(&two, &one) < 1e-4, "one rank and two: {:e}", difference(&two, &one));
}

#[test]
fn grounded_box_agrees_with_the_internal_grid() {
    agrees_with_the_internal_grid(&Box::grounded());
}

#[test]
fn mixed_box_agrees_with_the_internal_grid() {
    let (cyclic, wall) = (("cyclic", "type cyclic;"), "wall");
    let sides = [
        cyclic,
        cyclic,
        (wall, "type zeroGradient;"),
        (wall, "type fixedGradient; gradient uniform -2000;"),
        (wall, "type fixedValue; value uniform 0;"),
        (wall, "type fixedValue; value uniform 300;"),
    ];
    let faces = "x = 'periodic'\ny_min = 'insulating'\ny_max = { normal_field_V_m = 2000.0 }\nz_min = 'grounded'\nz_max = { potential_V = 300.0 }";
    agrees_with_the_internal_grid(&Box::new(&sides, faces, "bipolar = 1e-12"));
}

#[test]
fn periodic_box_agrees_and_refuses_a_net_charge() {
    let sides = [("cyclic", "type cyclic;"); 6];
    let faces = "x = 'periodic'\ny = 'periodic'\nz = 'periodic'";
    agrees_with_the_internal_grid(&Box::new(&sides, faces, "bipolar = 1e-12"));
    let answer = Box::new(&sides, faces, "constant = 1e-12").field("out.csv", &[]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("net charge"), "{}", answer.stderr);
}

/// The published hybrid: the same cells, the same operator, the same gradient.
#[test]
fn kolehmainen_over_openfoam_is_that_of_the_internal_grid() {
    let scene = Box::grounded();
    let radius = ["--method", "kolehmainen", "--set", "electric_field.field_cutoff_radius=2e-3"];
    good(
        &scene
            .field("coupled.csv", &[&radius[..], &["--set", "electric_field.far_tolerance=1e-10"]].concat()),
    );
    scene.alone();
    good(
        &scene.field(
            "alone.csv",
            &[&radius[..], &["--set", "electric_field.grid.cells=[12, 12, 10]"]].concat(),
        ),
    );
    let error = difference(&scene.e("coupled.csv"), &scene.e("alone.csv"));
    assert!(error < 1e-6, "{error:e}");
}

/// 20 000 grains, three tenths of the volume, on cells of 2.9 diameters.
#[test]
fn coarse_mesh_errs_by_less_than_8_in_1000() {
    const MOST: f64 = 8e-3;
    let many = ["--set", "particles.generate.count=20000", "--set", "particles.generate.radius_m=1.727e-4"];
    let wall = ("wall", "type fixedValue; value uniform 0;");
    let faces = "x = 'grounded'\ny = 'grounded'\nz = 'grounded'";
    for charge in ["bipolar = 1e-12", "constant = 1e-12"] {
        let scene = Box::new(&[wall; 6], faces, charge);
        good(&scene.field("coupled.csv", &[&many[..], &["--tolerance", "5e-3"]].concat()));
        scene.alone();
        good(&scene.field("exact.csv", &[&many[..], &["--tolerance", "1e-5"]].concat()));
        let error = difference(&scene.e("coupled.csv"), &scene.e("exact.csv"));
        println!("{charge}: {error:.2e}");
        assert!(error < MOST, "{charge}: {error:e}");
    }
}

#[test]
fn bad_cases_are_refused_by_name() {
    let scene = Box::grounded();
    let phi = scene.bench.read("foam/0/phiE");
    scene.bench.write("foam/0/phiE", phi.replacen("fixedValue", "slip", 1));
    let answer = scene.field("out.csv", &[]);
    assert_eq!(answer.code, Some(3), "{}", answer.stderr);
    assert!(answer.stderr.contains("patch x0 of field phiE has the condition slip"), "{}", answer.stderr);

    let answer = Box::grounded().field("out.csv", &["--set", "domain.boundary.x=\"periodic\""]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("[domain] is periodic along x"), "{}", answer.stderr);

    let scene = Box::grounded();
    std::fs::remove_file(scene.bench.path("foam/system/blockMeshDict")).unwrap();
    let answer = scene.field("out.csv", &[]);
    assert_eq!(answer.code, Some(3), "{}", answer.stderr);
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
    let scene = Box::grounded();
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
        Table::parse(&scene.bench.read(&format!("{out}/history.csv")))
            .without_clocks()
            .rows
            .pop()
            .map(|row| (row, name))
    };
    assert_eq!(last("out").unwrap().0, last("whole").unwrap().0);
}

#[test]
fn a_run_that_waits_starts_a_killed_solver_again_and_nothing_is_lost() {
    let scene = Box::grounded();
    let text = scene.bench.read("scene.toml") + "on_solver_loss = 'wait'\n[output]\nhistory_every_s = 1e-5\n";
    scene.bench.write("scene.toml", text.replace("end_s = 1e-3", "end_s = 6e-3").replace("1e-12", "1e-13"));
    good(&scene.bench.run(&["run", "scene.toml", "--out", "quiet", "--no-progress"]));
    let mut run = scene
        .bench
        .command(&["run", "scene.toml", "--out", "out", "--no-progress"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begun = Instant::now();
    while std::fs::read_to_string(scene.bench.path("out/history.csv")).map_or(0, |text| text.lines().count())
        < 4
    {
        assert!(begun.elapsed() < DEADLINE && run.try_wait().unwrap().is_none(), "the run must begin");
        std::thread::sleep(Duration::from_millis(2));
    }
    kill_process(scene.solver(), Signal::KILL).unwrap();
    let output = run.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.contains("waiting for a new one"), "{said}");
    let rows = |out: &str| Table::parse(&scene.bench.read(&format!("{out}/history.csv"))).without_clocks();
    assert_eq!(rows("out"), rows("quiet"));
}

#[test]
fn a_killed_dem_process_leaves_neither_solver_nor_shared_memory() {
    let scene = Box::grounded();
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
    // Whoever inherits the dead process's child may be slow to bury it.
    let lives = || {
        let state = std::fs::read_to_string(format!("/proc/{}/stat", solver.as_raw_nonzero()));
        state.is_ok_and(|state| !state.contains(") Z "))
    };
    while lives() || left() {
        assert!(begun.elapsed() < DEADLINE, "the solver leaves and cleans");
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(scene.bench.read("foam/log.electricFieldFoam").contains("DEM process is gone"));
}

#[test]
fn a_hung_solver_is_missed_in_time_and_killed() {
    let scene = Box::grounded();
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
    let scene = Box::grounded();
    let run = scene.endless();
    let solver = scene.solver();
    kill_process(Pid::from_child(&run), Signal::INT).unwrap();
    let output = run.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(test_kill_process(solver).is_err());
    assert!(scene.bench.read("foam/log.electricFieldFoam").contains("The run is over."));
}
