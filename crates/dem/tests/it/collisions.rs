//! Free flight and collisions against closed forms.

use crate::common::{RADIUS, floor, grain, mass, material, run, setup};
use amberfield_core::Vector3;
use amberfield_dem::{ElectricEnergy, Simulation};
use amberfield_laws::{hertz_mindlin as hertz, restitution};

/// Relative round-off of some thousand additions.
const ROUND_OFF: f64 = 1e-12;

#[test]
fn free_fall_is_exact() {
    let mut scene = setup(vec![grain(1, [0.1, 0.0, 0.5], [0.3, 0.0, 0.2])], material(0.9, 0.3, 0.0), 1e-5);
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).unwrap();
    run(&mut simulation, 10_000);
    let (t, grains) = (simulation.time_s(), simulation.particles());
    assert!((t - 0.1).abs() < ROUND_OFF);
    let expected = Vector3::new(0.1 + 0.3 * t, 0.0, 0.5 + 0.2 * t - 0.5 * 9.81 * t * t);
    assert!((grains.position[0] - expected).norm() < ROUND_OFF, "{:?}", grains.position[0]);
    assert!((grains.velocity[0].z - (0.2 - 9.81 * t)).abs() < ROUND_OFF);
}

/// Record of a head-on collision of two equal grains.
struct Collision {
    restitution: f64,
    largest_overlap: f64,
    duration: f64,
}

fn collide(e: f64, speed: f64, step: f64) -> Collision {
    let x = RADIUS * (1.0 + 1e-9);
    let grains = vec![
        grain(1, [-x, 0.0, 0.0], [0.5 * speed, 0.0, 0.0]),
        grain(2, [x, 0.0, 0.0], [-0.5 * speed, 0.0, 0.0]),
    ];
    let mut simulation = Simulation::new(setup(grains, material(e, 0.0, 0.0), step)).expect("a good scene");
    let (mut last, mut peak) = ((0.0, -1.0), 0.0_f64);
    let (mut begin, mut touched) = (0.0, false);
    loop {
        run(&mut simulation, 1);
        let p = simulation.particles();
        let overlap = 2.0 * RADIUS - (p.position[1].x - p.position[0].x);
        let approach = p.velocity[0].x - p.velocity[1].x;
        let time = simulation.time_s();
        // Crossing times and the peak between steps by Hermite's cubic, to fourth order.
        if overlap > 0.0 && !touched {
            touched = true;
            begin = time - overlap / approach;
        }
        if touched && approach <= 0.0 && last.1 > 0.0 {
            peak = hermite_peak(last, (overlap, approach), step);
        }
        if touched && overlap <= 0.0 {
            let duration = time - overlap / approach - begin;
            return Collision { restitution: -approach / speed, largest_overlap: peak, duration };
        }
        last = (overlap, approach);
    }
}

/// Peak of the cubic through (value, slope) at both ends of an interval.
fn hermite_peak(a: (f64, f64), b: (f64, f64), h: f64) -> f64 {
    let at = |t: f64| {
        let (t2, t3) = (t * t, t * t * t);
        a.0 * (2.0 * t3 - 3.0 * t2 + 1.0)
            + b.0 * (3.0 * t2 - 2.0 * t3)
            + h * (a.1 * (t3 - 2.0 * t2 + t) + b.1 * (t3 - t2))
    };
    (0..=1000).map(|k| at(f64::from(k) * 1e-3)).fold(0.0, f64::max)
}

/// Y*, R*, m* of two equal grains.
fn pair() -> (f64, f64, f64) {
    (hertz::effective_young(1e7, 0.25, 1e7, 0.25), 0.5 * RADIUS, 0.5 * mass(RADIUS))
}

#[test]
fn restitution_is_the_materials() {
    let (y, r, m) = pair();
    let step = hertz::contact_time(y, r, m, 0.2) / 400.0;
    for e in [0.3, 0.5, 0.7, 0.9, 1.0] {
        let found = collide(e, 0.2, step).restitution;
        // Issue's bound at 400 steps a collision.
        assert!((found - e).abs() < 1e-3, "e = {e}: {found}");
    }
}

