//! Runs with outlets: what the files and the log say, and what is refused.

use crate::feeds::SCENE;
use amberfield_tests::{CsvTable, Workbench};
use serde_json::Value;

/// Outlets below where the grains of the scene come: one lists each of its grains.
const OUTLETS: &str = "\n[[outlets]]\nname = \"high, \\\"z\\\"\"\neach = true\n\
    region = { box = { min_m = [-0.01, -0.01, 0.002], max_m = [0.0, 0.01, 0.004] } }\n\
    [[outlets]]\nname = \"low\"\n\
    region = { cylinder = { base_m = [0.005, 0, 0.001], top_m = [0.005, 0, 0.005], radius_m = 0.005 } }\n";

#[test]
fn what_leaves_is_booked_to_its_outlet() {
    let bench = Workbench::new(&(SCENE.to_owned() + OUTLETS));
    let answer = bench.run(&["run", "scene.toml", "--out", "out"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let history = CsvTable::parse(&bench.read("out/history.csv"));
    let last = |name: &str| *history.numbers(name).last().unwrap();
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    let outlets = &summary["books"]["outlets"];
    let high = &outlets["high, \"z\""];
    assert!(high["grains"].as_u64().unwrap() > 5 && outlets["low"]["grains"].as_u64().unwrap() > 5);
    assert_eq!(high["kg"].as_f64(), Some(last("outlet_kg_high_ _z_")));
    let of_materials: f64 =
        ["glass", "steel"].iter().map(|of| high["materials"][of]["C"].as_f64().unwrap()).sum();
    assert!((of_materials - high["C"].as_f64().unwrap()).abs() < 1e-12 * of_materials.abs());

    // A row for each grain of the one outlet; together they are what is booked.
    let text = bench.read("out/outlets_grains.csv");
    let rows: Vec<csv::StringRecord> =
        csv::Reader::from_reader(text.as_bytes()).records().map(|row| row.unwrap()).collect();
    assert_eq!(rows.len() as u64, high["grains"].as_u64().unwrap());
    assert!(rows.iter().all(|row| &row[2] == "high, \"z\""));
    let sum = |column: usize| rows.iter().map(|row| row[column].parse::<f64>().unwrap()).sum::<f64>();
    let mass = high["kg"].as_f64().unwrap();
    assert!((sum(12) - mass).abs() < 1e-12 * mass);
    assert!((sum(13) - high["C"].as_f64().unwrap()).abs() < 1e-12 * sum(13).abs().max(1e-13));

    // Lines of the log are of outlets and rows of the history, not of grains.
    let log = bench.read("out/log.jsonl");
    let told = log.lines().filter(|line| line.contains("left through outlet")).count();
    assert!(told > 1 && told <= 2 * history.numbers("step").len(), "{told}");

    // What left through faces is in the file of faces, and both are in what left.
    let by_face = bench.read("out/exits.csv").lines().count() as f64 - 1.0;
    let by_outlets = last("outlet_grains_high_ _z_") + last("outlet_grains_low");
    assert_eq!(by_face + by_outlets, last("left_grains"));
}

#[test]
fn bad_outlets_are_refused_with_advice() {
    let good = "[[outlets]]\nname = \"a\"\nface = \"z_min\"\n";
    for (section, words) in [
        ("[[outlets]]\nface = \"z_min\"\n", &["outlets[0].name"][..]),
        ("[[outlets]]\nname = \"a\"\n", &["outlets[0].region", "face = \"z_min\""]),
        ("[[outlets]]\nname = \"a\"\nface = \"bottom\"\n", &["outlets[0].face", "z_min"]),
        (&format!("{good}region = {{ box = {{ min_m = [0,0,0], max_m = [1,1,1] }} }}\n"), &["exactly one"]),
        (&format!("{good}{}", good.replace("z_min", "z_max")), &["another outlet has this name"]),
        (
            &format!("{good}{}", good.replace("\"a\"", "\"b\"")),
            &["scene.toml:60: outlets[1].face = \"z_min\"", "outlet \"b\"", "outlet \"a\" has the face"],
        ),
        (
            "[[outlets]]\nname = \"a\"\n\
             region = { box = { min_m = [0,0,0.01], max_m = [0.02,0.01,0.02] } }\n",
            &["scene.toml:57: outlets[0].region = {", "outlet \"a\"", "beyond the domain"],
        ),
        (
            "[[outlets]]\nname = \"a\"\n\
             region = { box = { min_m = [0,0,0.01], max_m = [0.01,0.01,0.021] } }\n",
            &["scene.toml:31: feeds[0].region = {", "feed \"hopper\"", "outlet \"a\"", "move one"],
        ),
        ("[[bins]]\nname = \"a\"\n", &["outlets"]),
    ] {
        let bench = Workbench::new(&format!("{SCENE}{section}"));
        let answer = bench.run(&["run", "scene.toml"]);
        assert_eq!(answer.code, Some(2), "{section}: {}", answer.stderr);
        for word in words {
            assert!(answer.stderr.contains(word), "{section}: {}", answer.stderr);
        }
    }
}
