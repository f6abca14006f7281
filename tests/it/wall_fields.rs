//! Walls of triangles that bound the field, by the command.

use amberfield_tests::{CsvTable, Workbench};
use std::fmt::Write as _;

/// Radius of the grains [m].
const RADIUS: f64 = 1e-4;
/// Coulomb's constant 1/(4πε₀) [V·m/C], CODATA 2018.
const COULOMB: f64 = 8.987_551_792_261_171e9;
/// Error of E before a plate of facets of 2.5 radii, whose edge is 20 radii away.
const OF_PLATE: f64 = 0.05;
/// Share of the field of a conductor's surface that is left within it, where facets are a quarter of an edge.
const WITHIN: f64 = 1e-2;

/// Square of so many cells a side, half an edge `half` [m] wide, in STL: the place of its corner (u, v), each
/// in [−half, half], is told.
fn facets(half: f64, cells: u32, place: impl Fn(f64, f64) -> [f64; 3]) -> String {
    let at = |step: u32| half * (2.0 * f64::from(step) / f64::from(cells) - 1.0);
    let mut text = String::new();
    for (i, j) in (0..cells).flat_map(|i| (0..cells).map(move |j| (i, j))) {
        for corners in [[(i, j), (i + 1, j), (i + 1, j + 1)], [(i, j), (i + 1, j + 1), (i, j + 1)]] {
            text += "facet normal 0 0 1\nouter loop\n";
            for [x, y, z] in corners.map(|(u, v)| place(at(u), at(v))) {
                writeln!(text, "vertex {x:e} {y:e} {z:e}").unwrap();
            }
            text += "endloop\nendfacet\n";
        }
    }
    text
}

/// Plate of 40 × 40 radii in z = 0.
fn plate() -> String {
    format!("solid plate\n{}endsolid\n", facets(20.0 * RADIUS, 16, |x, y| [x, y, 0.0]))
}

/// Surface of a cube with an edge of 20 radii about the origin.
fn cube() -> String {
    let half = 10.0 * RADIUS;
    let side = |axis: usize, at: f64| {
        facets(half, 8, |u, v| {
            let mut place = [at; 3];
            (place[(axis + 1) % 3], place[(axis + 2) % 3]) = (u, v);
            place
        })
    };
    let sides: String = (0..3).flat_map(|axis| [side(axis, -half), side(axis, half)]).collect();
    format!("solid cube\n{sides}endsolid\n")
}

/// Box whose lower face, at a height [m], has this condition.
fn domain(z_m: f64, z_min: &str) -> String {
    format!(
        "domain = {{ min_m = [-5e-3, -5e-3, {z_m:e}], max_m = [5e-3, 5e-3, 5e-3], boundary = {{ x = 'open', \
         y = 'open', z_min = '{z_min}', z_max = 'open' }} }}\n"
    )
}

const FIELD: &str = "particles.file = 'grains.csv'\n[electric_field]\ntolerance = 1e-2\ntuning = 'model'\n";

/// Rows of `amberfield field`.
fn field(bench: &Workbench, options: &[&str]) -> CsvTable {
    let answer = bench.run(&[&["field", "scene.toml", "--out", "e.csv"], options].concat());
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    CsvTable::parse(&bench.read("e.csv"))
}

#[test]
fn a_grounded_plate_of_facets_pulls_a_charge_as_a_grounded_face_does() {
    let wall = "walls = [{ stl = 'plate.stl', field = 'grounded' }]\n";
    let before_facets = Workbench::new(&format!("{}{wall}{FIELD}", domain(-1e-3, "open")));
    before_facets.write("plate.stl", plate());
    let before_face = Workbench::new(&format!("{}{FIELD}", domain(0.0, "grounded")));
    for radii in [1.02, 2.0, 5.0] {
        let height = radii * RADIUS;
        let grain = format!("id,x_m,y_m,z_m,radius_m,charge_C\n1,3e-5,1e-5,{height:e},{RADIUS:e},1e-13\n");
        let [facets, face] = [&before_facets, &before_face].map(|bench| {
            bench.write("grains.csv", &grain);
            let table = field(bench, &[]);
            ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m", "potential_V"].map(|name| table.numbers(name)[0])
        });
        // q²/(16πε d²) is q times this.
        let image = -COULOMB * 1e-13 / (4.0 * height * height);
        assert!((face[2] / image - 1.0).abs() < 1e-2, "{radii} radii before the face: {face:?}");
        for (found, expected) in facets.iter().zip([0.0, 0.0, image]) {
            assert!((found - expected).abs() < OF_PLATE * image.abs(), "{radii} radii: {facets:?}, {face:?}");
        }
        assert!((facets[3] / face[3] - 1.0).abs() < OF_PLATE, "{radii} radii: {facets:?}, {face:?}");
    }
}

