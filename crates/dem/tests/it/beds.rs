//! Many grains: a heap at rest, a 100:1 mixture.

use crate::common::{DENSITY, RADIUS, floor, grain, lattice, mass, material, run, setup};
use amberfield_core::{Boundary, Domain, Vector3};
use amberfield_dem::{ElectricEnergy, Simulation};

#[test]
fn heap_comes_to_rest_and_stays() {
    let half = 5.0 * RADIUS;
    let grains = lattice([-half, -half, 0.0], [half, half, 22.0 * RADIUS], 2.2 * RADIUS, 0.05, 3);
    let count = grains.len();
    let mut scene = setup(grains, material(0.5, 0.6, 0.2), 2e-5);
    scene.walls = vec![floor()];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    scene.domain =
        Domain::new(Vector3::new(-0.2, -0.2, -0.01), Vector3::repeat(0.2), [[Boundary::Open; 2]; 3]).unwrap();
    let mut simulation = Simulation::new(scene).unwrap();
    run(&mut simulation, 50_000);
    let settled = simulation.particles();
    // Energy to lift a grain by its own radius: the scale on which a heap can still move.
    let lift = mass(RADIUS) * 9.81 * RADIUS;
    let kinetic =
        |s: &mut Simulation| s.energies(ElectricEnergy::LeftOut).unwrap().kinetic / count as f64 / lift;
    let early = kinetic(&mut simulation);
    run(&mut simulation, 25_000);
    let late = kinetic(&mut simulation);
    assert!(late < 1e-9, "kinetic energy per grain over m g r: {early:e}, then {late:e}");
    let after = simulation.particles();
    let creep = (0..count).map(|i| (after.position[i] - settled.position[i]).norm()).fold(0.0, f64::max);
    assert!(creep < 1e-3 * RADIUS, "creep {creep:e}");
    // A heap, not a layer: some grains rest on others, and its slope is that of a pile.
    let top = after.position.iter().map(|p| p.z).fold(0.0, f64::max);
    let (x, y) = after.position.iter().fold((0.0, 0.0), |(x, y), p| (x + p.x, y + p.y));
    let (x, y) = (x / count as f64, y / count as f64);
    let mut spread: Vec<f64> = after.position.iter().map(|p| (p.x - x).hypot(p.y - y)).collect();
    spread.sort_unstable_by(f64::total_cmp);
    let angle = (top / spread[count * 9 / 10]).atan().to_degrees();
    assert!(top > 3.0 * RADIUS && angle > 10.0, "top {:.1} r, angle {angle:.1}°", top / RADIUS);
}

#[test]
fn hundred_to_one_mixture_settles_without_overlap() {
    let big = 20.0 * RADIUS;
    let small = big / 100.0;
    let mut grains = Vec::new();
    for k in 0..4 {
        let mut g = grain(k, [big * 2.2 * (k as f64 - 1.5), 0.0, big], [0.0; 3]);
        g.radius = big;
        grains.push(g);
    }
    for k in 0..2000_u64 {
        let (x, y) = (k % 50, k / 50);
        let position = [
            -3.0 * big + 6.0 * big * x as f64 / 50.0,
            -big + 2.0 * big * y as f64 / 40.0,
            2.0 * big + 3.0 * small,
        ];
        let mut g = grain(100 + k, position, [0.0, 0.0, -1.0]);
        g.radius = small;
        grains.push(g);
    }
    let mut scene = setup(grains, material(0.5, 0.4, 0.01), 2e-6);
    scene.walls = vec![floor()];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).unwrap();
    assert!(simulation.plan().stages().iter().any(|e| e.reason.contains("2 level(s)")));
    // The skin follows the small grains.
    assert!((simulation.skin_m() - 0.2 * small).abs() < 1e-12);
    run(&mut simulation, 10_000);
    let p = simulation.particles();
    let mut touched = 0;
    for i in 4..p.len() {
        for j in 0..4 {
            let gap = (p.position[i] - p.position[j]).norm() - p.radius[i] - p.radius[j];
            assert!(gap > -0.2 * small, "grain {} sank into {}: {gap:e}", p.id[i], p.id[j]);
        }
        touched += usize::from(p.velocity[i].z > -0.9);
    }
    assert!(touched > 100, "{touched}");
    assert!((p.mass(0) / (mass(RADIUS) * 8000.0) - 1.0).abs() < 1e-12 && p.density[0] == DENSITY);
}
