//! Charge transfer at contacts while OpenFOAM computes the field.

use super::good;
use amberfield_tests::{CsvTable, FoamBox};

/// Scene in which a floor of steel takes charge from grains of glass.
///
/// The floor is given by keys of a wall.
fn floor_of(floor: &str) -> FoamBox {
    let (cyclic, wall) = (("cyclic", "type cyclic;"), ("wall", "type fixedValue; value uniform 0;"));
    let faces = "x = 'periodic'\ny = 'periodic'\nz = 'grounded'";
    let scene = FoamBox::new(&[cyclic, cyclic, cyclic, cyclic, wall, wall], faces, "bipolar = 1e-13");
    let corners = "solid floor\n\
         facet normal 0 0 1\nouter loop\nvertex -0.02 -0.02 0\nvertex 0.04 -0.02 0\nvertex 0.04 0.04 0\n\
         endloop\nendfacet\n\
         facet normal 0 0 1\nouter loop\nvertex -0.02 -0.02 0\nvertex 0.04 0.04 0\nvertex -0.02 0.04 0\n\
         endloop\nendfacet\n\
         endsolid floor\n";
    scene.bench.write("floor.stl", corners);
    let solids = format!(
        "work_function_eV = 4.5\n[[materials]]\nname = 'steel'\ndensity_kg_m3 = 7800.0\nyoung_Pa = 5e5\n\
         poisson = 0.3\nrestitution = 0.6\nfriction = 0.3\n\
         work_function_eV = 5.0\n[[walls]]\nmaterial = 'steel'\n{floor}[particles]"
    );
    let text = scene
        .bench
        .read("scene.toml")
        .replace("[particles]", &solids)
        .replace("[electric_field]", "[electric_field]\nenable_collision_charge_transfer = true")
        .replace("end_s = 1e-3", "end_s = 4e-3")
        .replace("on_exit = 'delete'", "on_exit = 'delete'\nallow_overlap = true")
        // A hundred times the gravity makes the fall ten times as short.
        .replace("-9.81]", "-981.0]\n[output]\nhistory_every_s = 1e-4\nevery_s = 4e-3\nformats = ['csv']");
    scene.bench.write("scene.toml", text);
    scene
}

fn history(scene: &FoamBox, out: &str) -> CsvTable {
    good(&scene.bench.run(&["run", "scene.toml", "--out", out, "--no-progress"]));
    CsvTable::parse(&scene.bench.read(&format!("{out}/history.csv")))
}

#[test]
fn a_floor_takes_as_much_over_openfoam_as_on_the_internal_grid() {
    const AGREEMENT: f64 = 0.02;
    let mesh = history(&floor_of("stl = 'floor.stl'\npatch = 'z0'\n"), "mesh");
    let patch = history(&floor_of("patch = 'z0'\n"), "patch");
    let scene = floor_of("plane = { point_m = [0, 0, 0], normal = [0, 0, 1] }\ncharging = 'grounded'\n");
    let coupled = history(&scene, "coupled");
    scene.alone();
    let alone = history(&scene, "alone");
    let taken = |table: &CsvTable| *table.numbers("wall_charge_C").last().expect("a row");
    for table in [&mesh, &patch, &coupled, &alone] {
        let [grains, walls] = ["net_charge_C", "wall_charge_C"].map(|column| table.numbers(column));
        let moved = *table.numbers("contact_charge_C").last().expect("a row");
        assert!(taken(table).abs() > 0.1 * moved && moved > 0.0, "{:e} {moved:e}", taken(table));
        for (grains, walls) in grains.iter().zip(&walls) {
            assert!((grains + walls).abs() < 1e-12 * moved, "{grains:e} {walls:e} {moved:e}");
        }
        let error = taken(table) / taken(&alone) - 1.0;
        assert!(error.abs() < AGREEMENT, "{error:e} of {:e}", taken(&alone));
    }
}
