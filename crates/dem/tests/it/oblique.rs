//! Oblique impact of a ball on a plane against rigid-body limits and an independent integration.

use crate::common::{DENSITY, RADIUS, floor, grain, material, run, setup};
use amberfield_dem::Simulation;

const DOWN: f64 = 0.05;
const YOUNG: f64 = 1e7;
const POISSON: f64 = 0.25;
/// Error of the slip at 3000 steps in a contact: the tangential spring takes the slip at the end of each
/// step, first order.
const STEPS_3000: f64 = 2e-3;

/// A ball's velocity normal to and along the floor, and its spin.
#[derive(Clone, Copy, Debug)]
struct Rebound {
    normal: f64,
    along: f64,
    spin: f64,
}

impl Rebound {
    /// Tangential velocity of the contact point over that before.
    fn tangential_ratio(self, along: f64) -> f64 {
        (self.along - RADIUS * self.spin) / along
    }
}

fn simulated(restitution: f64, friction: f64, along: f64, step: f64) -> Rebound {
    let mut scene = setup(
        vec![grain(1, [0.0, 0.0, RADIUS * (1.0 + 1e-9)], [along, 0.0, -DOWN])],
        material(restitution, friction, 0.0),
        step,
    );
    scene.walls = vec![floor()];
    let mut simulation = Simulation::new(scene).expect("a good scene");
    let mut touched = false;
    loop {
        run(&mut simulation, 1);
        let contacts = simulation.contacts();
        if touched && contacts == 0 {
            let p = simulation.particles();
            return Rebound {
                normal: p.velocity[0].z,
                along: p.velocity[0].x,
                spin: p.angular_velocity[0].y,
            };
        }
        touched |= contacts > 0;
    }
}

/// Contact of the scene as an ordinary differential equation, Runge–Kutta of fourth order with steps so short
/// that the halved step changes nothing below 1e-6. Elastic: δ' = −v_n, m v_n' = (4/3)Y*√r δ^{3/2}, F' =
/// −8G*√(rδ) v_s (+ F a'/a while the contact radius a = √(rδ) shrinks), |F| ≤ μ F_n, m v' = F, (2/5)m r² ω' =
/// −(r − δ)F.
fn integrated(friction: f64, along: f64) -> Rebound {
    let y = YOUNG / (2.0 * (1.0 - POISSON * POISSON));
    let shear = YOUNG / (2.0 * (1.0 + POISSON)) / (2.0 * (2.0 - POISSON));
    let m = 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) * DENSITY;
    let load = |overlap: f64| 4.0 / 3.0 * y * RADIUS.sqrt() * overlap.max(0.0).powf(1.5);
    // overlap, speed out of the floor, speed along, spin, tangential force
    type Point = [f64; 5];
    let limited = |x: Point| x[4].clamp(-friction * load(x[0]), friction * load(x[0]));
    let slope = |x: Point| -> Point {
        let (overlap, force) = (x[0].max(0.0), limited(x));
        let arm = RADIUS - overlap;
        let slip = x[2] - arm * x[3];
        let mut growth = -8.0 * shear * (RADIUS * overlap).sqrt() * slip;
        if x[1] > 0.0 && overlap > 0.0 {
            growth -= force * x[1] / (2.0 * overlap);
        }
        [-x[1], load(overlap) / m, force / m, -arm * force / (0.4 * m * RADIUS * RADIUS), growth]
    };
    let mut x: Point = [0.0, -DOWN, along, 0.0, 0.0];
    let h = 2e-9;
    loop {
        let at = |k: &Point, s: f64| -> Point { std::array::from_fn(|n| x[n] + s * k[n]) };
        let k1 = slope(x);
        let k2 = slope(at(&k1, 0.5 * h));
        let k3 = slope(at(&k2, 0.5 * h));
        let k4 = slope(at(&k3, h));
        let next: Point =
            std::array::from_fn(|n| x[n] + h / 6.0 * (k1[n] + 2.0 * k2[n] + 2.0 * k3[n] + k4[n]));
        if next[0] <= 0.0 {
            return Rebound { normal: x[1], along: x[2], spin: x[3] };
        }
        x = next;
        x[4] = limited(x);
    }
}