#[test]
fn restitution_converges_with_first_order() {
    let (y, r, m) = pair();
    let duration = hertz::contact_time(y, r, m, 0.2);
    for e in [0.5, 0.9] {
        let errors: Vec<f64> = [100.0, 400.0, 1600.0, 6400.0]
            .iter()
            .map(|steps| (collide(e, 0.2, duration / steps).restitution - e).abs())
            .collect();
        // The contact begins and ends within a step, where the damping jumps as δ^{1/4}: first order, and
        // where in a step it ends adds some scatter.
        let order = (errors[0] / errors[3]).log2() / 6.0;
        assert!((0.8..1.5).contains(&order), "e = {e}: observed order {order}, errors {errors:?}");
    }
}

#[test]
fn elastic_collision_has_hertz_time_and_overlap_with_second_order() {
    let (y, r, m) = pair();
    let (duration, overlap) = (hertz::contact_time(y, r, m, 0.2), hertz::largest_overlap(y, r, m, 0.2));
    let errors: Vec<(f64, f64)> = [200.0, 400.0, 800.0]
        .iter()
        .map(|steps| {
            let c = collide(1.0, 0.2, duration / steps);
            ((c.duration / duration - 1.0).abs(), (c.largest_overlap / overlap - 1.0).abs())
        })
        .collect();
    // Issue's bound at 400 steps a collision.
    assert!(errors[1].0 < 1e-4 && errors[1].1 < 1e-4, "{errors:?}");
    let order = (errors[0].1 / errors[2].1).log2() / 2.0;
    assert!((1.7..2.6).contains(&order), "observed order {order}, errors {errors:?}");
}

#[test]
fn damped_overlap_has_the_closed_form() {
    let (y, r, m) = pair();
    // The damping starts as δ^{1/4}: first contact is resolved to a lower order than the rest.
    let step = hertz::contact_time(y, r, m, 0.2) / 4000.0;
    for e in [0.3, 0.6, 0.9] {
        let expected = hertz::largest_overlap_damped(y, r, m, 0.2, restitution::damping_ratio(e));
        let found = collide(e, 0.2, step).largest_overlap;
        assert!((found / expected - 1.0).abs() < 1e-4, "e = {e}: {found:e} {expected:e}");
    }
}

#[test]
fn elastic_energy_drift_is_bounded_and_of_second_order() {
    let (y, r, m) = pair();
    let duration = hertz::contact_time(y, r, m, 0.2);
    let drift = |steps: f64| {
        let x = RADIUS * 1.001;
        let grains =
            vec![grain(1, [-x, 0.0, 0.0], [0.1, 0.0, 0.0]), grain(2, [x, 0.0, 0.0], [-0.1, 0.0, 0.0])];
        let mut simulation =
            Simulation::new(setup(grains, material(1.0, 0.0, 0.0), duration / steps)).unwrap();
        let start = simulation.energies(ElectricEnergy::LeftOut).unwrap().kinetic;
        let mut worst = 0.0_f64;
        for _ in 0..(1.2 * steps) as u64 {
            run(&mut simulation, 1);
            let e = simulation.energies(ElectricEnergy::LeftOut).unwrap();
            worst = worst.max(((e.kinetic + e.contact) / start - 1.0).abs());
        }
        worst
    };
    let (coarse, fine) = (drift(100.0), drift(400.0));
    assert!(coarse < 1e-3, "{coarse:e}");
    let order = (coarse / fine).log2() / 2.0;
    assert!((1.7..2.5).contains(&order), "observed order {order}: {coarse:e} {fine:e}");
}

