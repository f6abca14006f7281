//! Command `convert`.

use amberfield_tests::{CsvTable, Workbench};

/// Short run of three charged grains that write all files.
const SCENE: &str = "
[domain]
min_m = [0.0, 0.0, 0.0]
max_m = [0.01, 0.01, 0.01]
boundary = { x = 'periodic', y = 'periodic', z = 'grounded' }
[[materials]]
name = 'glass'
density_kg_m3 = 2500.0
young_Pa = 1e7
poisson = 0.2
restitution = 0.9
friction = 0.3
[[materials]]
name = 'steel'
density_kg_m3 = 7800.0
young_Pa = 1e7
poisson = 0.2
restitution = 0.9
friction = 0.3
[particles]
file = 'g.csv'
[time]
step_s = 1e-6
end_s = 1e-5
[electric_field]
tuning = 'model'
[output]
every_s = 5e-6
checkpoint_every_s = 5e-6
formats = ['vtk', 'csv']
";

const GRAINS: &str = "id;x_mm;y_mm;z_mm;radius_um;charge_pC;vx_m_s;material;group\n\
    4;1,5;2;3;100;-0,5;0,25;glass;fine\n2;5,5;5;5;150;0,5;0;steel;\n9;8;2;7;100;0,25;-1;glass;fine\n";

#[test]
fn frames_and_checkpoints_of_a_run_have_the_same_grains() {
    let bench = Workbench::new(SCENE);
    bench.write("g.csv", GRAINS);
    let answer = bench.run(&["run", "scene.toml", "--out", "run", "--no-progress"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let convert = |words: &[&str]| {
        let answer = bench.run(&[&["convert"], words].concat());
        assert_eq!(answer.code, Some(0), "{words:?}: {}", answer.stderr);
    };
    let checkpoint = bench.names("run/checkpoints").pop().unwrap();
    convert(&["run", "frame.csv"]);
    convert(&[&format!("run/checkpoints/{checkpoint}"), "checkpoint.csv"]);
    assert_eq!(bench.read("frame.csv"), bench.read("checkpoint.csv"));
    assert_eq!(bench.read("frame.csv"), bench.read("run/particles/grains_000000000010.csv"));
    convert(&["run", "early.csv", "--step", "5"]);
    assert_eq!(bench.read("early.csv"), bench.read("run/particles/grains_000000000005.csv"));
    // A round through other programs' forms and units.
    convert(&["run", "a.dump"]);
    convert(&["a.dump", "b.vtu", "--materials-by-type", "glass,steel"]);
    convert(&["b.vtu", "c.lammpstrj", "--units", "micro"]);
    convert(&["c.lammpstrj", "d.csv", "--materials-by-type", "glass,steel"]);
    let (first, last) = (CsvTable::parse(&bench.read("frame.csv")), CsvTable::parse(&bench.read("d.csv")));
    for column in ["id", "x_m", "z_m", "radius_m", "charge_C", "vx_m_s", "density_kg_m3"] {
        for (found, expected) in last.numbers(column).iter().zip(first.numbers(column)) {
            assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{column}: {found} {expected}");
        }
    }
    let materials = |table: &CsvTable| {
        let index = table.columns.iter().position(|name| name == "material").unwrap();
        table.rows.iter().map(|row| row[index].clone()).collect::<Vec<_>>()
    };
    assert_eq!(materials(&last), materials(&first));
    for name in bench.names("run/particles").iter().filter(|name| name.ends_with(".csv")) {
        std::fs::remove_file(bench.path("run/particles").join(name)).unwrap();
    }
    convert(&["run", "vtu.csv"]);
    assert_eq!(materials(&CsvTable::parse(&bench.read("vtu.csv"))), materials(&first));
    convert(&["frame.csv", "a.data", "--units", "cgs"]);
    assert!(bench.read("a.data").contains("3 atoms\n2 atom types"));
}

#[test]
fn bad_conversions_are_refused() {
    let bench = Workbench::new(SCENE);
    bench.write("g.csv", GRAINS);
    for (words, said) in [
        (&["g.csv", "g.csv"][..], "would overwrite itself"),
        (&["g.csv", "a.txt"], "its ending says no form"),
        (&["g.csv", "a.csv", "--units", "micro"], "in SI units, not micro"),
        (&["g.csv", "a.dump", "--units", "lj"], "lj has no units"),
        (&["g.csv", "a.dump", "--from-units", "si"], "units is for dumps"),
        (&["g.csv", "a.data"], "needs radii and densities"),
        (&[".", "a.csv"], "no frames particles/grains_*.csv or .vtu"),
        (&["absent", "a.csv"], "check the path"),
        (&["a.amber", "a.csv", "--step", "3"], "a checkpoint has one step"),
    ] {
        let answer = bench.run(&[&["convert"], words].concat());
        assert_eq!(answer.code, Some(2), "{words:?}: {}", answer.stderr);
        assert!(answer.stderr.contains(said), "{said}: {}", answer.stderr);
    }
}
