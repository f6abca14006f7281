//! Restitution and rest where steps are few, damping is strong and grains are soft.

use crate::common::{RADIUS, floor, grain, lattice, mass, material, run, setup, wall};
use amberfield_core::{Material, Step, Vector3, WallShape};
use amberfield_dem::{ElectricEnergy, Simulation};
use amberfield_laws::hertz_mindlin as hertz;

/// Rebound over approach of two equal grains, on the mean over where in a step they touch.
fn restitution(e: f64, steps: f64) -> f64 {
    let (young, speed) = (hertz::effective_young(1e7, 0.25, 1e7, 0.25), 0.2);
    let step = hertz::contact_time(young, 0.5 * RADIUS, 0.5 * mass(RADIUS), speed) / steps;
    let phases = 20;
    let rebound = |phase: f64| {
        let half = RADIUS + 0.5 * phase * step * speed;
        let grains = vec![
            grain(1, [-half, 0.0, 0.0], [0.5 * speed, 0.0, 0.0]),
            grain(2, [half, 0.0, 0.0], [-0.5 * speed, 0.0, 0.0]),
        ];
        // With friction, as in a bed: it does not change a head-on impact.
        let mut simulation =
            Simulation::new(setup(grains, material(e, 0.5, 0.0), step)).expect("a good scene");
        run(&mut simulation, (6.0 * steps) as u64);
        let v = simulation.particles().velocity;
        (v[1].x - v[0].x) / speed
    };
    (0..phases).map(|n| rebound((f64::from(n) + 0.5) / f64::from(phases))).sum::<f64>() / f64::from(phases)
}

#[test]
fn few_steps_a_contact_keep_the_restitution() {
    // Found 0.104, 0.195, 0.281, 0.493, 0.903 at 4.4 steps; before 0.075, 0.127, 0.210, 0.411, 0.879.
    for (e, bound) in [(0.1, 0.02), (0.2, 0.015), (0.3, 0.025), (0.5, 0.01), (0.9, 0.005)] {
        let few = restitution(e, 4.4);
        assert!((few - e).abs() < bound, "e = {e}: {few} at 4.4 steps");
        let more = restitution(e, 20.0);
        assert!((more - e).abs() < 0.002, "e = {e}: {more} at 20 steps");
    }
}

/// Bed of 128 grains in a box of planes, settled with a step [s] or the automatic one: mean height [m],
/// kinetic energy at the end over N m g d.
fn settled(e: f64, young: f64, step: Step) -> (f64, f64) {
    let soft = Material { young_pa: young, ..material(e, 0.5, 0.0) };
    let half = 5.0 * RADIUS;
    let mut grains = lattice([-half, -half, 0.0], [half, half, 18.0 * RADIUS], 2.2 * RADIUS, 0.05, 11);
    grains.truncate(128);
    let mut scene = setup(grains, soft, 1e-6);
    scene.time.step = step;
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let side = |normal: Vector3<f64>| wall(WallShape::Plane { point: -half * normal, normal });
    scene.walls = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y()].map(side).into();
    scene.walls.push(floor());
    let mut simulation = Simulation::new(scene).expect("a good scene");
    while simulation.time_s() < 0.4 {
        run(&mut simulation, 100);
    }
    let particles = simulation.particles();
    let height = particles.position.iter().map(|x| x.z).sum::<f64>() / particles.len() as f64;
    let kinetic = simulation.energies(ElectricEnergy::LeftOut).expect("no field").kinetic;
    (height, kinetic / (particles.len() as f64 * mass(RADIUS) * 9.81 * 2.0 * RADIUS))
}

#[test]
fn beds_rest_for_any_restitution_and_stiffness_at_the_automatic_step() {
    for (e, young) in [(0.05, 2e5), (0.1, 5e5), (0.2, 5e5), (0.4, 5e5), (0.1, 5e7), (0.9, 5e6)] {
        let (height, kinetic) = settled(e, young, Step::Auto);
        assert!(kinetic < 1e-5, "e = {e}, E = {young:e}: kinetic energy {kinetic:e} N m g d");
        assert!(height > 2.0 * RADIUS, "{height}");
    }
}

#[test]
fn step_does_not_change_how_a_strongly_damped_bed_lies() {
    let (fine, _) = settled(0.2, 5e5, Step::Seconds(1e-5));
    let (auto, _) = settled(0.2, 5e5, Step::Auto);
    // Beds settle into other packings: the heights of ten beds scatter by 0.7 %.
    assert!((auto / fine - 1.0).abs() < 0.02, "{auto:e} {fine:e}");
}
