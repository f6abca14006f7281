//! Runs in a gas whose flow OpenFOAM computes, started as a user starts them.

use super::good;
use amberfield_tests::foam_case::{foam_program, perturb, write_file};
use amberfield_tests::{Answer, CsvTable, DEADLINE, GAS_SCENE, Workbench, gas_box};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Adds turbulence by OpenFOAM's model with k and ε.
fn add_turbulence(bench: &Workbench) {
    let field = |name: &str, dimensions: &str, value: f64, above: &str| {
        let text = format!(
            "dimensions {dimensions};\ninternalField uniform {value};\n\
             boundaryField {{ z0 {{ type fixedValue; value uniform {value}; }} \".*\" {{ type {above}; value \
             uniform {value}; }} }}\n"
        );
        write_file(bench, &format!("0/{name}"), "volScalarField", &text);
    };
    field("k", "[0 2 -2 0 0 0 0]", 1e-3, "zeroGradient");
    field("epsilon", "[0 2 -3 0 0 0 0]", 1e-2, "zeroGradient");
    field("nut", "[0 2 -1 0 0 0 0]", 1e-5, "calculated");
    let solution = bench.read("foam/system/fvSolution").replace("nOuterCorrectors 4;", "");
    bench.write("foam/system/fvSolution", solution);
    let model = "simulationType RAS;\nRAS { RASModel kEpsilon; turbulence on; printCoeffs off; }\n";
    write_file(bench, "constant/turbulenceProperties", "dictionary", model);
}

fn run(bench: &Workbench, out: &str, more: &[&str]) -> Answer {
    bench.run(&[&["run", "scene.toml", "--out", out, "--no-progress"], more].concat())
}

/// Text of the last particle file.
fn grains(bench: &Workbench, out: &str) -> String {
    let last = bench.names(&format!("{out}/particles")).pop().unwrap_or_default();
    bench.read(&format!("{out}/particles/{last}"))
}

#[test]
fn a_run_in_a_gas_goes_on_bit_for_bit_from_its_checkpoint() {
    for (overlap, stirred) in [("false", true), ("true", false)] {
        let set = format!("electric_field.overlap={overlap}");
        let gas = format!("gas.overlap={overlap}");
        let sets = ["--set", &set, "--set", &gas];
        let bench = gas_box(GAS_SCENE);
        if stirred {
            add_turbulence(&bench);
        }
        good(&run(&bench, "whole", &sets));
        good(&run(&bench, "parts", &[&sets[..], &["--steps", "150"]].concat()));
        let checkpoint = bench.names("parts/checkpoints").pop().expect("a checkpoint");
        let checkpoint = format!("parts/checkpoints/{checkpoint}");
        let answer = run(&bench, "parts", &[&sets[..], &["--resume", &checkpoint]].concat());
        good(&answer);
        for word in ["of momentum", "steps of the flow", "Courant number", "void fraction", "drag up to"] {
            assert!(answer.stderr.contains(word), "{word}: {}", answer.stderr);
        }
        assert_eq!(grains(&bench, "parts"), grains(&bench, "whole"), "overlap = {overlap}");
    }
}

