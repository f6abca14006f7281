//! Lone grains in a gas whose flow OpenFOAM computes.

use super::gas::{DENSITY, MovedGrains, VISCOSITY, cyclic, gas, solver, start};
use amberfield_core::{DragLaw, GasModel, Vector3};
use amberfield_gas::{Exchange, FlowSolver as _};
use amberfield_laws::drag;
use amberfield_laws::particle_reynolds::Slip;
use std::f64::consts::PI;

#[test]
fn a_grain_falls_at_the_terminal_speed_of_its_drag_law() {
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let cases = [
        (DragLaw::Stokes, 2e-5),
        (DragLaw::SchillerNaumann, 1.2e-5),
        (DragLaw::SchillerNaumann, 1e-4),
        (DragLaw::SchillerNaumann, 4e-4),
        (DragLaw::SchillerNaumann, 1.55e-3),
    ];
    for (law, diameter) in cases {
        let weight = (2500.0 - DENSITY) * PI / 6.0 * diameter * diameter * diameter * 9.81;
        let beta = |speed: f64| {
            let slip = Slip { speed, void_fraction: 1.0, diameter, density: DENSITY, viscosity: VISCOSITY };
            drag::coefficient(law, &slip)
        };
        let (mut slow, mut fast) = (0.0, 1e3);
        for _ in 0..200 {
            let middle = 0.5 * (slow + fast);
            if beta(middle) * middle < weight { slow = middle } else { fast = middle }
        }
        let response = 2500.0 * PI / 6.0 * diameter.powi(3) / beta(slow);
        let edge_mm = 1500.0 * diameter * 1e3;
        let (_bench, flow) = solver([edge_mm; 3], [10; 3], &[cyclic(); 6], 1);
        let domain = flow.mesh().domain().clone();
        let (gas, settings) = gas(law, GasModel::A);
        let mut exchange =
            Exchange::new(gas, settings, gravity, Box::new(flow), diameter).expect("a good mesh");
        let mut grains = MovedGrains::new([[0.3e-3 * edge_mm; 3]], 0.5 * diameter, 2500.0);
        grains.velocity[0].z = -0.9 * slow;
        let interval = 0.1 * response;
        for k in 0..70 {
            exchange
                .exchange(&domain, &grains.view(), interval, f64::from(k) * interval)
                .expect("a good flow");
            grains.go(&mut exchange, gravity, interval, 10);
        }
        let found = -grains.velocity[0].z;
        assert!((found / slow - 1.0).abs() < 0.005, "{law:?} {diameter}: {found} {slow}");
    }
}

/// Force of a gas that rises at the terminal speed of a lone grain's drag law on this grain, over its weight;
/// cells are as large as so many diameters.
fn carried(diameter: f64, density: f64, cell: f64, counts: [usize; 3]) -> f64 {
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let weight = density * PI / 6.0 * diameter.powi(3) * 9.81;
    let beta = |speed: f64| {
        let slip = Slip { speed, void_fraction: 1.0, diameter, density: DENSITY, viscosity: VISCOSITY };
        drag::coefficient(DragLaw::Gidaspow, &slip)
    };
    let (mut slow, mut fast) = (0.0, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (slow + fast);
        if beta(middle) * middle < weight * (1.0 - DENSITY / density) { slow = middle } else { fast = middle }
    }
    let inlet = format!("type fixedValue; value uniform (0 0 {slow});");
    let slip = ["wall", "type slip;", "type zeroGradient;"];
    let open = "type pressureInletOutletVelocity; value uniform (0 0 0);";
    let sides = [
        slip,
        slip,
        slip,
        slip,
        ["patch", &inlet, "type zeroGradient;"],
        ["patch", open, "type fixedValue; value uniform 0;"],
    ];
    let edges = counts.map(|count| 1e3 * cell * diameter * count as f64);
    let (bench, flow) = solver(edges, counts, &sides, 1);
    drop(flow);
    // The gas has begun long ago.
    let rising = format!("internalField uniform (0 0 {slow});");
    bench.write("foam/0/U", bench.read("foam/0/U").replace("internalField uniform (0 0 0);", &rising));
    let flow = start(&bench, 1);
    let domain = flow.mesh().domain().clone();
    let (gas, settings) = gas(DragLaw::Gidaspow, GasModel::A);
    let mut exchange = Exchange::new(gas, settings, gravity, Box::new(flow), diameter).expect("a good mesh");
    let place = [0, 1, 2].map(|axis| [0.47e-3, 0.52e-3, 0.5e-3][axis] * edges[axis]);
    let grains = MovedGrains::new([place], 0.5 * diameter, density);
    let interval = 0.9 * cell * diameter / slow;
    let mut force = Vector3::zeros();
    for k in 0..2 * counts[2] {
        exchange.exchange(&domain, &grains.view(), interval, k as f64 * interval).expect("a good flow");
        force = grains.hold(&mut exchange, interval);
    }
    force.z / weight
}

#[test]
fn a_lone_grain_is_carried_at_its_terminal_speed_in_cells_of_any_size() {
    for (diameter, density) in [(2e-4, 500.0), (1e-3, 500.0)] {
        for (cell, counts) in [(10.0, [9, 9, 12]), (3.0, [10, 10, 14]), (1.0, [14, 14, 18])] {
            let carried = carried(diameter, density, cell, counts);
            assert!((carried - 1.0).abs() < 0.01, "{diameter} {cell}: {carried}");
        }
    }
}
