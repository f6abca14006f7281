//! The user's case: read and never written, and what it says counts.

use super::{difference, good};
use amberfield_tests::foam_case::{brick, foam_program, write_case, write_file};
use amberfield_tests::{Answer, CsvTable, Workbench};
use flate2::{Compression, write::GzEncoder};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::time::{Duration, SystemTime};

const SCENE: &str = "[particles]\nfile = 'grains.csv'\n[electric_field]\ntuning = 'model'\n\
    [solver]\nopenfoam_case = 'foam'\ntimeout_s = 60.0\n";
const GRAINS: &str = "id,x_m,y_m,z_m,radius_m,charge_C,material\n1,2e-3,1.1e-3,2.1e-3,1e-4,1e-13,glass\n\
    2,7e-3,2.9e-3,1.3e-3,1e-4,-1e-13,glass\n";
const MOTION: &str = "[[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 5e5\npoisson = 0.22\n\
    restitution = 0.6\nfriction = 0.3\n[time]\nstep_s = 1e-6\nend_s = 1e-3\n";
/// Electrode at one end of the box, a grounded one at the other.
const ENDS: &str = "\".*\" { type zeroGradient; } x0 { type fixedValue; value uniform 0; } \
    x1 { type fixedValue; #include \"include/voltage\" }";

/// Case of a box of 10 mm with an electrode, whose voltage is in a file of its own.
fn bench(scene: &str) -> Workbench {
    let bench = Workbench::new(scene);
    let side = ("wall", "");
    let mesh = brick([10.0, 4.0, 4.0], [10, 4, 4], &[side; 6]).mesh;
    write_case(&bench, &mesh, ENDS, "Gauss linear");
    set_voltage(&bench, 0.0);
    bench.write("grains.csv", GRAINS);
    bench
}

fn set_voltage(bench: &Workbench, volts: f64) {
    fs::create_dir_all(bench.path("foam/0/include")).unwrap();
    bench.write("foam/0/include/voltage", format!("value uniform {volts};\n"));
}

fn field(bench: &Workbench, options: &[&str]) -> Answer {
    bench.run(&[&["field", "scene.toml", "--out", "out.csv"], options].concat())
}

/// Mean E along x at the two grains [V/m]: what they do to each other is the same for both.
fn mean_e(bench: &Workbench) -> f64 {
    let e = CsvTable::parse(&bench.read("out.csv")).numbers("ex_V_per_m");
    0.5 * (e[0] + e[1])
}

/// Voltage of the electrode by which the field of the last command came about [V].
fn voltage_felt(bench: &Workbench, grounded: f64) -> f64 {
    -1e-2 * (mean_e(bench) - grounded)
}

/// Every file below a folder with its content, those behind links left out.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap().flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().into_owned());
        if path.is_symlink() {
            continue;
        }
        if path.is_dir() {
            found.extend(files(&path).into_iter().map(|(inner, bytes)| (format!("{name}/{inner}"), bytes)));
        } else {
            found.insert(name, fs::read(&path).unwrap());
        }
    }
    found
}

#[test]
fn what_a_case_says_counts_whatever_the_times_of_its_files() {
    let bench = bench(SCENE);
    for ranks in ["solver.ranks=1", "solver.ranks=2"] {
        let felt = |grounded: f64| {
            good(&field(&bench, &["--set", ranks]));
            voltage_felt(&bench, grounded)
        };
        set_voltage(&bench, 0.0);
        let phi = bench.read("foam/0/phiE");
        felt(0.0);
        let grounded = mean_e(&bench);
        let is = |expected: f64, what: &str| {
            let volts = felt(grounded);
            assert!((volts - expected).abs() < 0.2, "{ranks}, {what}: {volts} V for {expected}");
        };
        set_voltage(&bench, 100.0);
        is(100.0, "an included file");
        bench.write("foam/0/phiE", phi.replace("#include \"include/voltage\"", "value uniform 50;"));
        let file = fs::File::options().append(true).open(bench.path("foam/0/phiE")).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(1_000_000)).unwrap();
        is(50.0, "an older file");
        let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
        packed
            .write_all(phi.replace("#include \"include/voltage\"", "value uniform 80;").as_bytes())
            .unwrap();
        bench.write("foam/0/phiE.gz", packed.finish().unwrap());
        fs::remove_file(bench.path("foam/0/phiE")).unwrap();
        is(80.0, "a compressed file");
        fs::remove_file(bench.path("foam/0/phiE.gz")).unwrap();
        bench.write("foam/0/phiE", phi);
    }
}

