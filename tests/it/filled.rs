//! Runs that begin with the grains of another run, and grains that never move, by the commands.

use amberfield_tests::{Answer, CsvTable, Workbench};

/// Grains that fall onto a floor, in a box that is periodic sideways.
const FILL: &str = r#"
[domain]
min_m = [0, 0, 0]
max_m = [0.01, 0.01, 0.03]
boundary = { x = "periodic", y = "periodic", z = "open" }
[[materials]]
name = "glass"
density_kg_m3 = 2500
young_Pa = 1e6
poisson = 0.25
restitution = 0.6
friction = 0.4
rolling_friction = 0.05
[[walls]]
plane = { point_m = [0, 0, 0], normal = [0, 0, 1] }
material = "glass"
[particles.generate]
material = "glass"
group = "bed"
count = 120
radius_m = { uniform = { min = 6e-4, max = 9e-4 } }
charge_C = { bipolar = 1e-13 }
velocity_m_s = [0.1, 0, -0.3]
region = { box = { min_m = [0, 0, 0.001], max_m = [0.01, 0.01, 0.015] } }
[time]
step_s = 1e-5
end_s = 0.02
gravity_m_s2 = [0, 0, -9.81]
[output]
formats = ["csv"]
"#;

/// Difference that sums in another order make, over the smallest radius.
const ROUND_OFF: f64 = 1e-8;

fn good(bench: &Workbench, arguments: &[&str]) -> Answer {
    let answer = bench.run(arguments);
    assert_eq!(answer.code, Some(0), "{arguments:?}: {}", answer.stderr);
    answer
}

/// Grains at the end of a run.
fn grains(bench: &Workbench, out: &str) -> CsvTable {
    let names = bench.names(&format!("{out}/particles"));
    CsvTable::parse(&bench.read(&format!("{out}/particles/{}", names.last().expect("the grains at the end"))))
}

/// Scene that begins with the grains of `runs/fill`.
fn filled() -> String {
    let (head, rest) = FILL.split_once("[particles.generate]").expect("a generator");
    let (_, tail) = rest.split_once("[time]").expect("a section of time");
    format!("{head}[particles]\nfrom = \"runs/fill\"\n[time]{tail}")
}

/// Workbench with a run of `runs/fill` to the middle of its time.
fn half() -> Workbench {
    let bench = Workbench::new(FILL);
    bench.write("next.toml", filled());
    good(&bench, &["run", "scene.toml", "--out", "runs/fill", "--steps", "1500"]);
    bench
}

#[test]
fn two_runs_equal_one_to_round_off() {
    let bench = half();
    good(&bench, &["run", "scene.toml", "--out", "whole", "--steps", "1800"]);
    good(&bench, &["run", "next.toml", "--out", "next", "--steps", "300"]);
    let [whole, next] = ["whole", "next"].map(|out| grains(&bench, out));
    for column in ["x_m", "y_m", "z_m"] {
        for (a, b) in whole.numbers(column).iter().zip(next.numbers(column)) {
            let apart = (a - b).abs();
            let apart = apart.min((0.01 - apart).abs());
            assert!(apart < ROUND_OFF * 6e-4, "{column}: {a} {b}");
        }
    }
    assert_eq!(whole.numbers("id"), next.numbers("id"));
}

#[test]
fn filled_bed_is_charged_fixed_explained_resumed_and_converted() {
    let bench = half();
    let field = "[electric_field]\nmethod = \"direct\"\n";
    bench.write("next.toml", filled().replace("from =", "fixed_groups = [\"bed\"]\nfrom =") + field);
    let explained = good(&bench, &["explain", "next.toml"]);
    assert!(explained.stdout.contains("step_000000001500.amber"), "{}", explained.stdout);
    assert!(explained.stdout.contains("120 grain(s) of particles.fixed_groups never move"));
    let set = ["--set", "particles.from=runs/fill/checkpoints/step_000000001500.amber"];
    good(&bench, &[&["run", "next.toml", "--out", "next", "--steps", "20"][..], &set].concat());
    let [before, after] = ["runs/fill", "next"].map(|out| grains(&bench, out));
    for column in ["x_m", "y_m", "z_m", "charge_C"] {
        assert_eq!(before.numbers(column), after.numbers(column), "{column}");
    }
    assert!(after.numbers("vz_m_s").iter().all(|speed| *speed == 0.0));
    // What begins with grains of another run goes on as any run does.
    let free = filled() + field;
    bench.write("free.toml", free);
    good(&bench, &["run", "free.toml", "--out", "whole", "--steps", "60"]);
    good(&bench, &["run", "free.toml", "--out", "cut", "--steps", "30"]);
    let resume = "cut/checkpoints/step_000000000030.amber";
    good(&bench, &["run", "free.toml", "--out", "cut", "--steps", "30", "--resume", resume]);
    let last = |out: &str| {
        let names = bench.names(&format!("{out}/particles"));
        bench.read(&format!("{out}/particles/{}", names.last().expect("grains")))
    };
    assert!(last("whole") == last("cut"));
    good(&bench, &["convert", "whole/checkpoints/step_000000000060.amber", "grains.csv"]);
    good(&bench, &["field", "free.toml", "--out", "field.csv"]);
}

#[test]
fn what_cannot_be_begun_is_refused() {
    let bench = half();
    for (arguments, words) in [
        (
            &["--set", "particles.fixed_groups=[\"beds\"]"][..],
            &["fixed_groups", "the nearest group is \"bed\""][..],
        ),
        (
            &["--set", "materials[0].name=sand", "--set", "walls[0].material=sand"],
            &["is of \"glass\"", "[[materials]]"],
        ),
        (&["--set", "domain.max_m=[0.01, 0.01, 0.001]"], &["outside the domain", "enlarge the domain"]),
        (&["--set", "particles.from=scene.toml"], &["not a checkpoint of amberfield"]),
        (&["--set", "particles.file=grains.csv"], &["exactly one of file, generate, from"]),
        (
            &["--set", "walls[0].plane={ point_m = [0, 0, 0.0003], normal = [0, 0, 1] }"],
            &["overlap(s) at the start", "wall"],
        ),
    ] {
        let answer = bench.run(&[&["run", "next.toml", "--out", "next"], arguments].concat());
        assert_eq!(answer.code, Some(2), "{arguments:?}: {}", answer.stderr);
        for word in words {
            assert!(answer.stderr.contains(word), "{arguments:?}: no {word:?} in {}", answer.stderr);
        }
    }
    let answer = bench.run(&["run", "next.toml", "--out", "runs/fill", "--overwrite"]);
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("--overwrite would remove the checkpoint"), "{}", answer.stderr);
}
