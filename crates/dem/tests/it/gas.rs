//! Grains in a gas that they do not disturb.

use crate::common::{DENSITY, RADIUS, domain, grain, material, run, setup};
use amberfield_core::{Boundary, DragLaw, Gas, Vector3};
use amberfield_dem::{Setup, Simulation};
use amberfield_laws::particle_reynolds::Slip;
use amberfield_laws::{
    beetstra_drag, di_felice_drag, gidaspow_drag, magnus_lift, schiller_naumann_drag, stokes_drag,
};
use std::f64::consts::PI;

/// Air.
const AIR: Gas = Gas {
    drag: DragLaw::Stokes,
    density_kg_m3: 1.2,
    viscosity_pa_s: 1.8e-5,
    velocity_m_s: Vector3::new(0.0, 0.0, 0.0),
    magnus_lift: false,
    flow: None,
};
const GRAVITY: f64 = 9.81;

fn alone(radius: f64, gas: Gas, step_s: f64) -> Setup {
    let mut one = grain(1, [0.0; 3], [0.0; 3]);
    one.radius = radius;
    let mut scene = setup(vec![one], material(0.9, 0.0, 0.0), step_s);
    scene.domain = domain(1.0, Boundary::Periodic);
    scene.gas = Some(gas.into());
    scene.time.allow_unstable = true;
    scene
}

fn coefficient(law: DragLaw, diameter: f64, speed: f64) -> f64 {
    let slip = Slip {
        speed,
        void_fraction: 1.0,
        diameter,
        density: AIR.density_kg_m3,
        viscosity: AIR.viscosity_pa_s,
    };
    match law {
        DragLaw::Stokes => stokes_drag::coefficient(diameter, AIR.viscosity_pa_s),
        DragLaw::SchillerNaumann => schiller_naumann_drag::coefficient(&slip),
        DragLaw::DiFelice => di_felice_drag::coefficient(&slip),
        DragLaw::Gidaspow => gidaspow_drag::coefficient(&slip),
        DragLaw::Beetstra => beetstra_drag::coefficient(&slip),
    }
}

/// Speed at which drag carries weight less buoyancy.
fn terminal_speed(law: DragLaw, diameter: f64) -> f64 {
    let weight = (DENSITY - AIR.density_kg_m3) * PI / 6.0 * diameter.powi(3) * GRAVITY;
    let (mut slow, mut fast) = (0.0, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (slow + fast);
        let drag = coefficient(law, diameter, middle) * middle;
        if drag < weight { slow = middle } else { fast = middle }
    }
    slow
}

#[test]
fn grains_fall_at_the_terminal_speed_of_their_drag() {
    let mut reynolds = (f64::INFINITY, 0.0_f64);
    for law in DragLaw::ALL {
        for diameter in [1.1e-5, 5e-5, 2e-4, 6e-4, 1.5e-3] {
            let speed = terminal_speed(law, diameter);
            let mass = PI / 6.0 * DENSITY * diameter.powi(3);
            let response = mass / coefficient(law, diameter, speed);
            let mut scene = alone(0.5 * diameter, Gas { drag: law, ..AIR }, 0.02 * response);
            scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -GRAVITY);
            let mut fall = Simulation::new(scene).unwrap();
            run(&mut fall, 1000);
            let found = -fall.particles().velocity[0].z;
            assert!((found / speed - 1.0).abs() < 1e-6, "{law:?}, {diameter:e} m: {found} m/s, {speed} m/s");
            let re = AIR.density_kg_m3 * diameter * speed / AIR.viscosity_pa_s;
            if law == DragLaw::SchillerNaumann {
                reynolds = (reynolds.0.min(re), reynolds.1.max(re));
            }
        }
    }
    assert!(reynolds.0 < 0.01 && reynolds.1 > 900.0, "{reynolds:?}");
}

#[test]
fn velocity_decays_to_that_of_the_gas_with_second_order() {
    let wind = Vector3::new(0.3, -0.1, 0.2);
    let response = DENSITY * (2.0 * RADIUS).powi(2) / (18.0 * AIR.viscosity_pa_s);
    let error = |steps: u64| {
        let gas = Gas { velocity_m_s: wind, ..AIR };
        let mut scene = alone(RADIUS, gas, 2.0 * response / steps as f64);
        scene.domain = domain(50.0, Boundary::Periodic);
        let mut drift = Simulation::new(scene).unwrap();
        run(&mut drift, steps);
        (drift.particles().velocity[0] - wind * (1.0 - (-2.0_f64).exp())).norm()
    };
    let (coarse, fine) = (error(50), error(100));
    assert!(fine < 1e-4 && (coarse / fine).log2() > 1.9, "{coarse:e} {fine:e}");
}

#[test]
fn step_beyond_the_response_time_is_refused() {
    // A micrometre grain: 7.7 µs.
    let mut scene = alone(5e-7, AIR, 1e-5);
    scene.time.allow_unstable = false;
    scene.materials[0].young_pa = 1.0;
    let error = Simulation::new(scene).unwrap_err().to_string();
    assert!(error.contains("gas response"), "{error}");
}

#[test]
fn spinning_grain_is_lifted_as_rubinow_and_keller_say() {
    let gas = Gas { viscosity_pa_s: 1e-12, magnus_lift: true, ..AIR };
    let mut scene = alone(RADIUS, gas, 1e-6);
    scene.materials[0].friction = 0.3;
    let (velocity, spin) = (Vector3::new(1.0, 0.0, 0.0), Vector3::new(0.0, -100.0, 0.0));
    (scene.particles.velocity[0], scene.particles.angular_velocity[0]) = (velocity, spin);
    let mass = PI / 6.0 * DENSITY * (2.0 * RADIUS).powi(3);
    let expected =
        magnus_lift::force(velocity, spin, Vector3::zeros(), 2.0 * RADIUS, AIR.density_kg_m3) / mass * 1e-4;
    let mut flight = Simulation::new(scene).unwrap();
    run(&mut flight, 100);
    let found = flight.particles().velocity[0].z;
    assert!(expected.z > 0.0 && (found / expected.z - 1.0).abs() < 1e-3, "{found} {}", expected.z);
}
