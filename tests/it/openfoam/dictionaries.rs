//! Entries of OpenFOAM's dictionaries: honoured as in OpenFOAM's own solvers, or refused by name.

use super::{copy_example, good};
use amberfield_tests::foam_case::{brick, write_case, write_file, write_gas_case};
use amberfield_tests::{Answer, FoamBox, Workbench};
use std::path::{Path, PathBuf};

/// Acceleration of a gas by a source of `fvOptions` [m/s²].
const PUSH: f64 = 3.0;
/// Share of that momentum that a lone grain of 0.1 mm takes from the gas in 4 ms, over twice as much.
const TAKEN: f64 = 1e-4;
/// Folder into which function objects write.
const FUNCTIONS: &str = "postProcessing";
const WALL: (&str, &str) = ("wall", "type fixedValue; value uniform 0;");
const SCENE: &str = "[[materials]]\nname = 'glass'\ndensity_kg_m3 = 1000.0\nyoung_Pa = 5e5\npoisson = 0.22\n\
    restitution = 0.6\nfriction = 0.3\n[particles]\nfile = 'grains.csv'\n\
    [gas]\nflow = 'solver'\ndrag = 'stokes'\ninterval_s = 2e-4\ndensity_kg_m3 = 1.2\n\
    viscosity_Pa_s = 1.8e-5\n[time]\nstep_s = 'auto'\nend_s = 4e-3\ngravity_m_s2 = [0, 0, 0]\n\
    [solver]\nopenfoam_case = 'foam'\ntimeout_s = 20.0\n[output]\nformats = ['csv']\n";
const PROBES: &str = "functions { probes { type probes; libs (\"libsampling.so\"); fields (U alpha); \
    probeLocations ((5e-3 5e-3 5e-3)); writeControl timeStep; writeInterval 1; } \
    asleep { type nonsense; enabled false; } \
    electricField { type electricField; libs (\"libelectricField.so\"); } }\n";

fn add(bench: &Workbench, file: &str, text: &str) {
    bench.write(file, bench.read(file) + text);
}

fn change(bench: &Workbench, file: &str, from: &str, to: &str) {
    let text = bench.read(file);
    assert!(text.contains(from), "{file} has no {from}");
    bench.write(file, text.replacen(from, to, 1));
}

fn refused(answer: &Answer, words: &[&str]) {
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    for word in words {
        assert!(answer.stderr.contains(word), "{word}: {}", answer.stderr);
    }
}

#[test]
fn a_mistake_in_a_dictionary_is_bad_input_that_names_file_and_entry() {
    type Spoil = fn(&Workbench);
    let mistakes: [(Spoil, &[&str]); 7] = [
        (
            |bench| change(bench, "foam/0/phiE", "fixedValue", "fixedValu"),
            &["fixedValu", "0/phiE.boundaryField.x0, line 4"],
        ),
        (
            |bench| change(bench, "foam/0/phiE", "type fixedValue; value", "type calculated; value"),
            &["patch x0 of field phiE has the condition calculated"],
        ),
        (
            |bench| {
                let mapped = "type uniformFixedValue; uniformValue { type mappedFile; } value";
                change(bench, "foam/0/phiE", "type fixedValue; value", mapped);
            },
            &["patch x0 of field phiE", "uniformFixedValue", "mappedFile"],
        ),
        (
            |bench| change(bench, "foam/system/fvSchemes", "Gauss linear corrected", "none"),
            &["laplacian(V)", "fvSchemes.laplacianSchemes"],
        ),
        (
            |bench| add(bench, "foam/system/fvSolution", "solvers { V { solver PCGG; } }"),
            &["PCGG", "fvSolution.solvers.V"],
        ),
        (
            |bench| add(bench, "foam/system/controlDict", "functions { mean { type meen; } }"),
            &["function mean of system/controlDict"],
        ),
        (
            |bench| {
                let text = "dynamicFvMesh dynamicMotionSolverFvMesh;\n";
                write_file(bench, "constant/dynamicMeshDict", "dictionary", text);
            },
            &["constant/dynamicMeshDict", "dynamicMotionSolverFvMesh"],
        ),
    ];
    for (spoil, words) in mistakes {
        let scene = FoamBox::grounded();
        spoil(&scene.bench);
        refused(&scene.field("out.csv", &[]), words);
    }
    let scene = FoamBox::grounded();
    add(&scene.bench, "foam/system/fvSolution", "solvers { V { solver PCGG; } }");
    refused(&scene.field("out.csv", &["--set", "solver.ranks=2"]), &["PCGG", "fvSolution.solvers.V"]);
}

