//! Case of two plastics that a chute charges and plates sort.

use crate::support::{Case, full_size};

/// Grains of either plastic at smoke size.
const SMOKE: usize = 120;
/// Least share of the right plastic in a bin: what is charged by its own sign alone ends there.
const PURE: f64 = 0.95;
/// Largest rest of the charges over what the chute gave: sums of some thousand transfers.
const ROUND_OFF: f64 = 1e-11;

#[test]
fn plates_sort_what_the_chute_has_charged() {
    let case = Case::new("tribo-separator");
    if !full_size() {
        case.replace("scene.toml", "count = 800", &format!("count = {SMOKE}"));
        case.replace("scene.toml", "end_s = 0.8", "end_s = 0.6");
    }
    let run = case.run(&[]);
    let history = run.history();
    let last = |name: &str| *history.column(name).last().expect("rows");
    let book = std::fs::read_to_string(run.path("summary.json")).expect("a summary");
    let book: serde_json::Value = serde_json::from_str(&book).expect("JSON");
    let bin = |name: &str, of: &str| {
        let tally = &book["books"]["outlets"][name]["materials"][of];
        [tally["grains"].as_f64(), tally["C"].as_f64()].map(|number| number.expect("a number"))
    };
    for (name, right, wrong, sign) in [("left", "PVC", "nylon", -1.0), ("right", "nylon", "PVC", 1.0)] {
        let ([many, charge], [few, _]) = (bin(name, right), bin(name, wrong));
        assert!(many > 20.0 && many / (many + few) > PURE, "{name}: {many} of {right}, {few} of {wrong}");
        assert!(sign * charge > 0.0, "{right} has {charge:e} C");
    }
    let chute = last("wall_charge_C");
    let rest = last("net_charge_C") + last("left_C") + chute;
    assert!(rest.abs() < ROUND_OFF * last("contact_charge_C"), "{rest:e} C of {chute:e} C");
}
