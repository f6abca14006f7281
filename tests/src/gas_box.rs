//! Box that air enters from below, with grains in it and an OpenFOAM case.

use crate::Workbench;
use crate::foam_case::{brick, write_gas_case, write_potential};

/// Scene of the box.
pub const GAS_SCENE: &str = "[domain]\nmin_m = [0, 0, 0]\nmax_m = [0.01, 0.01, 0.03]\n\
    boundary = { x = 'grounded', y = 'grounded', z = 'insulating' }\n\
    [[materials]]\nname = 'glass'\ndensity_kg_m3 = 1000.0\nyoung_Pa = 5e5\npoisson = 0.22\n\
    restitution = 0.6\nfriction = 0.3\n\
    [[walls]]\nplane = { point_m = [0, 0, 0], normal = [0, 0, 1] }\nmaterial = 'glass'\n\
    [particles]\non_exit = 'delete'\ngenerate = { material = 'glass', count = 700, radius_m = 5e-4, \
    seed = 3, region = { box = { min_m = [0, 0, 0], max_m = [0.01, 0.01, 0.012] } }, \
    charge_C = { bipolar = 2e-12 } }\n\
    [electric_field]\ntuning = 'model'\ntolerance = 2e-2\n\
    [gas]\nflow = 'solver'\ndrag = 'di_felice'\ninterval_s = 2e-4\ndensity_kg_m3 = 1.2\n\
    viscosity_Pa_s = 1.8e-5\n\
    [time]\nstep_s = 'auto'\nend_s = 8e-3\ngravity_m_s2 = [0, 0, -9.81]\n\
    [solver]\nopenfoam_case = 'foam'\ntimeout_s = 20.0\n[output]\nformats = ['csv']\n";

/// Side of the box.
#[derive(Clone, Copy)]
struct Side {
    kind: &'static str,
    velocity: &'static str,
    pressure: &'static str,
    potential: &'static str,
}

/// Box that air enters from below, with its case.
///
/// # Panics
/// When its folder cannot be written.
#[must_use]
pub fn gas_box(scene: &str) -> Workbench {
    let bench = Workbench::new(scene);
    let wall = Side {
        kind: "wall",
        velocity: "type slip;",
        pressure: "type zeroGradient;",
        potential: "type fixedValue; value uniform 0;",
    };
    let below = Side {
        kind: "patch",
        velocity: "type interstitialInletVelocity; inletVelocity uniform (0 0 0.6); alpha alpha; \
                   value uniform (0 0 0.6);",
        pressure: "type fixedFluxPressure; value uniform 0;",
        potential: "type zeroGradient;",
    };
    let above = Side {
        kind: "patch",
        velocity: "type pressureInletOutletVelocity; value uniform (0 0 0);",
        pressure: "type fixedValue; value uniform 0;",
        potential: "type zeroGradient;",
    };
    let sides = [wall, wall, wall, wall, below, above];
    let (edges, cells) = ([10.0, 10.0, 30.0], [4, 4, 12]);
    let velocity = brick(edges, cells, &sides.map(|side| (side.kind, side.velocity)));
    let pressure = brick(edges, cells, &sides.map(|side| (side.kind, side.pressure)));
    let potential = brick(edges, cells, &sides.map(|side| (side.kind, side.potential)));
    write_gas_case(&bench, &velocity.mesh, &velocity.conditions, &pressure.conditions, 1.5e-5);
    write_potential(&bench, &potential.conditions);
    bench
}
