//! Bits that are the same for any number of threads and across a checkpoint; momentum.

use crate::common::{RADIUS, grain, lattice, material, mesh_floor, run, setup};
use amberfield_core::{Boundary, Domain, Particles, Vector3};
use amberfield_dem::{ElectricEnergy, Setup, Simulation, State};
use proptest::prelude::*;

/// More than two chunks of grains that fall on a triangulated floor in a box that is periodic sideways.
fn bed() -> Setup {
    let half = 14.0 * RADIUS;
    let top = 40.0 * RADIUS;
    let grains = lattice([-half, -half, 0.0], [half, half, 34.0 * RADIUS], 2.1 * RADIUS, 0.2, 1);
    assert!(grains.len() > 2048, "{}", grains.len());
    let mut scene = setup(grains, material(0.7, 0.4, 0.05), 5e-6);
    let mut faces = [[Boundary::Periodic; 2]; 3];
    faces[2] = [Boundary::Open; 2];
    scene.domain = Domain::new(Vector3::new(-half, -half, -RADIUS), Vector3::new(half, half, top), faces)
        .expect("a good scene");
    scene.walls = vec![mesh_floor(20.0 * RADIUS, 9)];
    scene.time.gravity_m_s2 = Vector3::new(0.5, 0.0, -9.81);
    scene
}

fn bits(particles: &Particles) -> Vec<u64> {
    particles
        .position
        .iter()
        .chain(&particles.velocity)
        .chain(&particles.angular_velocity)
        .flat_map(|v| v.iter().map(|x| x.to_bits()))
        .collect()
}

fn run_with(threads: usize, steps: u64) -> Vec<u64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a good scene");
    pool.install(|| {
        let mut simulation = Simulation::new(bed()).expect("a good scene");
        run(&mut simulation, steps);
        bits(&simulation.particles())
    })
}

#[test]
fn one_two_and_three_threads_give_the_same_bits() {
    let one = run_with(1, 600);
    assert!(one == run_with(2, 600));
    assert!(one == run_with(3, 600));
}

#[test]
fn resumed_run_gives_the_same_bits() {
    let mut whole = Simulation::new(bed()).unwrap();
    run(&mut whole, 500);
    let bytes = bincode::serde::encode_to_vec(whole.state(), bincode::config::standard()).unwrap();
    run(&mut whole, 500);
    assert!(whole.contacts() > 200, "{}", whole.contacts());
    let (state, _): (State, usize) =
        bincode::serde::decode_from_slice(&bytes, bincode::config::standard()).unwrap();
    assert_eq!(state.step_index(), 500);
    let mut resumed = Simulation::resume(bed(), state).unwrap();
    run(&mut resumed, 500);
    assert!(bits(&whole.particles()) == bits(&resumed.particles()));
    assert_eq!(whole.contacts(), resumed.contacts());
    assert!(
        whole.energies(ElectricEnergy::LeftOut).unwrap()
            == resumed.energies(ElectricEnergy::LeftOut).unwrap()
    );
}

#[test]
fn state_of_another_scene_is_refused() {
    let simulation = Simulation::new(bed()).unwrap();
    let other = setup(vec![grain(1, [0.0; 3], [0.0; 3])], material(0.7, 0.4, 0.05), 1e-6);
    let error = Simulation::resume(other, simulation.state()).unwrap_err();
    assert!(error.to_string().contains("does not fit the scene"), "{error}");
}

#[test]
fn output_keeps_the_order_of_the_input() {
    let scene = bed();
    let ids = scene.particles.id.clone();
    let mut simulation = Simulation::new(scene).unwrap();
    run(&mut simulation, 200);
    assert_eq!(simulation.particles().id, ids);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Contact forces are equal and opposite: linear momentum stays to round-off, with history and rolling.
    #[test]
    fn momentum_is_conserved(
        seed in 0_u64..1000, friction in 0.0..0.8_f64, rolling in 0.0..0.2_f64, e in 0.3..1.0_f64
    ) {
        let half = 6.0 * RADIUS;
        let grains = lattice([-half; 3], [half; 3], 2.2 * RADIUS, 0.5, seed);
        let mut scene = setup(grains, material(e, friction, rolling), 5e-6);
        let faces = [[Boundary::Periodic; 2]; 3];
        scene.domain = Domain::new(Vector3::repeat(-half), Vector3::repeat(half), faces).unwrap();
        let mut simulation = Simulation::new(scene).unwrap();
        let momentum = |p: &Particles| (0..p.len()).map(|i| p.velocity[i] * p.mass(i)).sum::<Vector3<f64>>();
        let p = simulation.particles();
        let scale: f64 = (0..p.len()).map(|i| p.velocity[i].norm() * p.mass(i)).sum();
        let before = momentum(&simulation.particles());
        run(&mut simulation, 300);
        let after = momentum(&simulation.particles());
        // Round-off of 300 steps.
        prop_assert!((after - before).norm() < 1e-12 * scale, "{} {}", (after - before).norm(), scale);
    }
}
