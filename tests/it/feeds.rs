//! Runs with feeds: what the files say, what is refused, and what does not matter.

use amberfield_tests::{CsvTable, Workbench};
use serde_json::Value;

/// Face as an STL file: a square of 8 mm at a height of 24 mm.
const FACE: &str = "solid face\nfacet normal 0 0 1\n outer loop\n  vertex -4 -4 24\n  vertex 4 -4 24\n  \
    vertex 4 4 24\n endloop\nendfacet\nfacet normal 0 0 1\n outer loop\n  vertex -4 -4 24\n  \
    vertex 4 4 24\n  vertex -4 4 24\n endloop\nendfacet\nendsolid face\n";

/// Charged grains of two materials that fall onto a floor which takes charge; some leave through the sides.
pub(crate) const SCENE: &str = r#"
[domain]
min_m = [-0.01, -0.01, -0.002]
max_m = [0.01, 0.01, 0.03]
boundary = { x = "open", y = "open", z = "open" }
[[materials]]
name = "glass"
density_kg_m3 = 2500
young_Pa = 1e6
poisson = 0.25
restitution = 0.7
friction = 0.3
work_function_eV = 4.2
[[materials]]
name = "steel"
density_kg_m3 = 7800
young_Pa = 1e6
poisson = 0.3
restitution = 0.8
friction = 0.2
work_function_eV = 4.6
[[walls]]
plane = { point_m = [0, 0, 0], normal = [0, 0, 1] }
material = "steel"
charging = "grounded"
[particles]
on_exit = "delete"
[[feeds]]
name = "hopper"
material = "glass"
region = { box = { min_m = [-0.008, -0.008, 0.02], max_m = [0.008, 0.008, 0.028] } }
rate_kg_s = 5e-3
radius_m = { by_mass = [[2e-4, 0.3], [4e-4, 0.7]] }
charge_C = { normal = { mean = 0.0, std = 1e-13 } }
velocity_m_s = [0, 0, -1.0]
velocity_spread_m_s = 0.2
seed = 7
[[feeds]]
name = "shot"
material = "steel"
region = { cylinder = { base_m = [0, 0, 0.014], top_m = [0, 0, 0.019], radius_m = 0.006 } }
rate_per_s = 400.0
radius_m = 3e-4
velocity_m_s = [0.3, 0, -0.5]
[time]
step_s = 1e-5
end_s = 0.03
gravity_m_s2 = [0, 0, -9.81]
[electric_field]
method = "direct"
enable_collision_charge_transfer = true
[output]
formats = ["csv"]
history_every_s = 1e-3
"#;

/// History without clocks, and the grains at the end.
fn outcome(bench: &Workbench, out: &str) -> (CsvTable, String) {
    let names = bench.names(&format!("{out}/particles"));
    let last = names.last().expect("the grains at the end");
    let history = CsvTable::parse(&bench.read(&format!("{out}/history.csv"))).without_clocks();
    (history, bench.read(&format!("{out}/particles/{last}")))
}

fn run(scene: &str, arguments: &[&str]) -> (Workbench, (CsvTable, String)) {
    let bench = Workbench::new(scene);
    let answer = bench.run(&[&["run", "scene.toml", "--out", "out"], arguments].concat());
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let found = outcome(&bench, "out");
    (bench, found)
}

#[test]
fn books_are_written_and_close() {
    let (bench, (history, _)) = run(SCENE, &[]);
    let last = |name: &str| *history.numbers(name).last().unwrap();
    assert_eq!(last("grains"), last("fed_grains") - last("left_grains"));
    let fed = last("fed_kg_glass");
    assert!((1.5e-4 * 0.99..1.5e-4 + 7e-7).contains(&fed), "{fed:e}");
    assert!((last("grains_kg") - last("fed_kg") + last("left_kg")).abs() < 1e-12 * last("fed_kg"));
    assert_eq!(last("owed_grains"), 0.0);
    for of in ["glass", "steel"] {
        let charge = |what: &str| last(&format!("{what}_C_{of}"));
        let off = charge("grains") - charge("fed") + charge("left") - charge("gained");
        let sizes = ["grains", "fed", "left", "gained"].map(|what| charge(what).abs()).iter().sum::<f64>();
        assert!(off.abs() < 1e-12 * sizes, "{of}: {off:e} of {sizes:e}");
    }
    let walls = last("wall_charge_C");
    assert!(walls != 0.0, "nothing was charged");
    let off = last("net_charge_C") + walls + last("left_C") - last("fed_C");
    assert!(off.abs() < 1e-12 * (walls.abs() + last("fed_C").abs()), "{off:e} of {walls:e}");
    let summary: Value = serde_json::from_str(&bench.read("out/summary.json")).unwrap();
    let books = &summary["books"];
    assert_eq!(books["feeds"]["hopper"]["fed"]["kg"].as_f64(), Some(fed));
    assert_eq!(books["materials"]["glass"]["fed"]["kg"].as_f64(), Some(fed));
    assert_eq!(books["all"]["inside"]["grains"].as_f64(), Some(last("grains")));
}