#[test]
fn parts_are_made_once_and_a_failed_cut_leaves_nothing() {
    let bench = bench(SCENE);
    write_file(&bench, "0/T", "volScalarField", "dimensions [0 0 0 1 0 0 0]; internalField unform 0;");
    let two = ["--set", "solver.ranks=2"];
    let answer = field(&bench, &two);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("decomposePar failed") && answer.stderr.contains("unform"));
    assert!(answer.stderr.contains("out-solver/log.decomposePar"), "{}", answer.stderr);
    fs::remove_file(bench.path("foam/0/T")).unwrap();
    let answer = field(&bench, &two);
    good(&answer);
    assert!(answer.stderr.contains("cutting"), "{}", answer.stderr);
    let answer = field(&bench, &two);
    good(&answer);
    assert!(!answer.stderr.contains("cutting"), "{}", answer.stderr);
}

#[test]
fn case_is_read_and_never_written() {
    let bench = bench(&(SCENE.to_owned() + MOTION));
    let before = files(&bench.path("foam"));
    good(&field(&bench, &[]));
    good(&field(&bench, &["--set", "solver.ranks=2"]));
    good(&bench.run(&["run", "scene.toml", "--out", "a", "--steps", "3", "--set", "solver.ranks=2"]));
    good(&bench.run(&["explain", "scene.toml"]));
    assert!(files(&bench.path("foam")) == before);
    assert!(bench.path("a/solver/log.electricFieldFoam").is_file());
}

#[test]
fn blanks_and_quotation_marks_in_paths_are_no_matter() {
    let bench = bench(SCENE);
    good(&field(&bench, &[]));
    let plain = bench.read("out.csv");
    let folder = bench.path("Miller's \"bed\"");
    fs::create_dir(&folder).unwrap();
    for name in ["scene.toml", "grains.csv", "foam"] {
        fs::rename(bench.path(name), folder.join(name)).unwrap();
    }
    for ranks in ["solver.ranks=1", "solver.ranks=2"] {
        let scene = "Miller's \"bed\"/scene.toml";
        let out = "Miller's \"bed\"/out.csv";
        good(&bench.run(&["field", scene, "--out", out, "--set", ranks]));
        let e = |text: &str| CsvTable::parse(text).numbers("ex_V_per_m");
        let difference = difference(&e(&bench.read(out)), &e(&plain));
        assert!(difference < 1e-3, "{ranks}: {difference:e}");
    }
}

#[test]
fn run_starts_from_the_time_that_the_case_names() {
    let bench = bench(SCENE);
    good(&field(&bench, &[]));
    let grounded = mean_e(&bench);
    let controls = bench.read("foam/system/controlDict");
    let at_five = bench.read("foam/0/phiE").replace("#include \"include/voltage\"", "value uniform 70;");
    fs::create_dir(bench.path("foam/5")).unwrap();
    fs::create_dir(bench.path("foam/7.50")).unwrap();
    bench.write("foam/5/phiE", at_five);
    for (set, expected) in [
        ("startFrom startTime; startTime 0;", 0.0),
        ("startFrom startTime; startTime 5.0;", 70.0),
        // Where a time lacks the field, the one before has it.
        ("startFrom startTime; startTime 7.5;", 70.0),
        ("startFrom latestTime; startTime 0;", 70.0),
        ("startFrom firstTime; startTime 5;", 0.0),
        ("time 5; startFrom startTime; startTime $time;", 70.0),
        ("/* startFrom firstTime; */ startFrom latestTime; // startFrom firstTime;\n", 70.0),
    ] {
        bench.write("foam/system/controlDict", controls.replace("startFrom startTime; startTime 0;", set));
        for ranks in ["solver.ranks=1", "solver.ranks=2"] {
            good(&field(&bench, &["--set", ranks]));
            let volts = voltage_felt(&bench, grounded);
            assert!((volts - expected).abs() < 0.2, "{set}, {ranks}: {volts} V");
        }
    }
    let refused = |set: &str, said: &str| {
        bench.write("foam/system/controlDict", controls.replace("startFrom startTime; startTime 0;", set));
        let answer = field(&bench, &[]);
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        assert!(answer.stderr.contains(said), "{}", answer.stderr);
    };
    refused("startFrom startTime; startTime 3;", "it has 0, 5, 7.50");
    refused("startFrom begin;", "startFrom is begin");
    for time in ["5", "7.50"] {
        fs::remove_dir_all(bench.path("foam").join(time)).unwrap();
    }
    fs::rename(bench.path("foam/0"), bench.path("foam/0.orig")).unwrap();
    refused("startFrom startTime; startTime 0;", "copy 0.orig to 0");
}

