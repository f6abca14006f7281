//! Command `amberfield field`.

use crate::scenes::{PAIR, PAIR_CSV};
use amberfield_tests::{CsvTable, Workbench};

/// Error of rounding two terms and of reading 17 digits.
const ROUND_OFF: f64 = 1e-14;
/// Coulomb's constant 1/(4πε₀) [V·m/C], CODATA 2018.
const COULOMB: f64 = 8.987_551_792_261_171e9;

fn bench() -> Workbench {
    let bench = Workbench::new(PAIR);
    bench.write("pair.csv", PAIR_CSV);
    bench
}

#[test]
fn two_charges_feel_coulomb() {
    let bench = bench();
    let answer = bench.run(&["field", "scene.toml", "--out", "e.csv", "--repeat", "3"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let table = CsvTable::parse(&bench.read("e.csv"));
    assert_eq!(table.columns, ["id", "ex_V_per_m", "ey_V_per_m", "ez_V_per_m", "potential_V"]);
    assert_eq!(table.numbers("id"), [5.0, 3.0]);
    for (found, expected) in [
        (table.numbers("ex_V_per_m"), [COULOMB * 2e-9 / 0.25, COULOMB * 1e-9 / 0.25]),
        (table.numbers("potential_V"), [-COULOMB * 2e-9 / 0.5, COULOMB * 1e-9 / 0.5]),
    ] {
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < ROUND_OFF, "{found} {expected}");
        }
    }
    let report: serde_json::Value = serde_json::from_str(&bench.read("e.json")).unwrap();
    assert_eq!(report["method"], "direct");
    assert!(report["seconds"]["total"]["min"].as_f64() <= report["seconds"]["total"]["median"].as_f64());
    for key in [
        "parameters",
        "pairs_per_particle",
        "grid_cells",
        "error_estimated",
        "error_measured",
        "threads",
        "version",
    ] {
        assert!(report.get(key).is_some(), "{key}");
    }
}

#[test]
fn components_add_up() {
    let bench = bench();
    let answer = bench.run(&[
        "field",
        "scene.toml",
        "--out",
        "e.csv",
        "--components",
        "--set",
        "electric_field.external_field_V_m=[10, 0, 0]",
    ]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let table = CsvTable::parse(&bench.read("e.csv"));
    assert_eq!(table.columns.len(), 23);
    let total = table.numbers("ex_V_per_m");
    for (row, total) in total.iter().enumerate() {
        let sum: f64 = ["near", "middle", "far", "correction", "faces", "external"]
            .iter()
            .map(|part| table.numbers(&format!("{part}_ex_V_per_m"))[row])
            .sum();
        assert!((sum / total - 1.0).abs() < ROUND_OFF, "{sum} {total}");
    }
}

#[test]
fn the_command_line_overrides_the_scene() {
    let bench = bench();
    let answer =
        bench.run(&["field", "scene.toml", "--method", "p3m", "--tolerance", "1e-3", "--out", "e.csv"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let report: serde_json::Value = serde_json::from_str(&bench.read("e.json")).unwrap();
    assert_eq!(report["method"], "p3m");
    assert_eq!(bench.run(&["field", "scene.toml", "--method", "ewald"]).code, Some(2));
    assert_eq!(bench.run(&["field", "scene.toml", "--tolerance", "-1"]).code, Some(2));
}

#[test]
fn grains_outside_the_group_neither_make_nor_feel_the_field() {
    let bench = bench();
    let rows = "id,x_m,y_m,z_m,radius_m,charge_C,group\n1,0.25,0.5,0.5,0,1e-9,a\n2,0.5,0.5,0.5,0,1e-6,\n\
        3,0.75,0.5,0.5,0,-2e-9,a\n";
    bench.write("pair.csv", rows);
    let answer =
        bench.run(&["field", "scene.toml", "--out", "e.csv", "--set", "electric_field.particle_group=a"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let ex = CsvTable::parse(&bench.read("e.csv")).numbers("ex_V_per_m");
    assert!((ex[0] / (COULOMB * 2e-9 / 0.25) - 1.0).abs() < ROUND_OFF);
    assert_eq!(ex[1], 0.0);
}

#[test]
fn a_net_charge_without_a_field_is_bad_input() {
    let bench = bench();
    let periodic = PAIR.replace("open", "periodic");
    bench.write("scene.toml", periodic);
    let answer = bench.run(&["field", "scene.toml"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.stderr.contains("net charge"), "{}", answer.stderr);
}

#[test]
fn unit_charges_and_metres_are_a_scene() {
    let bench = bench();
    bench
        .write("pair.csv", "id,x_m,y_m,z_m,radius_m,charge_C\n5,0.25,0.5,0.5,0,2.5\n3,0.75,0.5,0.5,0,-1.5\n");
    let answer = bench.run(&["field", "scene.toml", "--out", "e.csv"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let potential = CsvTable::parse(&bench.read("e.csv")).numbers("potential_V");
    assert!((potential[0] / (-COULOMB * 1.5 / 0.5) - 1.0).abs() < ROUND_OFF, "{potential:?}");
}