#[test]
fn there_is_no_field_in_a_conductor_at_a_potential_or_with_a_charge() {
    let wall = "walls = [{ stl = 'cube.stl', field = { potential_V = 100.0 } }]\n";
    let bench = Workbench::new(&format!("{}{wall}{FIELD}", domain(-5e-3, "open")));
    bench.write("cube.stl", cube());
    bench.write(
        "grains.csv",
        "id,x_m,y_m,z_m,radius_m,charge_C\n1,0,0,0,1e-4,0\n2,5e-4,2e-4,0,1e-4,0\n3,0,0,4.9e-3,1e-4,0\n",
    );
    let found = |options: &[&str]| {
        let table = field(&bench, options);
        let e = ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].map(|name| table.numbers(name));
        let size = |row: usize| e.iter().map(|e| e[row] * e[row]).sum::<f64>().sqrt();
        (table.numbers("potential_V"), [0, 1, 2].map(size))
    };
    // A cube of edge a has the capacity 0.660 678 · 4πεa: Hwang and Mascagni, J. Appl. Phys. 95, 3798 (2004).
    let capacity = 0.660_678 * 2e-3 / COULOMB;
    let (volts, e) = found(&[]);
    for inside in 0..2 {
        assert!((volts[inside] / 100.0 - 1.0).abs() < WITHIN, "{volts:?}");
        assert!(e[inside] < WITHIN * 100.0 / 1e-3, "{e:?}");
    }
    // Its lowest moment beyond the charge falls as r⁻⁶.
    let outside = COULOMB * capacity * 100.0 / 4.9e-3_f64.powi(2);
    assert!((e[2] / outside - 1.0).abs() < 2e-2, "{e:?} {outside}");

    let (volts, e) = found(&["--set", "walls.0.field={ floating = { charge_C = 1e-12 } }"]);
    let expected = 1e-12 / capacity;
    for inside in 0..2 {
        assert!((volts[inside] / expected - 1.0).abs() < 2e-2, "{volts:?} {expected}");
        assert!(e[inside] < WITHIN * expected / 1e-3, "{e:?}");
    }
    let outside = COULOMB * 1e-12 / 4.9e-3_f64.powi(2);
    assert!((e[2] / outside - 1.0).abs() < 2e-2, "{e:?} {outside}");
}

/// Charged grain that falls onto a wall under another one that stays.
const FALL: &str = "[[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 1e6\npoisson = 0.22\n\
    restitution = 0.8\nfriction = 0.0\nwork_function_eV = 4.5\n\
    [particles]\nfile = 'grains.csv'\nfixed_groups = ['still']\n\
    [time]\nstep_s = 2e-6\nend_s = 1.2e-3\ngravity_m_s2 = [0, 0, 0]\n\
    [electric_field]\ntolerance = 1e-3\ntuning = 'model'\nenable_collision_charge_transfer = true\n\
    [output]\nevery_s = 4e-4\nformats = ['csv']\ncheckpoint_every_s = 4e-4\n";
const FALLING: &str = "id,x_m,y_m,z_m,radius_m,charge_C,vz_m_s,material,group\n\
    1,1e-5,2e-5,1.5e-4,1e-4,1e-13,-0.1,glass,all\n2,1e-5,2e-5,4.5e-4,1e-4,4e-13,0,glass,still\n";

fn falling_onto_facets() -> Workbench {
    let wall = "walls = [{ stl = 'plate.stl', field = 'grounded' }]\n";
    let bench = Workbench::new(&format!("{}{wall}{FALL}", domain(-1e-3, "open")));
    bench.write("plate.stl", plate());
    bench.write("grains.csv", FALLING);
    bench
}