#[test]
fn mesh_that_is_not_there_or_older_than_its_recipe_is_named() {
    let bench = bench(SCENE);
    foam_program(&bench, "blockMesh", &[]);
    let recipe = bench.read("foam/system/blockMeshDict");
    let file = fs::File::options().append(true).open(bench.path("foam/system/blockMeshDict")).unwrap();
    file.set_modified(SystemTime::now() + Duration::from_secs(5)).unwrap();
    let answer = field(&bench, &[]);
    good(&answer);
    assert!(answer.stderr.contains("is newer than its mesh"), "{}", answer.stderr);

    fs::create_dir_all(bench.path("foam/constant/air")).unwrap();
    fs::rename(bench.path("foam/constant/polyMesh"), bench.path("foam/constant/air/polyMesh")).unwrap();
    fs::remove_file(bench.path("foam/system/blockMeshDict")).unwrap();
    let answer = field(&bench, &[]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("a case of several regions (air)"), "{}", answer.stderr);

    // A recipe that blockMesh refuses, and then not.
    bench.write("foam/system/blockMeshDict", recipe.replace("hex", "hax"));
    let answer = field(&bench, &[]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("blockMesh failed"), "{}", answer.stderr);
    bench.write("foam/system/blockMeshDict", recipe);
    good(&field(&bench, &[]));
}

fn run(bench: &Workbench, options: &[&str]) -> Answer {
    bench.run(&[&["run", "scene.toml", "--no-progress"], options].concat())
}

/// Last row of a history, without clocks.
fn last_row(bench: &Workbench, out: &str) -> Vec<String> {
    CsvTable::parse(&bench.read(&format!("{out}/history.csv"))).without_clocks().rows.pop().expect("a row")
}

#[test]
fn two_runs_on_one_case_keep_apart() {
    let bench = bench(&(SCENE.to_owned() + MOTION));
    good(&run(&bench, &["--out", "alone", "--steps", "50"]));
    let start = |out: &str, ranks: &str| {
        let options = ["run", "scene.toml", "--no-progress", "--out", out, "--steps", "50", "--set", ranks];
        bench.command(&options).spawn().unwrap()
    };
    let both = [start("a", "solver.ranks=1"), start("b", "solver.ranks=2")];
    for mut run in both {
        assert!(run.wait().unwrap().success());
    }
    assert_eq!(last_row(&bench, "a"), last_row(&bench, "alone"));
    for out in ["a", "b"] {
        assert!(bench.read(&format!("{out}/solver/log.electricFieldFoam")).contains("The run is over."));
    }
}