#[test]
fn it_does_not_matter_in_which_words_a_condition_is_given() {
    let slope = ("patch", "type zeroGradient;");
    let faces = "x = 'grounded'\ny = 'grounded'\nz = 'insulating'";
    let scene = FoamBox::new(&[WALL, WALL, WALL, WALL, slope, slope], faces, "bipolar = 1e-12");
    let field = |name: &str, conditions: &str| {
        let brick = brick([12.0, 12.0, 10.0], [12, 12, 10], &[WALL, WALL, WALL, WALL, slope, slope]);
        write_case(&scene.bench, &brick.mesh, conditions, "Gauss linear");
        good(&scene.field(name, &[]));
        scene.bench.read(name)
    };
    let plain =
        field("plain.csv", "\"[xy].\" { type fixedValue; value uniform 0; } \"z.*\" { type zeroGradient; }");
    for (name, conditions) in [
        ("group.csv", "wall { type fixedValue; value uniform 0; } \".*\" { type slip; }"),
        (
            "uniform.csv",
            "wall { type uniformFixedValue; uniformValue constant 0; } \"z(0|1)\" { type fixedGradient; \
             gradient uniform 0; }",
        ),
    ] {
        assert_eq!(field(name, conditions), plain, "{name}");
    }
}

#[test]
fn functions_of_the_case_see_the_smooth_field_at_the_time_of_the_question() {
    let scene = FoamBox::grounded();
    good(&scene.field("plain.csv", &[]));
    let probes = PROBES.replace("U alpha", "electricField:V electricField:E");
    add(&scene.bench, "foam/system/controlDict", &probes);
    good(&scene.field("watched.csv", &[]));
    assert_eq!(scene.bench.read("watched.csv"), scene.bench.read("plain.csv"));
    let seen = rows(&scene.bench, "electricField:V");
    assert!(seen.len() == 1 && seen[0][0] == 0.0 && seen[0][1].is_normal(), "{seen:?}");

    remove(found(&scene.bench, FUNCTIONS));
    let run = ["run", "scene.toml", "--out", "out", "--no-progress", "--set", "time.end_s=2e-4"];
    good(&scene.bench.run(&run));
    let times: Vec<f64> = rows(&scene.bench, "electricField:E").iter().map(|row| row[0]).collect();
    assert!(times.len() > 1 && times.is_sorted_by(|a, b| a < b) && times[0] == 0.0, "{times:?}");
    assert!((1e-4..2.2e-4).contains(times.last().expect("some")), "{times:?}");
}

/// Box of gas that repeats along all axes, with a grain that takes next to nothing from it.
fn gas_box(options: &str) -> Workbench {
    let bench = Workbench::new(SCENE);
    let cyclic = brick([10.0; 3], [5; 3], &[("cyclic", "type cyclic;"); 6]);
    write_gas_case(&bench, &cyclic.mesh, &cyclic.conditions, &cyclic.conditions, 1.5e-5);
    write_file(&bench, "system/fvOptions", "dictionary", options);
    add(&bench, "foam/system/controlDict", &("writePrecision 14;\n".to_owned() + PROBES));
    bench.write("grains.csv", "id,x_m,y_m,z_m,radius_m,material\n1,7e-3,7e-3,7e-3,5e-5,glass\n");
    bench
}

fn run(bench: &Workbench, out: &str, more: &[&str]) -> Answer {
    bench.run(&[&["run", "scene.toml", "--out", out, "--no-progress"], more].concat())
}

