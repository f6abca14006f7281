//! Potentials of patches that are functions of time: closed forms, other ways to the same field, and what
//! must not matter.

use super::{difference, good};
use amberfield_tests::foam_case::{brick, write_case, write_gas_case};
use amberfield_tests::{Answer, CsvTable, FoamBox, Workbench};
use std::f64::consts::TAU;
use std::fmt::Write as _;

/// Frequency [Hz], level and amplitude [V] of a potential.
const FREQUENCY: f64 = 50.0;
const LEVEL: f64 = 6000.0;
const AMPLITUDE: f64 = 4000.0;
/// Distance of the plates [m].
const HEIGHT: f64 = 0.01;
/// Charge [C], radius [m] and density [kg/m³] of a light grain, whose images pull 2e-5 times as much as the
/// plates.
const CHARGE: f64 = 6e-14;
const RADIUS: f64 = 1e-4;
const DENSITY: f64 = 1000.0;
/// Start above the lower plate [m], and end of the run [s], after 1.2 periods.
const START: f64 = 8e-3;
const END: f64 = 0.024;

/// Conditions of the upper plate that are one sine.
const SINE: &str = "type uniformFixedValue; uniformValue sine; uniformValueCoeffs { frequency 50; amplitude \
    4000; scale 1; level 6000; }";
const SINE_IN_A_DICTIONARY: &str = "type uniformFixedValue; uniformValue { type sine; frequency 50; \
    amplitude 4000; scale 1; level 6000; } value uniform 17";

const SCENE: &str = "[[materials]]\nname = 'dust'\ndensity_kg_m3 = 1000.0\nyoung_Pa = 5e5\npoisson = 0.22\n\
    restitution = 0.6\nfriction = 0.3\n[particles]\nfile = 'grains.csv'\n[electric_field]\ntuning = 'model'\n\
    tolerance = 1e-2\n[time]\nstep_s = 1e-5\nend_s = 0.024\ngravity_m_s2 = [0, 0, 0]\n[output]\n\
    formats = ['csv']\nhistory_every_s = 1e-3\n";
const SOLVER: &str = "[solver]\nopenfoam_case = 'foam'\ntimeout_s = 20.0\n";

fn sine(t: f64) -> f64 {
    LEVEL + AMPLITUDE * (TAU * FREQUENCY * t).sin()
}

/// Rows of a table of the sine, `per_period` in a period.
fn rows(per_period: u32) -> impl Iterator<Item = (f64, f64)> {
    let time = move |row: u32| f64::from(row) / f64::from(per_period) / FREQUENCY;
    (0..=2 * per_period).map(time).map(|t| (t, sine(t)))
}

fn table(per_period: u32) -> String {
    let mut text = String::from("type uniformFixedValue; uniformValue table (");
    for (t, v) in rows(per_period) {
        write!(text, "({t:e} {v:e})").expect("a text");
    }
    text + ")"
}

/// Condition of a potential that stands in a file of the case.
fn csv(file: &str) -> String {
    format!(
        "type uniformFixedValue; uniformValue csvFile; uniformValueCoeffs {{ nHeaderLine 1; refColumn 0; \
         componentColumns (1); separator \",\"; mergeSeparators no; file \"<constant>/{file}\"; }}"
    )
}

/// A light grain between two plates with insulating sides; `upper` is the condition of the upper plate.
fn between_plates(upper: &str) -> Workbench {
    let bench = Workbench::new(&(SCENE.to_owned() + SOLVER));
    bench.write(
        "grains.csv",
        format!("id,x_m,y_m,z_m,radius_m,charge_C,material\n1,6e-3,6e-3,{START},{RADIUS},{CHARGE},dust\n"),
    );
    write_plates(&bench, upper, "type zeroGradient");
    bench
}

/// Writes a case of two plates with sides.
fn write_plates(bench: &Workbench, upper: &str, side: &str) {
    let (side, upper) = (format!("{side};"), format!("{upper};"));
    let side = ("wall", side.as_str());
    let lower = ("wall", "type fixedValue; value uniform 0;");
    let sides = [side, side, side, side, lower, ("wall", upper.as_str())];
    let brick = brick([12.0, 12.0, 1e3 * HEIGHT], [12, 12, 10], &sides);
    write_case(bench, &brick.mesh, &brick.conditions, "Gauss linear");
}

