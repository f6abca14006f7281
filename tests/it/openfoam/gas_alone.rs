//! Lone grains in a gas whose flow OpenFOAM computes.

use super::gas::{DENSITY, MovedGrains, VISCOSITY, cyclic, gas, solver};
use amberfield_core::{DragLaw, GasModel, Vector3};
use amberfield_gas::{Exchange, FlowSolver as _};
use amberfield_laws::drag;
use amberfield_laws::particle_reynolds::Slip;
use std::f64::consts::PI;

/// Speed [m/s] at which a lone grain of a diameter [m] and a density [kg/m³] falls by a drag law.
pub(super) fn terminal_speed(law: DragLaw, diameter: f64, solid: f64) -> f64 {
    let weight = (solid - DENSITY) * PI / 6.0 * diameter.powi(3) * 9.81;
    let force = |speed: f64| {
        let slip = Slip { speed, void_fraction: 1.0, diameter, density: DENSITY, viscosity: VISCOSITY };
        drag::coefficient(law, &slip) * speed
    };
    let (mut slow, mut fast) = (0.0, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (slow + fast);
        if force(middle) < weight { slow = middle } else { fast = middle }
    }
    slow
}

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
        let slow = terminal_speed(law, diameter, 2500.0);
        let slip = Slip { speed: slow, void_fraction: 1.0, diameter, density: DENSITY, viscosity: VISCOSITY };
        let response = 2500.0 * PI / 6.0 * diameter.powi(3) / drag::coefficient(law, &slip);
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
