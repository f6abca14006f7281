//! Forces on walls: the weight of a bed, and the balances of momentum and angular momentum.

use crate::common::{RADIUS, lattice, mass, material, mesh_floor, run, setup, wall};
use amberfield_core::{RollingModel, Vector3, Wall, WallShape};
use amberfield_dem::{Setup, Simulation, WallLoad};

const GRAVITY: f64 = 9.81;
const HALF: f64 = 4.0 * RADIUS;

/// Grains that fall into a box of four planes and a floor, with friction and rolling friction.
fn falling(step_s: f64) -> Setup {
    let grains = lattice([-HALF, -HALF, 0.0], [HALF, HALF, 8.0 * RADIUS], 2.2 * RADIUS, 0.2, 5);
    let mut scene = setup(grains, material(0.3, 0.4, 0.05), step_s);
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -GRAVITY);
    let side = |normal: Vector3<f64>| wall(WallShape::Plane { point: -HALF * normal, normal });
    scene.walls = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y()].map(side).into();
    scene
}

/// Plane z = 0.
fn flat() -> Wall {
    wall(WallShape::Plane { point: Vector3::zeros(), normal: Vector3::z() })
}

/// Loads on all walls.
fn total(simulation: &Simulation) -> WallLoad {
    let loads = simulation.wall_loads().expect("there are walls");
    loads.into_iter().fold(WallLoad::default(), |sum, load| WallLoad {
        normal: sum.normal + load.normal,
        tangential: sum.tangential + load.tangential,
        torque: sum.torque + load.torque,
    })
}

#[test]
fn floor_of_planes_or_triangles_and_sides_bear_the_weight_of_a_bed_at_rest() {
    for floor in [flat(), mesh_floor(2.0 * HALF, 7)] {
        let mut scene = falling(1e-5);
        let count = scene.particles.len() as f64;
        scene.walls.push(floor);
        let mut simulation = Simulation::new(scene).expect("a good scene");
        run(&mut simulation, 60_000);
        let weight = count * mass(RADIUS) * GRAVITY;
        let sum = total(&simulation);
        let force = (sum.normal + sum.tangential) / weight;
        assert!((force - Vector3::new(0.0, 0.0, -1.0)).norm() < 1e-3, "{force:?}");
        let loads = simulation.wall_loads().expect("there are walls");
        let below = loads[4].normal.z / weight;
        assert!((-1.0..-0.6).contains(&below), "sides carry some by friction: {below}");
        assert!(loads[0].normal.x < 0.0 && loads[0].normal.z == 0.0 && loads[0].tangential.x.abs() < 1e-18);
    }
}

#[test]
fn grains_lose_the_momentum_and_the_angular_momentum_that_walls_and_gravity_take() {
    for model in RollingModel::ALL {
        let step = 2e-6;
        let mut scene = falling(step);
        scene.rolling_model = model;
        scene.walls.push(flat());
        let mut simulation = Simulation::new(scene).expect("a good scene");
        let momenta = |simulation: &Simulation| {
            let grains = simulation.particles();
            let mut sum = (Vector3::zeros(), Vector3::zeros(), Vector3::zeros());
            for n in 0..grains.len() {
                let (m, x, v) = (mass(RADIUS), grains.position[n], grains.velocity[n]);
                sum.0 += m * v;
                sum.1 += m * x.cross(&v) + 0.4 * m * RADIUS * RADIUS * grains.angular_velocity[n];
                sum.2 += m * x;
            }
            sum
        };
        let at_start = momenta(&simulation);
        let weight = Vector3::new(0.0, 0.0, -GRAVITY);
        // Velocity Verlet sums forces by the trapezoidal rule.
        let (mut impulse, mut turn) = (Vector3::zeros(), Vector3::zeros());
        let mut largest: f64 = 0.0;
        let taken = |simulation: &Simulation| {
            let (sum, (_, _, first)) = (total(simulation), momenta(simulation));
            (-sum.normal - sum.tangential, first.cross(&weight) - sum.torque)
        };
        let mut before = taken(&simulation);
        for _ in 0..15_000 {
            run(&mut simulation, 1);
            let now = taken(&simulation);
            impulse += 0.5 * step * (before.0 + now.0);
            turn += 0.5 * step * (before.1 + now.1);
            largest = largest.max(impulse.norm());
            before = now;
        }
        let at_end = momenta(&simulation);
        let count = simulation.len() as f64;
        impulse += 15_000.0 * step * count * mass(RADIUS) * weight;
        let error = (at_end.0 - at_start.0 - impulse).norm() / largest;
        assert!(error < 1e-9, "{model:?}: momentum {error:e}");
        let error = (at_end.1 - at_start.1 - turn).norm() / (largest * HALF);
        assert!(error < 1e-3, "{model:?}: angular momentum {error:e}");
    }
}