/// Scene of a case on the internal grid.
fn on_the_grid(bench: &Workbench, sides: &str) -> Workbench {
    let scene = bench.read("scene.toml").replace(SOLVER, "");
    let other = Workbench::new(&format!(
        "{scene}[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.012, 0.012, {HEIGHT}]\n[domain.boundary]\n\
         x = '{sides}'\ny = '{sides}'\nz_min = 'grounded'\nz_max = {{ potential_V = {{ amplitude = \
         {AMPLITUDE:?}, frequency_Hz = {FREQUENCY:?}, offset = {LEVEL:?} }} }}\n"
    ));
    other.write("grains.csv", bench.read("grains.csv"));
    other
}

fn run(bench: &Workbench, out: &str, more: &[&str]) -> Answer {
    bench.run(&[&["run", "scene.toml", "--out", out, "--no-progress"], more].concat())
}

/// Last file with all grains of a run.
fn last(bench: &Workbench, out: &str) -> String {
    let name = bench.names(&format!("{out}/particles")).pop().expect("particles");
    bench.read(&format!("{out}/particles/{name}"))
}

/// Coordinates of all grains at the end of a run [m].
fn places(bench: &Workbench, out: &str) -> Vec<f64> {
    let table = CsvTable::parse(&last(bench, out));
    ["x_m", "y_m", "z_m"].iter().flat_map(|name| table.numbers(name)).collect()
}

fn height(bench: &Workbench, out: &str) -> f64 {
    places(bench, out)[2]
}

/// Number from the summary of a run.
fn evaluations(bench: &Workbench, out: &str) -> u64 {
    let summary = bench.read(&format!("{out}/summary.json"));
    let (_, rest) = summary.split_once("\"evaluations\":").expect("a field");
    let digits: String = rest.trim_start().chars().take_while(char::is_ascii_digit).collect();
    digits.parse().expect("a number")
}

/// Height of the light grain at a time [m], and how far the oscillation alone moves it.
fn closed_form(t: f64) -> (f64, f64) {
    let mass = DENSITY * TAU * 2.0 / 3.0 * RADIUS.powi(3);
    let by_volt = -CHARGE / (mass * HEIGHT);
    let omega = TAU * FREQUENCY;
    let swing = AMPLITUDE * by_volt / (omega * omega);
    let expected = START + 0.5 * LEVEL * by_volt * t * t + swing * (omega * t - (omega * t).sin());
    (expected, (expected - START).abs())
}

#[test]
fn light_charge_between_plates_follows_the_closed_form_and_evaluations_the_sine() {
    let bench = between_plates(SINE);
    good(&run(&bench, "sine", &[]));
    let (expected, way) = closed_form(END);
    let error = |bench: &Workbench, out: &str| (height(bench, out) - expected).abs() / way;
    let of_sine = error(&bench, "sine");
    assert!(of_sine < 5e-3, "{of_sine:e}");
    let count = evaluations(&bench, "sine") as f64 * (1.0 / FREQUENCY / END);
    assert!((20.0..100.0).contains(&count), "{count}");

    // Steps in which E is evaluated every time err by the integrator and the cells alone.
    const HALF: f64 = 0.5 * END;
    let until = format!("time.end_s={HALF}");
    good(&run(&bench, "every", &["--set", "electric_field.coupling_interval=1", "--set", &until]));
    let (at_half, way_there) = closed_form(HALF);
    let of_every = (height(&bench, "every") - at_half).abs() / way_there;
    assert!(of_every < 1e-3, "{of_every:e}");
    // The interval that the scene fixes is kept, and the error is what it is.
    good(&run(&bench, "fixed", &["--set", "electric_field.coupling_interval=40"]));
    let of_fixed = error(&bench, "fixed");
    assert!(of_fixed < 2e-2, "{of_fixed:e}");
    println!(
        "sine {of_sine:e} with {count} evaluations a period, every step {of_every:e}, fixed {of_fixed:e}"
    );

    let grid = on_the_grid(&bench, "insulating");
    good(&run(&grid, "out", &[]));
    let apart = (height(&grid, "out") - height(&bench, "sine")).abs() / way;
    assert!(apart < 5e-3, "{apart:e}");
}

