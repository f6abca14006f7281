//! A small plain bed in a periodic box: grains that fly about and collide, without walls, gas or charges.

use amberfield_core::{Boundary, Domain, Grain, GroupId, Material, MaterialId, Particles, Vector3};

/// Radius of every grain [m].
pub(crate) const RADIUS: f64 = 1e-3;
/// Time step [s].
pub(crate) const STEP_S: f64 = 8e-6;
/// Skin of the neighbour lists [m].
pub(crate) const SKIN_M: f64 = 0.2 * RADIUS;
/// Steps of a run: enough that checking and building the scene count for little.
pub(crate) const STEPS: usize = 1000;
/// Contacts that a run ends with at least: a bed without contacts says little.
pub(crate) const FEWEST_CONTACTS: usize = 100;

const PER_AXIS: usize = 12;
/// Distance of neighbours at the start [m].
const SPACING: f64 = 2.1 * RADIUS;

/// Grains on a lattice, with speeds that look random and are the same in every run.
pub(crate) fn particles() -> Particles {
    (0..PER_AXIS.pow(3))
        .map(|k| {
            let cell = [k % PER_AXIS, k / PER_AXIS % PER_AXIS, k / PER_AXIS / PER_AXIS];
            let speed = |axis: usize| 0.2 * ((k * (axis + 3) * 7919 % 1000) as f64 / 500.0 - 1.0);
            Grain {
                id: k as u64,
                position: Vector3::from(cell.map(|at| (at as f64 + 0.5) * SPACING)),
                velocity: Vector3::new(speed(0), speed(1), speed(2)),
                angular_velocity: Vector3::zeros(),
                radius: RADIUS,
                density: 2500.0,
                charge: 0.0,
                material: MaterialId(0),
                group: GroupId(0),
            }
        })
        .collect()
}

/// The periodic box around them.
pub(crate) fn domain() -> Domain {
    let length = PER_AXIS as f64 * SPACING;
    Domain::new(Vector3::zeros(), Vector3::repeat(length), [[Boundary::Periodic; 2]; 3])
        .expect("positive extents")
}

/// Glass with friction.
pub(crate) fn materials() -> Vec<Material> {
    vec![Material {
        name: "glass".into(),
        density_kg_m3: 2500.0,
        young_pa: 1e7,
        young_real_pa: None,
        poisson: 0.25,
        restitution: 0.9,
        friction: 0.3,
        rolling_friction: 0.0,
        surface_energy_j_m2: 0.0,
        work_function_ev: None,
    }]
}

/// Prints what a run ends with, to the last bit; `velocity` [m/s] is in the order of the set-up.
#[expect(clippy::print_stdout, reason = "a program of its own, whose lines are compared")]
pub(crate) fn tell(contacts: usize, velocity: impl Iterator<Item = Vector3<f64>>) {
    assert!(contacts > FEWEST_CONTACTS, "{contacts} contacts are too few");
    let sum: f64 = velocity.map(|velocity| velocity.norm_squared()).sum();
    println!("{contacts} contacts, sum of squared speeds {sum:e} m2/s2");
}
