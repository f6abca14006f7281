//! Cases of OpenFOAM's own examples, with nothing but a `phiE` added.

use super::{copy_example, difference, good};
use amberfield_tests::{CsvTable, Workbench};

/// Example of OpenFOAM's.
struct Example {
    /// Folder among the examples.
    folder: &'static str,
    /// Conditions of the potential.
    conditions: &'static str,
    /// Corners of the box in which grains are, and their radius [m].
    region: [[f64; 3]; 2],
    radius: f64,
}

const EXAMPLES: [Example; 3] = [
    // Functions in its controlDict, a patch of each kind.
    Example {
        folder: "incompressible/pimpleFoam/RAS/TJunction",
        conditions: "inlet { type zeroGradient; } \"outlet.*\" { type fixedValue; value uniform 100; } \
                     defaultFaces { type fixedValue; value uniform 0; }",
        region: [[0.01, -0.009, 0.001], [0.19, 0.009, 0.019]],
        radius: 5e-4,
    },
    Example {
        folder: "heatTransfer/buoyantBoussinesqPimpleFoam/hotRoom",
        conditions: "\".*\" { type fixedValue; value uniform 0; } ceiling { type zeroGradient; }",
        region: [[1.0, 0.5, 1.0], [9.0, 4.5, 9.0]],
        radius: 2e-2,
    },
    // Its own decomposeParDict asks for six parts.
    Example {
        folder: "lagrangian/DPMFoam/Goldschmidt",
        conditions: "\"(top|bottom|walls)\" { type fixedValue; value uniform 0; } \
                     frontAndBack { type symmetry; }",
        region: [[-0.006, -0.07, 0.1], [0.006, 0.07, 0.2]],
        radius: 5e-4,
    },
];

/// Grains on a lattice of four in each direction, with charges of both signs.
fn grains([low, high]: [[f64; 3]; 2], radius: f64) -> String {
    let mut text = "id,x_m,y_m,z_m,radius_m,charge_C,material\n".to_owned();
    for id in 0..64 {
        let steps = [id % 4, id / 4 % 4, id / 16];
        let [x, y, z] =
            [0, 1, 2].map(|axis| low[axis] + (high[axis] - low[axis]) * (f64::from(steps[axis]) + 0.5) / 4.0);
        let charge = if steps.iter().sum::<i32>() % 2 == 0 { 1e-13 } else { -1e-13 };
        text += &format!("{id},{x},{y},{z},{radius},{charge},glass\n");
    }
    text
}

const SCENE: &str = "[[materials]]\nname = 'glass'\ndensity_kg_m3 = 2500.0\nyoung_Pa = 5e6\npoisson = 0.22\n\
    restitution = 0.6\nfriction = 0.3\n[particles]\nfile = 'grains.csv'\non_exit = 'delete'\n\
    [electric_field]\ntuning = 'model'\n[time]\nstep_s = 'auto'\nend_s = 1.0\n\
    [solver]\nopenfoam_case = 'foam'\n";

#[test]
fn openfoams_examples_run_with_nothing_but_a_potential_added() {
    for Example { folder, conditions, region, radius } in EXAMPLES {
        let bench = Workbench::new(SCENE);
        bench.write("grains.csv", grains(region, radius));
        copy_example(&bench, folder);
        bench.write(
            "foam/0/phiE",
            format!(
                "FoamFile {{ version 2.0; format ascii; class volScalarField; object phiE; }}\n\
                 dimensions [1 2 -3 0 0 -1 0];\ninternalField uniform 0;\nboundaryField {{ {conditions} }}\n"
            ),
        );
        let energy = ["solver.ranks=1", "solver.ranks=2"].map(|ranks| {
            let out = ranks.replace('.', "-");
            let run = ["run", "scene.toml", "--out", &out, "--steps", "5", "--no-progress", "--set", ranks];
            good(&bench.run(&run));
            CsvTable::parse(&bench.read(&format!("{out}/history.csv"))).numbers("electric_J")
        });
        let error = difference(&energy[1], &energy[0]);
        assert!(error < 1e-3, "{folder}: one rank and two differ by {error:e}");
    }
}