#[test]
fn a_contact_takes_the_charge_that_it_takes_on_a_grounded_face() {
    let wall = "walls = [{ plane = { point_m = [0, 0, 0], normal = [0, 0, 1] }, charging = 'grounded' }]\n";
    let onto_face = Workbench::new(&format!("{}{wall}{FALL}", domain(0.0, "grounded")));
    onto_face.write("grains.csv", FALLING);
    let [facets, face] = [falling_onto_facets(), onto_face].map(|bench| {
        let answer = bench.run(&["run", "scene.toml", "--out", "out"]);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        let history = CsvTable::parse(&bench.read("out/history.csv"));
        ["wall_charge_C", "kinetic_J", "collisions"].map(|name| *history.numbers(name).last().unwrap())
    });
    assert_eq!([facets[2], face[2]], [1.0; 2], "both bounce off the wall once");
    // Images that counted twice would move twice as much.
    for (found, expected) in facets.iter().zip(face) {
        assert!((found / expected - 1.0).abs() < OF_PLATE, "{facets:?} {face:?}");
    }
}

#[test]
fn a_run_goes_on_within_its_tolerance_and_not_with_another_field_of_its_wall() {
    let bench = falling_onto_facets();
    let run = |options: &[&str]| bench.run(&[&["run", "scene.toml"], options].concat());
    for options in [&["--out", "whole", "--steps", "240"][..], &["--out", "part", "--steps", "200"]] {
        let answer = run(options);
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    }
    let on = ["--out", "part", "--resume", "part/checkpoints/step_000000000200.amber", "--steps", "40"];
    let answer = run(&[&on[..], &["--set", "walls.0.field=none"]].concat());
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("walls[0].field is \"none\" and was \"grounded\""), "{}", answer.stderr);
    let answer = run(&on);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let last = |folder: &str| {
        let history = CsvTable::parse(&bench.read(&format!("{folder}/history.csv")));
        ["step", "kinetic_J", "electric_J"].map(|name| *history.numbers(name).last().unwrap())
    };
    assert_eq!(last("part"), last("whole"));
}

#[test]
fn explain_and_log_name_surfaces_and_facets_that_do_not_fit() {
    let bench = falling_onto_facets();
    let explained = bench.run(&["explain", "scene.toml"]);
    assert_eq!(explained.code, Some(0), "{}", explained.stderr);
    for part in [
        "bounds the field by 512 facets of 2.69 to 2.69 radii of the smallest grain, 2.69 in the median",
        "surfaces ",
        "plate.stl at 0 V, 512 facets; their matrix has 1.0 MB",
    ] {
        assert!(explained.stdout.contains(part), "{part}: {}", explained.stdout);
    }
    assert!(!explained.stdout.contains("warning"), "{}", explained.stdout);
    let none = bench.run(&["explain", "scene.toml", "--set", "walls.0.field=none"]).stdout;
    for part in ["does not know this grounded surface", "no wall has a field"] {
        assert!(none.contains(part), "{part}: {none}");
    }
    // Facets of 6.7 radii are divided, those of 27 as far as 3000 in all allow.
    bench.write("grains.csv", FALLING.replace(",1e-4,4e-13", ",4e-5,4e-13"));
    let cut = bench.run(&["explain", "scene.toml"]).stdout;
    assert!(cut.contains("facets (divided from 512)") && !cut.contains("warning"), "{cut}");
    bench.write("grains.csv", FALLING.replace(",1e-4,4e-13", ",1e-5,4e-13"));
    let coarse = bench.run(&["explain", "scene.toml"]).stdout;
    assert!(coarse.contains("(divided from 512)") && coarse.contains("divided to 3000 in all"), "{coarse}");
    let answer = bench.run(&["run", "scene.toml", "--out", "out", "--steps", "1"]);
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    let log = bench.read("out/log.jsonl");
    assert!(log.contains("mesh it finer") && log.contains("facets (divided from 512)"), "{log}");
}

#[test]
fn a_field_that_the_wall_cannot_have_ends_before_anything_runs() {
    let bench = falling_onto_facets();
    for (set, parts) in [
        ("electric_field={ method = \"cutoff\", field_cutoff_radius = 1e-3 }", &["method cutoff", "p3m"][..]),
        ("walls.0.motion=[{ velocity_m_s = [0, 0, 0.1] }]", &["walls at rest"]),
        ("domain.max_m=[1e-3, 5e-3, 5e-3]", &[]),
    ] {
        let answer = bench.run(&["run", "scene.toml", "--out", "out", "--set", set]);
        // Open faces may cut a surface.
        let code = if parts.is_empty() { Some(0) } else { Some(2) };
        assert_eq!(answer.code, code, "{set}: {}", answer.stderr);
        for part in [&["walls[0].field"], parts].concat().iter().filter(|_| code == Some(2)) {
            assert!(answer.stderr.contains(*part), "{set}: {part}: {}", answer.stderr);
        }
        assert_eq!(bench.path("out").exists(), code == Some(0), "{set}");
    }
}