#[test]
fn sources_of_fv_options_move_the_gas_and_functions_see_it() {
    let source = format!(
        "push {{ type vectorSemiImplicitSource; selectionMode all; volumeMode specific; \
         injectionRateSuSp {{ U (({PUSH} 0 0) 0); }} }}\n"
    );
    for scheme in ["Euler", "backward"] {
        let bench = gas_box(&source);
        change(&bench, "foam/system/fvSchemes", "default Euler", &format!("default {scheme}"));
        good(&run(&bench, "out", &[]));
        let seen = rows(&bench, "U");
        assert!(seen.len() >= 20, "{seen:?}");
        let interval = seen[0][0];
        for (step, row) in (1..).zip(&seen) {
            let [time, x, y, z] = row[..] else { panic!("{row:?}") };
            assert!((time / interval - f64::from(step)).abs() < 1e-9, "one row a step: {row:?}");
            assert!((x - PUSH * time).abs() < TAKEN * PUSH * time, "{scheme}: {row:?}");
            assert!(y.abs() + z.abs() < TAKEN * x, "{scheme}: {row:?}");
        }
    }
}

#[test]
fn conditions_that_are_functions_of_time_follow_the_run_whatever_the_case_starts_from() {
    let wall = ("wall", "type slip;");
    let ramp = "type uniformFixedValue; uniformValue table ((0 (0 0 0)) (1 (0 0 5))); value uniform (0 0 0);";
    let out = "type pressureInletOutletVelocity; value uniform (0 0 0);";
    let edges = ([10.0; 3], [5; 3]);
    let velocity = brick(edges.0, edges.1, &[wall, wall, wall, wall, ("patch", ramp), ("patch", out)]);
    let slope = ("wall", "type zeroGradient;");
    let (below, above) = (("patch", slope.1), ("patch", "type fixedValue; value uniform 0;"));
    let pressure = brick(edges.0, edges.1, &[slope, slope, slope, slope, below, above]);
    let at_inlet = PROBES.replace("type probes", "type patchProbes; patches (z0)");
    let bench = gas_box("\n");
    write_gas_case(&bench, &velocity.mesh, &velocity.conditions, &pressure.conditions, 1.5e-5);
    add(&bench, "foam/system/controlDict", &("startTime 0.5;\nwritePrecision 14;\n".to_owned() + &at_inlet));
    std::fs::rename(bench.path("foam/0"), bench.path("foam/0.5")).expect("it is there");
    good(&run(&bench, "out", &[]));
    let seen = rows(&bench, "U");
    assert!(seen.len() >= 20, "{seen:?}");
    for row in &seen {
        assert!((row[3] - 5.0 * row[0]).abs() < 1e-9 * row[3], "{row:?}");
    }
}

#[test]
fn backward_and_a_mean_velocity_go_on_bit_for_bit() {
    let bench = gas_box("mean { type meanVelocityForce; selectionMode all; fields (U); Ubar (0.1 0 0); }\n");
    change(&bench, "foam/system/fvSchemes", "default Euler", "default backward");
    good(&run(&bench, "whole", &["--steps", "1000"]));
    let whole = rows(&bench, "U");
    assert!((whole.last().expect("rows")[1] - 0.1).abs() < 1e-3, "{whole:?}");
    remove(found(&bench, FUNCTIONS));
    good(&run(&bench, "parts", &["--steps", "400"]));
    let checkpoint = bench.names("parts/checkpoints").pop().expect("a checkpoint");
    let checkpoint = format!("parts/checkpoints/{checkpoint}");
    good(&run(&bench, "parts", &["--resume", &checkpoint, "--steps", "600"]));
    let parts = rows(&bench, "U");
    assert!(whole.len() > 8, "{whole:?}");
    assert_eq!(parts, whole);
    let last = |out: &str| {
        let name = bench.names(&format!("{out}/particles")).pop().expect("particles");
        bench.read(&format!("{out}/particles/{name}"))
    };
    assert_eq!(last("parts"), last("whole"));
}