#[test]
fn sticking_partly_sliding_and_sliding_impacts_are_the_integrated_ones() {
    // From sticking (ψ₁ < 1) to sliding all the time (ψ₁ > 4χ − 1); ψ as below.
    for (friction, along) in [(0.5, 0.002), (0.5, 0.02), (0.3, 0.03), (0.2, 0.05), (0.1, 0.03), (0.1, 0.2)] {
        let (found, expected) = (simulated(1.0, friction, along, 1e-7), integrated(friction, along));
        assert!((found.normal / expected.normal - 1.0).abs() < 1e-5, "{found:?} {expected:?}");
        let (a, b) = (found.tangential_ratio(along), expected.tangential_ratio(along));
        assert!((a - b).abs() < STEPS_3000, "μ = {friction}, v_t = {along}: {a} {b}");
        assert!((found.along - expected.along).abs() < STEPS_3000 * along);
    }
}

#[test]
fn sticking_impact_converges_to_the_integrated_one() {
    let (friction, along) = (0.5, 0.005);
    let expected = integrated(friction, along).tangential_ratio(along);
    let errors: Vec<f64> = [1.6e-6, 4e-7, 1e-7]
        .map(|step| (simulated(1.0, friction, along, step).tangential_ratio(along) - expected).abs())
        .into();
    let order = (errors[0] / errors[2]).log2() / 4.0;
    assert!(order > 0.8, "observed order {order}: {errors:?}");
}

#[test]
fn tangential_rebound_follows_the_limits_of_maw_barber_and_fawcett() {
    // ψ = 2(1 − ν) v_t/(μ(2 − ν) v_n), χ = (7/2)(1 − ν)/(2 − ν) (Maw, Barber & Fawcett, Wear 38, 101 (1976)):
    // contact point velocities before (1) and after (2) obey ψ₂ = ψ₁ − 4χ for ψ₁ ≥ 4χ − 1, and less is lost
    // below.
    let (chi, scale) = (3.5 * (1.0 - POISSON) / (2.0 - POISSON), 2.0 * (1.0 - POISSON) / (2.0 - POISSON));
    let friction = 0.2;
    for psi in [0.2, 0.6, 1.0, 2.0, 3.0, 4.0, 4.0 * chi - 0.8, 4.0 * chi, 8.0] {
        let along = psi * friction * DOWN / scale;
        let after = psi * simulated(1.0, friction, along, 2e-7).tangential_ratio(along);
        if psi > 4.0 * chi - 1.0 {
            // The arm is r − δ, shorter by some tenths of a per cent.
            assert!((after - (psi - 4.0 * chi)).abs() < 0.01 * psi, "ψ₁ = {psi}: {after}");
        } else {
            assert!(after > psi - 4.0 * chi - 0.01 && after.abs() <= psi, "ψ₁ = {psi}: {after}");
        }
        // Sticking all the time the spring swings 1.7 times and returns the slip's sign; in between it
        // reverses it.
        assert!(psi > 0.9 || after > 0.0, "ψ₁ = {psi}: {after}");
        assert!(!(3.5..5.0).contains(&psi) || after < 0.0, "ψ₁ = {psi}: {after}");
    }
}

#[test]
fn damped_gross_sliding_loses_the_rigid_body_impulse() {
    for e in [0.9, 0.6] {
        let (friction, along) = (0.1, 0.3);
        let found = simulated(e, friction, along, 1e-7);
        let impulse = friction * (1.0 + e) * DOWN;
        // The pull at the end of a damped contact carries no friction: 2 % for e = 0.6.
        assert!(((along - found.along) / impulse - 1.0).abs() < 0.03, "e = {e}: {found:?} {impulse}");
        assert!((found.normal / (e * DOWN) - 1.0).abs() < 1e-3, "e = {e}: {found:?}");
    }
}