#[test]
fn a_run_in_a_gas_that_was_killed_ends_as_if_it_had_not_been() {
    let bench = gas_box(GAS_SCENE);
    let often = ["--set", "output.checkpoint_every_s=1e-3"];
    good(&run(&bench, "whole", &often));
    let begin = [&["run", "scene.toml", "--out", "killed", "--no-progress"], &often[..]].concat();
    let mut child = bench.command(&begin).stderr(Stdio::null()).stdout(Stdio::null()).spawn().unwrap();
    let begun = Instant::now();
    while bench.names("killed/checkpoints").len() < 3 {
        assert!(begun.elapsed() < DEADLINE, "checkpoints must come");
        std::thread::sleep(Duration::from_millis(2));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let checkpoint = bench.names("killed/checkpoints").into_iter().rfind(|name| name.ends_with(".amber"));
    let checkpoint = format!("killed/checkpoints/{}", checkpoint.expect("a whole checkpoint"));
    good(&run(&bench, "killed", &[&often[..], &["--resume", &checkpoint]].concat()));
    assert_eq!(grains(&bench, "killed"), grains(&bench, "whole"));
    good(&bench.run(&["doctor", "--clean"]));
}

#[test]
fn a_gas_starts_from_the_time_that_the_case_names_at_a_resume_too() {
    let bench = gas_box(GAS_SCENE);
    let controls = bench.read("foam/system/controlDict");
    let latest = controls.replace("startFrom startTime", "startFrom latestTime");
    let latest = latest
        .replace("writeInterval 1e9;", "writeInterval 1e-3;")
        .replace("writeControl none", "writeControl runTime");
    assert_ne!(latest, controls);
    bench.write("foam/system/controlDict", latest);
    good(&run(&bench, "whole", &[]));
    assert!(bench.names("whole/solver").len() > 8, "{:?}", bench.names("whole/solver"));
    for options in [&["--steps", "150"][..], &["--steps", "150", "--overwrite"]] {
        good(&run(&bench, "parts", options));
    }
    let checkpoint = format!("parts/checkpoints/{}", bench.names("parts/checkpoints").pop().expect("one"));
    let history = bench.read("parts/history.csv");
    let ranks = run(&bench, "parts", &["--resume", &checkpoint, "--set", "solver.ranks=2"]);
    assert_eq!(ranks.code, Some(2), "{}", ranks.stderr);
    assert!(ranks.stderr.contains("solver.ranks is 2 and was not given"), "{}", ranks.stderr);
    assert_eq!(bench.read("parts/history.csv"), history);
    good(&run(&bench, "parts", &["--resume", &checkpoint]));
    assert_eq!(grains(&bench, "parts"), grains(&bench, "whole"));
}

#[test]
fn a_run_in_a_gas_needs_no_charge_and_is_the_same_with_two_ranks() {
    let scene = GAS_SCENE.replace("charge_C = { bipolar = 2e-12 }", "charge_C = { constant = 0.0 }");
    let scene = scene.replace("[electric_field]\ntuning = 'model'\ntolerance = 2e-2\n", "");
    let bench = gas_box(&scene);
    std::fs::remove_file(bench.path("foam/0/phiE")).expect("it is there");
    good(&run(&bench, "one", &[]));
    good(&run(&bench, "two", &["--set", "solver.ranks=2"]));
    let numbers = |out: &str| -> Vec<f64> {
        grains(&bench, out)
            .lines()
            .skip(1)
            .flat_map(|line| {
                line.split(',').skip(1).take(3).map(|x| x.parse().unwrap()).collect::<Vec<f64>>()
            })
            .collect()
    };
    let (one, two) = (numbers("one"), numbers("two"));
    let apart = one.iter().zip(&two).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(one.len() > 2000 && one.len() == two.len() && apart < 1e-7, "{apart}");
    let plan = bench.run(&["explain", "scene.toml"]);
    good(&plan);
    assert!(plan.stdout.contains("flow of another process, model A; drag (di_felice)"), "{}", plan.stdout);
    assert!(plan.stdout.contains("gas interval"), "{}", plan.stdout);
}

#[test]
fn the_log_says_what_a_mesh_and_its_patches_ask_for() {
    let bench = gas_box(&GAS_SCENE.replace("end_s = 8e-3", "end_s = 1e-3"));
    let quiet = run(&bench, "quiet", &[]);
    good(&quiet);
    assert!(!quiet.stderr.contains("leastSquares"), "{}", quiet.stderr);
    let velocity = bench.read("foam/0/U");
    let begin = velocity.find("type interstitialInletVelocity").expect("it has one");
    let end = begin + velocity[begin..].find('}').expect("it ends");
    let rate = "type flowRateInletVelocity; volumetricFlowRate constant 6e-5; value uniform (0 0 0.6); ";
    bench.write("foam/0/U", format!("{}{rate}{}", &velocity[..begin], &velocity[end..]));
    foam_program(&bench, "blockMesh", &[]);
    perturb(&bench, 10.0, 4, 0.1);
    let told = run(&bench, "told", &[]);
    good(&told);
    for word in ["patch z0 (flowRateInletVelocity)", "leastSquares"] {
        assert!(told.stderr.contains(word), "{word}: {}", told.stderr);
    }
}

#[test]
fn a_gas_that_cannot_be_is_refused_by_name() {
    let refused = |bench: &Workbench, set: &[&str], code: i32, expected: &str| {
        let options: Vec<&str> = set.iter().flat_map(|set| ["--set", *set]).collect();
        let answer = run(bench, "out", &options);
        assert_eq!(answer.code, Some(code), "{}", answer.stderr);
        assert!(answer.stderr.contains(expected), "{expected}: {}", answer.stderr);
    };
    let bench = gas_box(GAS_SCENE);
    refused(&bench, &["gas.velocity_m_s=[0, 0, 1]"], 2, "gas.velocity_m_s");
    refused(&bench, &["gas.flow=\"uniform\""], 2, "needs a flow that is computed");
    refused(&bench, &["gas.model=\"C\""], 2, "gas.model");
    refused(&bench, &["gas.model=\"B\"", "gas.viscous_force=true"], 2, "acts on the gas alone");
    refused(&bench, &["solver.on_solver_loss=\"wait\""], 2, "needs solver.on_solver_loss = \"stop\"");
    refused(&bench, &["solver.application=\"DPMFoam\""], 2, "cannot compute the flow");
    refused(&bench, &["gas.interval_s=1.0"], 2, "gas.interval_s is");
    refused(&bench, &["gas.viscosity_Pa_s=1e-3"], 2, "constant/transportProperties");
    refused(&bench, &["gas.smoothing_length_m=-1.0"], 2, "gas.smoothing_length_m");
    let alone = gas_box(&GAS_SCENE[..GAS_SCENE.find("[solver]").expect("it has one")]);
    refused(&alone, &[], 2, "a solver must compute the flow; add [solver]");
    let potential = bench.read("foam/0/phiE");
    std::fs::remove_file(bench.path("foam/0/phiE")).expect("it is there");
    refused(&bench, &[], 2, "no potential 0/phiE");
    bench.write("foam/0/phiE", potential);
    std::fs::remove_file(bench.path("foam/0/U")).expect("it is there");
    refused(&bench, &[], 2, "/0/U");
    assert_eq!(bench.names("out"), ["solver"], "nothing has begun");
}

#[test]
fn a_fluidised_bed_to_start_from_runs() {
    let bench = Workbench::new("");
    good(&bench.run(&["new", "fluidised-bed"]));
    good(&bench.run(&["run", "fluidised-bed/scene.toml", "--out", "out", "--steps", "60", "--no-progress"]));
}

/// Scene whose grains come by a feed into the gas, without gravity.
fn fed() -> String {
    let (before, rest) = GAS_SCENE.split_once("[particles]").unwrap();
    let (_, after) = rest.split_once("[electric_field]").unwrap();
    let (_, after) = after.split_once("[gas]").unwrap();
    let feed = "[particles]\non_exit = 'delete'\n[[feeds]]\nname = 'rain'\nmaterial = 'glass'\n\
        region = { box = { min_m = [0.001, 0.001, 0.02], max_m = [0.009, 0.009, 0.029] } }\n\
        rate_per_s = 1e4\nend_s = 4e-3\nradius_m = 5e-4\nvelocity_m_s = [0, 0, -1]\n[gas]";
    // In model B all that the gas gives is drag.
    format!("{before}{feed}\nmodel = 'B'{after}")
        .replace("gravity_m_s2 = [0, 0, -9.81]", "gravity_m_s2 = [0, 0, 0]")
}

#[test]
fn grains_of_a_feed_take_from_the_gas_what_it_says_that_it_gave() {
    let bench = gas_box(&fed());
    let answer = run(&bench, "whole", &[]);
    good(&answer);
    let all = grains(&bench, "whole");
    let table = CsvTable::parse(&all);
    let speeds = table.numbers("vz_m_s");
    assert_eq!(speeds.len(), 40, "{}", answer.stderr);
    let mass = 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * 5e-4_f64.powi(3);
    let gained: f64 = speeds.iter().map(|speed| mass * (speed + 1.0)).sum();
    let (_, said) = answer.stderr.split_once("gas: gave the grains ").expect("a line about the gas");
    let given: f64 = said.split(' ').next().unwrap().parse().unwrap();
    assert!(gained > 0.0 && (given / gained - 1.0).abs() < 0.01, "{given:e} {gained:e}");

    // A checkpoint while grains come.
    good(&run(&bench, "parts", &["--steps", "60"]));
    let checkpoint = bench.names("parts/checkpoints").pop().expect("a checkpoint");
    good(&run(&bench, "parts", &["--resume", &format!("parts/checkpoints/{checkpoint}")]));
    assert_eq!(grains(&bench, "parts"), all);
    good(&run(&bench, "one", &["--threads", "1"]));
    assert_eq!(grains(&bench, "one"), all);
}