#[test]
fn openfoams_example_of_a_channel_keeps_its_mean_velocity_and_its_averages() {
    const MEAN: f64 = 0.1335;
    let scene = SCENE.replace("density_kg_m3 = 1.2", "density_kg_m3 = 0.9").replace("2e-4", "0.2");
    let bench = Workbench::new(&scene.replace("'auto'", "1e-2").replace("4e-3", "1.0"));
    bench.write("grains.csv", "id,x_m,y_m,z_m,radius_m,material\n1,2,1,1,0.05,glass\n");
    copy_example(&bench, "incompressible/pimpleFoam/LES/channel395");
    remove(vec![bench.path("foam/0")]);
    std::fs::rename(bench.path("foam/0.orig"), bench.path("foam/0")).expect("it is there");
    change(&bench, "foam/system/controlDict", "writeInterval   200", "writeInterval 3");
    refused(&run(&bench, "out", &[]), &["WALE", "constant/turbulenceProperties.LES"]);
    change(&bench, "foam/constant/turbulenceProperties", "WALE", "Smagorinsky");
    refused(&run(&bench, "out", &[]), &["div(alphaPhi,U)", "fvSchemes.divSchemes"]);
    change(&bench, "foam/system/fvSchemes", "div(phi,U) ", "default Gauss linear; div(alphaPhi,U) ");
    for _ in 0..2 {
        change(&bench, "foam/system/blockMeshDict", "(40 25 30)", "(10 8 8)");
    }
    remove(found(&bench, "polyMesh"));
    good(&run(&bench, "out", &[]));
    let log = found(&bench, "log.amberPimpleFoam").pop().expect("a log");
    let log = std::fs::read_to_string(log).expect("it can be read");
    let means: Vec<f64> = log
        .split("uncorrected Ubar = ")
        .skip(1)
        .map(|rest| rest[..rest.find(',').expect("a list")].parse().expect("a number"))
        .collect();
    assert!(means.len() >= 15 && (means[means.len() - 1] / MEAN - 1.0).abs() < 1e-3, "{means:?}");
    assert!(!found(&bench, "UMean").is_empty(), "the function fieldAverage writes");
}

#[test]
fn what_a_gas_between_grains_cannot_do_is_refused_by_name() {
    let refuses = |spoil: &dyn Fn(&Workbench), words: &[&str]| {
        let bench = gas_box("\n");
        spoil(&bench);
        refused(&run(&bench, "out", &[]), words);
        assert!(!bench.path("out/history.csv").exists(), "nothing has begun");
    };
    let crank = "default CrankNicolson 0.9";
    refuses(
        &|bench| change(bench, "foam/system/fvSchemes", "default Euler", crank),
        &["CrankNicolson", "ddt(alpha)"],
    );
    let rotor = "rotor { cellZone rotor; origin (0 0 0); axis (0 0 1); omega 10; }\n";
    refuses(
        &|bench| write_file(bench, "constant/MRFProperties", "dictionary", rotor),
        &["constant/MRFProperties", "zone rotor"],
    );
    let model = "simulationType RAS;\nRAS { RASModel kEpsilonn; turbulence on; printCoeffs off; }\n";
    refuses(&|bench| write_file(bench, "constant/turbulenceProperties", "dictionary", model), &["kEpsilonn"]);
    refuses(
        &|bench| write_file(bench, "system/fvOptions", "dictionary", "push { type pushh; }\n"),
        &["pushh"],
    );
    refuses(&|bench| std::fs::remove_file(bench.path("foam/0/U")).expect("it is there"), &["/0/U"]);
}

fn remove(folders: Vec<PathBuf>) {
    for folder in folders {
        std::fs::remove_dir_all(folder).expect("it is there");
    }
}

/// Files and folders of a name below the folder of a test.
fn found(bench: &Workbench, name: &str) -> Vec<PathBuf> {
    fn look(folder: &Path, name: &str, found: &mut Vec<PathBuf>) {
        for path in std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()) {
            if path.ends_with(name) {
                found.push(path);
            } else if path.is_dir() && !path.is_symlink() {
                look(&path, name, found);
            }
        }
    }
    let mut found = Vec::new();
    look(&bench.path(""), name, &mut found);
    found
}

/// Numbers that the function `probes` wrote of a field: rows of time and components, by time.
fn rows(bench: &Workbench, field: &str) -> Vec<Vec<f64>> {
    let begins = found(bench, FUNCTIONS).into_iter().flat_map(|folder| {
        std::fs::read_dir(folder.join("probes")).into_iter().flatten().flatten().map(|entry| entry.path())
    });
    let texts = begins.map(|begin| std::fs::read_to_string(begin.join(field)).expect("what was probed"));
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for text in texts {
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let words = line.split([' ', '(', ')', '\t']).filter(|word| !word.is_empty());
            rows.push(words.map(|word| word.parse().expect("a number")).collect());
        }
    }
    rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
    rows
}