/// A ball that hits the floor with normal speed `down` and tangential speed `along`; velocity, spin after.
fn oblique(e: f64, friction: f64, down: f64, along: f64) -> (Vector3<f64>, Vector3<f64>) {
    let mut scene = setup(
        vec![grain(1, [0.0, 0.0, RADIUS * 1.0001], [along, 0.0, -down])],
        material(e, friction, 0.0),
        1e-7,
    );
    scene.walls = vec![floor()];
    let mut simulation = Simulation::new(scene).expect("a good scene");
    let mut touched = false;
    loop {
        run(&mut simulation, 1);
        let contacts = simulation.contacts();
        if touched && contacts == 0 {
            let p = simulation.particles();
            return (p.velocity[0], p.angular_velocity[0]);
        }
        touched |= contacts > 0;
    }
}

#[test]
fn oblique_impact_with_gross_sliding_is_the_rigid_body_formula() {
    let (e, mu, down) = (0.8, 0.1, 0.1);
    let along = 0.3;
    let (v, w) = oblique(e, mu, down, along);
    let impulse = mu * (1.0 + e) * down;
    // The pull at the end of the contact carries no friction and the arm is r − δ: 1 % each at this speed.
    assert!((v.z / (e * down) - 1.0).abs() < 1e-3, "{v:?}");
    assert!(((along - v.x) / impulse - 1.0).abs() < 0.02, "{v:?} {impulse}");
    assert!((w.y * RADIUS / (2.5 * impulse) - 1.0).abs() < 0.03, "{w:?}");
}

#[test]
fn oblique_impact_at_small_angle_sticks() {
    let (v, w) = oblique(1.0, 0.5, 0.1, 0.01);
    // The contact point's tangential velocity comes out between elastic reversal (v_x = 3/7) and untouched
    // (1): the tangential spring swings about 1.7 times while the normal one swings once.
    assert!(v.x > 3.0 / 7.0 * 0.01 && v.x < 0.01, "{v:?}");
    assert!((v.z / 0.1 - 1.0).abs() < 1e-3);
    // Angular momentum about the contact is kept: m v r + (2/5) m r² ω.
    let before = 0.01;
    let after = v.x + 0.4 * RADIUS * w.y;
    assert!((after / before - 1.0).abs() < 0.01, "{after}");
}

#[test]
fn sliding_turns_into_rolling_at_five_sevenths() {
    let (mu, g, start) = (0.3, 9.81, 0.2);
    // Resting overlap: (4/3) Y* √r δ^{3/2} = m g.
    let y = hertz::effective_young(1e7, 0.25, 1e7, 0.25);
    let rest = (mass(RADIUS) * g / (4.0 / 3.0 * y * RADIUS.sqrt())).powf(2.0 / 3.0);
    let mut scene =
        setup(vec![grain(1, [0.0, 0.0, RADIUS - rest], [start, 0.0, 0.0])], material(0.5, mu, 0.0), 1e-6);
    scene.walls = vec![floor()];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -g);
    let mut simulation = Simulation::new(scene).unwrap();
    let transition = 2.0 * start / (7.0 * mu * g);
    let mut found = None;
    while simulation.time_s() < 2.0 * transition {
        run(&mut simulation, 10);
        let p = simulation.particles();
        let slip = p.velocity[0].x - RADIUS * p.angular_velocity[0].y;
        if slip < 1e-3 * start && found.is_none() {
            found = Some(simulation.time_s());
        }
        if simulation.time_s() < 0.9 * transition {
            let expected = start - mu * g * simulation.time_s();
            assert!((p.velocity[0].x / expected - 1.0).abs() < 1e-3);
        }
    }
    // The slip falls below 1e-3 of the start a thousandth before; the spring's ringing is of the same size.
    assert!((found.unwrap() / transition - 1.0).abs() < 5e-3, "{found:?} {transition}");
    let p = simulation.particles();
    assert!((p.velocity[0].x / (5.0 / 7.0 * start) - 1.0).abs() < 2e-3, "{:?}", p.velocity[0]);
}