#[test]
fn it_does_not_matter_in_which_words_a_function_is_given() {
    let bench = between_plates(SINE);
    good(&run(&bench, "out", &[]));
    let (expected, way) = (height(&bench, "out"), closed_form(END).1);
    let other = between_plates(SINE_IN_A_DICTIONARY);
    good(&run(&other, "out", &[]));
    assert_eq!(last(&other, "out"), last(&bench, "out"));

    let other = between_plates(&table(200));
    good(&run(&other, "out", &[]));
    let apart = (height(&other, "out") - expected).abs() / way;
    assert!(apart < 2e-3, "table: {apart:e}");

    // The same rows in a file, which the solver finds in the case.
    let by_file = between_plates(&csv("v.csv"));
    std::fs::create_dir_all(by_file.path("foam/constant")).expect("a folder");
    let lines = rows(200).map(|(t, v)| format!("{t:e},{v:e}\n"));
    by_file.write("foam/constant/v.csv", "t,V\n".to_owned() + &lines.collect::<String>());
    good(&run(&by_file, "out", &[]));
    let apart = (height(&by_file, "out") - expected).abs() / way;
    assert!(apart < 2e-3, "file: {apart:e}");

    // A ramp as a polynomial and as a table.
    let ramp = |function: &str| {
        let bench = between_plates(&format!("type uniformFixedValue; uniformValue {function}"));
        good(&run(&bench, "out", &[]));
        height(&bench, "out")
    };
    let polynomial = ramp("polynomial ((1000 0) (2e5 1))");
    let table = ramp("table ((0 1000) (1 201000))");
    assert!((polynomial - table).abs() < 1e-6 * way, "{polynomial:e} {table:e}");
}

#[test]
fn constant_function_is_a_fixed_value_with_the_same_bits() {
    let wall = ("wall", "type fixedValue; value uniform 0;");
    let faces = "x = 'grounded'\ny = 'grounded'\nz = 'grounded'";
    let field = |condition: &str| {
        let scene =
            FoamBox::new(&[wall, wall, wall, wall, wall, ("wall", condition)], faces, "bipolar = 1e-12");
        good(&scene.field("out.csv", &[]));
        scene.bench.read("out.csv")
    };
    let fixed = field("type fixedValue; value uniform 700;");
    for condition in [
        "type uniformFixedValue; uniformValue 700;",
        "type uniformFixedValue; uniformValue constant 700; value uniform 3;",
        "type uniformFixedValue; uniformValue table ((0 700) (1 900));",
        "type uniformFixedValue; uniformValue table ((-1 700) (1 700)); value uniform 3;",
    ] {
        assert_eq!(field(condition), fixed, "{condition}");
    }
}

/// A few grains that push each other in a box whose lid has the sine.
fn bed() -> Workbench {
    let bench = between_plates(SINE);
    write_plates(&bench, SINE, "type fixedValue; value uniform 0");
    let mut grains = String::from("id,x_m,y_m,z_m,radius_m,charge_C,material\n");
    for id in 0..27 {
        let [x, y, z] = [id % 3, id / 3 % 3, id / 9].map(|k| 3e-3 + 2e-3 * f64::from(k));
        let charge = if id % 2 == 0 { CHARGE } else { -CHARGE };
        writeln!(grains, "{id},{x:e},{y:e},{z:e},{RADIUS},{charge:e},dust").expect("a text");
    }
    bench.write("grains.csv", grains);
    bench
}

#[test]
fn grains_in_a_box_move_as_on_the_internal_grid_and_on_two_ranks() {
    let bench = bed();
    let until = ["--set", "time.end_s=1e-2"];
    good(&run(&bench, "out", &until));
    let start = CsvTable::parse(&bench.read("grains.csv"));
    let start: Vec<f64> = ["x_m", "y_m", "z_m"].iter().flat_map(|name| start.numbers(name)).collect();
    let moved = |places: &[f64]| places.iter().zip(&start).map(|(a, b)| a - b).collect::<Vec<_>>();
    let one = moved(&places(&bench, "out"));

    let grid = on_the_grid(&bench, "grounded");
    good(&run(&grid, "out", &until));
    let apart = difference(&one, &moved(&places(&grid, "out")));
    assert!(apart < 2e-2, "{apart:e}");

    good(&run(&bench, "ranks", &[&until[..], &["--set", "solver.ranks=2"]].concat()));
    let by_ranks = difference(&one, &moved(&places(&bench, "ranks")));
    assert!(by_ranks < 1e-4, "{by_ranks:e}");

    good(&run(&bench, "overlap", &[&until[..], &["--set", "electric_field.overlap=true"]].concat()));
    let by_overlap = difference(&one, &moved(&places(&bench, "overlap")));
    assert!(by_overlap < 2e-2, "{by_overlap:e}");
    println!("grid {apart:e}, ranks {by_ranks:e}, overlap {by_overlap:e}");
}