#[test]
fn threads_checkpoints_and_the_order_of_feeds_change_nothing() {
    let (bench, found) = run(SCENE, &[]);
    assert_eq!(run(SCENE, &["--threads", "1"]).1, found);
    let (head, rest) = SCENE.split_once("[[feeds]]").unwrap();
    let (one, rest) = rest.split_once("[[feeds]]").unwrap();
    let (other, tail) = rest.split_once("[time]").unwrap();
    let turned = format!("{head}[[feeds]]{other}[[feeds]]{one}[time]{tail}");
    assert_eq!(run(&turned, &[]).1, found);
    // A run that was to end earlier goes on, with the grains that it did not know.
    let arguments = ["run", "scene.toml", "--out", "half", "--set", "time.end_s=0.01237"];
    assert_eq!(bench.run(&arguments).code, Some(0));
    let checkpoint = format!("half/checkpoints/{}", bench.names("half/checkpoints").last().unwrap());
    let answer = bench.run(&["run", "scene.toml", "--out", "half", "--resume", &checkpoint]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    assert_eq!(outcome(&bench, "half").1, found.1);
    let converted = bench.run(&["convert", &checkpoint, "grains.csv"]);
    assert_eq!(converted.code, Some(0), "{}", converted.stderr);
}

#[test]
fn what_cannot_come_is_said_in_words() {
    let full = SCENE
        .replace("velocity_m_s = [0, 0, -1.0]\nvelocity_spread_m_s = 0.2", "velocity_m_s = [0, 0, 0]")
        .replace("gravity_m_s2 = [0, 0, -9.81]", "gravity_m_s2 = [0, 0, 0]")
        .replace("rate_kg_s = 5e-3", "rate_kg_s = 0.5");
    let (bench, (history, _)) = run(&full, &["--set", "time.end_s=0.01"]);
    assert!(history.numbers("owed_kg").last().unwrap() > &0.0);
    let log = bench.read("out/log.jsonl");
    assert!(log.contains("finds no place for grain") && log.contains("were due and found no place"), "{log}");
    let bench = Workbench::new(&full.replace("seed = 7", "seed = 7\non_blocked = \"stop\""));
    let answer = bench.run(&["run", "scene.toml", "--set", "time.end_s=0.01"]);
    assert!(answer.code == Some(4) && answer.stderr.contains("on_blocked"), "{}", answer.stderr);
    let bench = Workbench::new(&SCENE.replace("radius_m = 3e-4", "radius_m = 3e-3"));
    let answer = bench.run(&["run", "scene.toml"]);
    assert!(answer.code == Some(2) && answer.stderr.contains("feed \"shot\""), "{}", answer.stderr);
    let explained = Workbench::new(SCENE).run(&["explain", "scene.toml"]);
    assert!(explained.stdout.contains("feed \"hopper\""), "{}", explained.stdout);
}

#[test]
fn charges_that_come_at_a_high_potential_are_no_unsound_run() {
    let bench = Workbench::new(
        "domain = { min_m = [0, 0, 0], max_m = [0.1, 0.02, 0.1], \
         boundary = { x_min = { potential_V = 5000 }, \
         x_max = { potential_V = -5000 }, y = 'open', z = 'open' } }\n\
         [[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500\nyoung_Pa = 1e6\npoisson = 0.25\n\
         restitution = 0.7\nfriction = 0.3\n[particles]\non_exit = 'delete'\n\
         [[feeds]]\nname = 'f'\nmaterial = 'glass'\nrate_per_s = 2000\nradius_m = 2.5e-4\ncharge_C = 2e-12\n\
         region = { box = { min_m = [0.01, 0.005, 0.09], max_m = [0.02, 0.015, 0.1] } }\n\
         [[outlets]]\nname = 'left'\nregion = { box = { min_m = [0, 0, 0], max_m = [0.05, 0.02, 0.001] } }\n\
         [[outlets]]\nname = 'right'\n\
         region = { box = { min_m = [0.05, 0, 0], max_m = [0.1, 0.02, 0.001] } }\n\
         [time]\nstep_s = 5e-6\nend_s = 0.01\ngravity_m_s2 = [0, 0, -9.81]\n\
         [electric_field]\ntolerance = 1e-3\n[output]\nhistory_every_s = 6e-4\n",
    );
    let answer = bench.run(&["run", "scene.toml"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    assert!(!answer.stderr.contains("no wall holds"), "{}", answer.stderr);
    let no_charge = bench.read("scene.toml").replace("charge_C = 2e-12\n", "").replace("on_exit", "#on_exit");
    bench.write("neutral.toml", no_charge.replace("[particles]\n", ""));
    let answer = bench.run(&["run", "neutral.toml"]);
    assert!(answer.code == Some(2) && answer.stderr.contains("feeds: charge_C"), "{}", answer.stderr);
}

/// Checks that [`SCENE`] with a change is refused, with the place of a key of its second feed.
fn refused(from: &str, to: &str, key: &str, words: &str) {
    let scene = SCENE.replacen(from, to, 1);
    assert_ne!(scene, SCENE, "{from}");
    // Feeds are sorted by name; their places are those of the file.
    for scene in [scene.replace("\"hopper\"", "\"zoo\""), scene] {
        let bench = Workbench::new(&scene);
        bench.write("face.stl", FACE);
        let feed = scene.find("\"shot\"").unwrap();
        let at = feed + scene[feed..].find(&format!("\n{key} = ")).unwrap();
        let line = scene[..=at].matches('\n').count() + 1;
        for command in ["run", "explain"] {
            let answer = bench.run(&[command, "scene.toml"]);
            assert_eq!(answer.code, Some(2), "{to}: {}", answer.stderr);
            for word in [&format!("scene.toml:{line}: feeds[1].{key} = "), "feed \"shot\"", words] {
                assert!(answer.stderr.contains(word), "no {word:?} in {}", answer.stderr);
            }
        }
    }
}

#[test]
fn what_is_wrong_with_a_region_is_said_with_its_place() {
    let region = "{ cylinder = { base_m = [0, 0, 0.014], top_m = [0, 0, 0.019], radius_m = 0.006 } }";
    let face = "{ stl = \"face.stl\", scale = 1e-3 }";
    let velocity = "velocity_m_s = [0.3, 0, -0.5]";
    refused("0.019], radius_m = 0.006", "0.019], radius_m = 0.06", "region", "beyond the domain");
    refused("radius_m = 3e-4", "radius_m = 3e-3", "region", "does not fit into its region");
    refused(region, "{ stl = \"face.stl\" }", "region", "beyond the domain");
    let along = |to: &str, words: &str| {
        let (from, to) = (format!("region = {region}"), format!("region = {face}\n{to}"));
        let scene = SCENE.replace(velocity, "");
        assert!(scene.contains(&from));
        let bench = Workbench::new(&scene.replace(&from, &to));
        bench.write("face.stl", FACE);
        let answer = bench.run(&["explain", "scene.toml"]);
        assert!(answer.code == Some(2) && answer.stderr.contains(words), "{}", answer.stderr);
        assert!(answer.stderr.contains("feeds[1].velocity_m_s"), "{}", answer.stderr);
        assert!(answer.stderr.contains("scene.toml:"), "{}", answer.stderr);
    };
    along("velocity_m_s = [1, 0, 0]", "along its face, 0.0° off it");
    along("velocity_m_s = [1, 1, -0.05]", "along its face, 2.0° off it");
    along("velocity_m_s = [0, 0, 0]", "velocity_m_s is zero");
    along("", "velocity_m_s is zero");
}

#[test]
fn explain_tells_the_restitution_of_what_feeds_alone_bring() {
    let bench = Workbench::new(SCENE);
    let whole = bench.run(&["explain", "scene.toml"]);
    assert_eq!(whole.code, Some(0), "{}", whole.stderr);
    let (head, tail) = SCENE.split_once("[electric_field]").unwrap();
    let (_, output) = tail.split_once("[output]").unwrap();
    bench.write("scene.toml", format!("{head}[output]{output}").replace("charge_C", "#charge_C"));
    let plain = bench.run(&["explain", "scene.toml"]);
    for said in [whole.stdout, plain.stdout] {
        let line =
            said.lines().find(|line| line.starts_with("restitution: ")).unwrap_or_else(|| panic!("{said}"));
        assert!(line.contains("glass 0.7 acts as") && line.contains("steel 0.8 acts as"), "{line}");
        // Two of the fastest, with 1 m/s and three standard deviations along each axis.
        let speed: f64 = line.split(" m/s").next().unwrap().rsplit(' ').next().unwrap().parse().unwrap();
        assert!((2.0..2.0 * (1.0 + 0.6 * 3_f64.sqrt())).contains(&speed), "{line}");
    }
}
