//! A small plain bed that bounces on a floor: what `cargo xtask leaving-out` counts the instructions of.
//!
//! It needs neither the feature `field` nor a random number.

use amberfield_core::{
    Boundary, Domain, Grain, GroupId, Material, MaterialId, OnExit, Particles, Skin, Step, TimeSettings,
    Vector3,
};
use amberfield_dem::{Setup, Simulation};

const RADIUS: f64 = 1e-3;
const PER_AXIS: usize = 12;
const STEPS: usize = 400;

fn bed() -> Setup {
    let spacing = 2.1 * RADIUS;
    let particles: Particles = (0..PER_AXIS.pow(3))
        .map(|k| {
            let cell = [k % PER_AXIS, k / PER_AXIS % PER_AXIS, k / PER_AXIS / PER_AXIS];
            let speed = |axis: usize| 0.2 * ((k * (axis + 3) * 7919 % 1000) as f64 / 500.0 - 1.0);
            Grain {
                id: k as u64,
                position: Vector3::from(cell.map(|at| (at as f64 + 0.5) * spacing)),
                velocity: Vector3::new(speed(0), speed(1), speed(2)),
                angular_velocity: Vector3::zeros(),
                radius: RADIUS,
                density: 2500.0,
                charge: 0.0,
                material: MaterialId(0),
                group: GroupId(0),
            }
        })
        .collect();
    let length = PER_AXIS as f64 * spacing;
    Setup {
        domain: Domain::new(Vector3::zeros(), Vector3::repeat(length), [[Boundary::Periodic; 2]; 3])
            .expect("positive extents"),
        materials: vec![Material {
            name: "glass".into(),
            density_kg_m3: 2500.0,
            young_pa: 1e7,
            young_real_pa: None,
            poisson: 0.25,
            restitution: 0.9,
            friction: 0.3,
            rolling_friction: 0.0,
            work_function_ev: None,
        }],
        particles,
        walls: Vec::new(),
        time: TimeSettings {
            step: Step::Seconds(8e-6),
            end_s: 1.0,
            gravity_m_s2: Vector3::zeros(),
            skin: Skin::Auto,
            allow_unstable: false,
            on_exit: OnExit::Stop,
            allow_overlap: false,
        },
        gas: None,
        field: None,
    }
}

fn main() {
    let mut simulation = Simulation::new(bed()).expect("a good scene");
    for _ in 0..STEPS {
        simulation.step().expect("a periodic box");
    }
    assert!(simulation.contacts() > 100, "a bed without contacts says little");
}