#[test]
fn gas_and_a_potential_that_changes_come_from_one_process() {
    let bench = between_plates(SINE);
    let potential = bench.read("foam/0/phiE");
    let gas = "[gas]\nflow = 'solver'\ndrag = 'stokes'\ninterval_s = 5e-4\ndensity_kg_m3 = 1e-6\n\
        viscosity_Pa_s = 1.5e-11\n";
    bench.write("scene.toml", bench.read("scene.toml").replace(SOLVER, gas) + SOLVER);
    let (velocity, pressure) = (("wall", "type slip;"), ("wall", "type zeroGradient;"));
    let of = |side| brick([12.0, 12.0, 1e3 * HEIGHT], [12, 12, 10], &[side; 6]);
    write_gas_case(&bench, &of(velocity).mesh, &of(velocity).conditions, &of(pressure).conditions, 1.5e-5);
    bench.write("foam/0/phiE", potential);
    good(&run(&bench, "out", &["--set", "time.end_s=1e-2"]));
    // So thin a gas brakes the grain by less than 1e-5 of what the plates pull.
    let (expected, way) = closed_form(1e-2);
    let error = (height(&bench, "out") - expected).abs() / way;
    assert!(error < 5e-3, "{error:e}");
}

#[test]
fn runs_go_on_from_a_checkpoint_with_the_same_bits() {
    for more in [&[][..], &["--set", "electric_field.overlap=true"], &["--set", "solver.ranks=2"]] {
        let bench = bed();
        let steps = |out, steps: &[&str]| good(&run(&bench, out, &[more, steps].concat()));
        steps("whole", &["--steps", "700"]);
        steps("parts", &["--steps", "333"]);
        let checkpoint = bench.names("parts/checkpoints").pop().expect("a checkpoint");
        steps("parts", &["--resume", &format!("parts/checkpoints/{checkpoint}"), "--steps", "367"]);
        assert_eq!(last(&bench, "parts"), last(&bench, "whole"), "{more:?}");
    }
}

#[test]
fn functions_that_cannot_be_followed_are_refused_by_name() {
    let refused = |condition: &str, words: &[&str]| {
        let answer = run(&between_plates(condition), "out", &[]);
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        for word in words {
            assert!(answer.stderr.contains(word), "{word}: {}", answer.stderr);
        }
    };
    refused(
        "type uniformFixedValue; uniformValue { type mappedFile; } value uniform 0",
        &["patch z1 of field phiE", "0/phiE", "mappedFile", "from place to place", "table"],
    );
    refused(
        "type uniformFixedValue; uniformValue table ((0 5) (1e-3 9)); outOfBounds error",
        &["patch z1 of field phiE", "no value at t = ", "over the whole run"],
    );
    refused("type uniformFixedValue; uniformValue tabel ((0 5) (1e-3 9))", &["tabel", "0/phiE"]);
    refused(&csv("none.csv"), &["none.csv"]);
    // The box's own potentials do not count over OpenFOAM.
    let bench = between_plates(SINE);
    let domain = "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.012, 0.012, 0.01]\n[domain.boundary]\nx = \
        'insulating'\ny = 'insulating'\nz_min = 'grounded'\nz_max = { potential_V = { amplitude = 4e3, \
        frequency_Hz = 50.0 } }\n";
    bench.write("scene.toml", bench.read("scene.toml") + domain);
    let answer = run(&bench, "out", &[]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(
        answer.stderr.contains("uniformFixedValue") && answer.stderr.contains("z_max"),
        "{}",
        answer.stderr
    );
}
