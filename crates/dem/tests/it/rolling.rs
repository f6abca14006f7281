//! Rolling friction by each model: a sphere that rolls out, one that rocks, one on a slope.

use crate::common::{RADIUS, floor, grain, mass, material, run, setup};
use amberfield_core::{Material, RollingModel, Vector3};
use amberfield_dem::{Setup, Simulation};
use amberfield_laws::{hertz_mindlin as hertz, rolling_epsd};
use std::f64::consts::PI;

const GRAVITY: f64 = 9.81;
const STEP_S: f64 = 1e-6;

/// Sphere that rests on a floor which leans by an angle [rad], with a velocity [m/s] and a spin [rad/s].
fn on_floor(model: RollingModel, stuff: Material, lean: f64, velocity: f64, spin: f64) -> Setup {
    let load = mass(RADIUS) * GRAVITY * lean.cos();
    let overlap = (load / (4.0 / 3.0 * young() * RADIUS.sqrt())).powf(2.0 / 3.0);
    let mut ball = grain(1, [0.0, 0.0, RADIUS - overlap], [velocity, 0.0, 0.0]);
    ball.angular_velocity = Vector3::new(0.0, spin, 0.0);
    let mut scene = setup(vec![ball], stuff, STEP_S);
    scene.rolling_model = model;
    scene.walls = vec![floor()];
    scene.time.gravity_m_s2 = GRAVITY * Vector3::new(lean.sin(), 0.0, -lean.cos());
    scene
}

/// Y* of the sphere on its floor [Pa].
fn young() -> f64 {
    hertz::effective_young(1e7, 0.25, 1e7, 0.25)
}

/// Velocity along the floor [m/s] and spin [rad/s] after each of some times [s].
fn motion(scene: Setup, times: &[f64]) -> Vec<(f64, f64)> {
    let mut simulation = Simulation::new(scene).expect("a good scene");
    let mut at = Vec::new();
    for time in times {
        while simulation.time_s() < time - 0.5 * STEP_S {
            run(&mut simulation, 1);
        }
        let particles = simulation.particles();
        at.push((particles.velocity[0].x, particles.angular_velocity[0].y));
    }
    at
}

#[test]
fn sphere_rolls_out_at_five_sevenths_of_friction_by_every_model() {
    let (rolling, speed) = (0.02, 0.1);
    for model in RollingModel::ALL {
        let scene = on_floor(model, material(0.5, 0.5, rolling), 0.0, speed, speed / RADIUS);
        let at = motion(scene, &[0.05, 0.45]);
        let slowing = (at[0].0 - at[1].0) / 0.4;
        // R* = r; the arm is shorter by the overlap, 0.05 % of r.
        let expected = 5.0 / 7.0 * rolling * GRAVITY;
        assert!((slowing / expected - 1.0).abs() < 2e-3, "{model:?}: {slowing} {expected}");
        let slip = at[1].0 - at[1].1 * RADIUS;
        assert!(slip.abs() < 1e-3 * speed, "{model:?} rolls: {slip}");
    }
}

#[test]
fn slope_steeper_than_rolling_friction_lets_a_sphere_roll_and_a_gentler_one_holds_it() {
    let rolling: f64 = 0.1;
    for model in RollingModel::ALL {
        let steep = (1.5 * rolling).atan();
        let at = motion(on_floor(model, material(0.5, 0.5, rolling), steep, 0.0, 0.0), &[0.1, 0.3]);
        let found = (at[1].0 - at[0].0) / 0.2;
        let expected = 5.0 / 7.0 * GRAVITY * (steep.sin() - rolling * steep.cos());
        assert!((found / expected - 1.0).abs() < 3e-3, "{model:?}: {found} {expected}");

        let gentle = (0.8 * rolling).atan();
        let at = motion(on_floor(model, material(0.5, 0.5, rolling), gentle, 0.0, 0.0), &[0.3]);
        // A constant torque has no rest: the sphere creeps by what takes a tenth of its spin in a step.
        let creep = if model == RollingModel::Cdt { 25.0 * 0.8 * rolling * GRAVITY * STEP_S } else { 1e-9 };
        assert!(at[0].0.abs() < creep, "{model:?} creeps: {}", at[0].0);
    }
}

#[test]
fn spring_and_dashpot_of_epsd_rock_a_sphere_at_its_frequency_and_damping() {
    let rolling = 0.05;
    let scene = on_floor(RollingModel::Epsd, material(0.5, 0.9, rolling), 0.0, 1e-5, 1e-5 / RADIUS);
    let overlap = RADIUS - scene.particles.position[0].z;
    let stiffness =
        rolling_epsd::stiffness(hertz::normal_stiffness(young(), RADIUS, overlap), rolling, RADIUS);
    let inertia = 1.4 * mass(RADIUS) * RADIUS * RADIUS;
    let ratio = rolling_epsd::ROLLING_DAMPING_RATIO;
    let root = (1.0 - ratio * ratio).sqrt();
    let (own, period) = ((stiffness / inertia).sqrt(), 2.0 * PI / ((stiffness / inertia).sqrt() * root));
    let times: Vec<f64> = (1..40).map(|n| f64::from(n) * period / 20.0).collect();
    for (t, (_, spin)) in times.iter().zip(motion(scene, &times)) {
        // Solution of I ω' = −k ∫ω dt − C ω with ω(0) = ω₀.
        let phase = own * root * t;
        let expected = (-ratio * own * t).exp() * (phase.cos() - ratio / root * phase.sin());
        assert!((spin / (1e-5 / RADIUS) - expected).abs() < 0.01, "t = {t}: {spin} {expected}");
    }
}

#[test]
fn spring_of_epsd2_rocks_a_sphere_in_two_modes_without_loss() {
    let start = 1e-4;
    let scene = on_floor(RollingModel::Epsd2, material(1.0, 0.9, 0.5), 0.0, 0.0, start);
    let overlap = RADIUS - scene.particles.position[0].z;
    let shear = hertz::effective_shear(1e7, 0.25, 1e7, 0.25);
    let stiffness = hertz::tangential_stiffness(shear, RADIUS, overlap);
    let (m, arm) = (mass(RADIUS), RADIUS - overlap);
    let inertia = 0.4 * m * RADIUS * RADIUS;
    // m x'' = −S (x − aφ), I φ'' = a S (x − aφ) − S r² φ: eigenvalues λ and shapes φ/x = (1 − λm/S)/a.
    let turning = stiffness * (arm * arm + RADIUS * RADIUS);
    let (half, product) =
        (0.5 * (stiffness / m + turning / inertia), (stiffness * RADIUS).powi(2) / (m * inertia));
    let root = (half * half - product).sqrt();
    let modes =
        [half - root, half + root].map(|square| (square.sqrt(), (1.0 - square * m / stiffness) / arm));
    // Velocities at the start: x' = a₁ + a₂ = 0, φ' = a₁ s₁ + a₂ s₂.
    let share = start / (modes[0].1 - modes[1].1);
    let period = 2.0 * PI / modes[0].0;
    let times: Vec<f64> = (1..60).map(|n| f64::from(n) * period / 20.0).collect();
    for (t, (_, spin)) in times.iter().zip(motion(scene, &times)) {
        let [slow, fast] = modes.map(|(own, shape)| share * shape * (own * t).cos());
        assert!((spin - (slow - fast)).abs() < 0.02 * start, "t = {t}: {spin} {}", slow - fast);
    }
}