#[test]
fn resume_takes_other_technical_settings_and_names_what_is_physics() {
    // What has changed shows within ten steps.
    let often = SCENE.replace("[electric_field]", "[electric_field]\ncoupling_interval = 5");
    let bench = bench(&(often + MOTION));
    good(&run(&bench, &["--out", "whole", "--steps", "50"]));
    good(&run(&bench, &["--out", "half", "--steps", "40"]));
    let checkpoint = "half/checkpoints/step_000000000040.amber";
    let resume =
        |options: &[&str]| run(&bench, &[&["--resume", checkpoint, "--steps", "10"], options].concat());
    for set in [
        "solver.timeout_s=50",
        "solver.on_solver_loss=\"wait\"",
        "time.allow_unstable=true",
        "time.end_s=2e-3",
        "electric_field.tuning=\"timed\"",
        "output.formats=[\"csv\"]",
        "solver.ranks=2",
    ] {
        let answer = resume(&["--set", set]);
        good(&answer);
        let (row, whole) = (last_row(&bench, "half"), last_row(&bench, "whole"));
        if set == "solver.ranks=2" {
            let kinetic = [&row, &whole].map(|row| row[2].parse::<f64>().unwrap());
            assert!((kinetic[0] / kinetic[1] - 1.0).abs() < 1e-4, "{set}: {kinetic:?}");
        } else {
            assert_eq!(row, whole, "{set}");
        }
    }

    let before = files(&bench.path("half"));
    let refused = |answer: &Answer, said: &str| {
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        assert!(answer.stderr.contains(said), "{}", answer.stderr);
        assert!(files(&bench.path("half")) == before, "a refused resume touches nothing");
    };
    let answer = resume(&["--set", "time.step_s=2e-6", "--set", "electric_field.tolerance=1e-3"]);
    refused(&answer, "time.step_s is 0.000002 and was 0.000001");
    assert!(answer.stderr.contains("electric_field.tolerance is 0.001 and was not given"));
    bench.write("grains.csv", GRAINS.replace("1e-13", "2e-13"));
    refused(&resume(&[]), "grains.csv has other contents");
    bench.write("grains.csv", GRAINS);
    set_voltage(&bench, 1000.0);
    refused(&resume(&[]), "0/include/voltage (changed)");
    let answer = resume(&["--accept-changed-case"]);
    good(&answer);
    assert!(answer.stderr.contains("0/include/voltage (changed)"), "{}", answer.stderr);
    assert_ne!(last_row(&bench, "half"), last_row(&bench, "whole"));
}

#[test]
fn solver_that_somebody_else_starts_is_waited_for_and_what_to_type_is_said() {
    let bench = bench(SCENE);
    bench.write("hosts.txt", "here slots=3\n");
    let hosts = ["--set", "solver.hosts=hosts.txt"];
    for (ranks, hosts, expected) in [
        ("solver.ranks=1", &[][..], ["`electricFieldFoam -case /", ""]),
        ("solver.ranks=3", &[], ["`mpirun -np 3 electricFieldFoam -parallel -case /", ""]),
        ("solver.ranks=3", &hosts, ["`mpirun -np 3 --hostfile /", "hosts.txt electricFieldFoam -parallel"]),
    ] {
        let options = ["--set", "solver.start=false", "--set", "solver.wait_s=0.3", "--set", ranks];
        let answer = field(&bench, &[&options[..], hosts].concat());
        assert_eq!(answer.code, Some(3), "{}", answer.stderr);
        let error = answer.stderr.lines().last().unwrap();
        assert!(
            error.contains("nobody started a field solver within 3")
                && expected.iter().all(|words| error.contains(words)),
            "{error}"
        );
    }
}

#[test]
fn potentials_of_the_box_that_the_case_does_not_have_are_told() {
    let boxed = |face: &str| {
        let domain = format!(
            "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.01, 0.004, 0.004]\nboundary = {{ x_min = 'grounded', \
             x_max = {face}, y = 'insulating', z = 'insulating' }}\n"
        );
        let bench = bench(&(domain + SCENE));
        set_voltage(&bench, 5.0);
        bench
    };
    let same = field(&boxed("{ potential_V = 5 }"), &[]);
    good(&same);
    assert!(!same.stderr.contains("WARN domain.boundary"), "{}", same.stderr);
    let other = field(&boxed("{ potential_V = 7 }"), &[]);
    good(&other);
    for word in ["domain.boundary.x_max = { potential_V = 7 }", "the case has 5 V there", "0/phiE"] {
        assert!(other.stderr.contains(word), "{word}: {}", other.stderr);
    }
    let changing = field(&boxed("{ potential_V = { amplitude = 5, frequency_Hz = 50 } }"), &[]);
    assert_eq!(changing.code, Some(2), "{}", changing.stderr);
    assert!(
        changing.stderr.contains("domain.boundary.x_max has a potential that changes"),
        "{}",
        changing.stderr
    );
}
