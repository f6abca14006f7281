//! Grains that stick: pull-off, zero-load contacts, work of a cycle, walls, charge and resumption.

use crate::common::{RADIUS, floor, grain, mass, material, mesh_floor, run, setup};
use amberfield_core::{
    Boundary, ChargeTransfer, Cohesion, FieldSettings, ForceLimit, Grain, Material, MaterialId, MaterialPair,
    Method, Vector3, WallCharging,
};
use amberfield_dem::{ElectricEnergy, FieldStageSetup, Setup, Simulation};
use amberfield_laws::{dmt, hertz_mindlin, jkr};

/// Surface energy [J/m²]; large, as grains are.
const GAMMA: f64 = 0.2;
const WORK: f64 = 2.0 * GAMMA;
const STEP: f64 = 2e-7;

fn sticky(restitution: f64, friction: f64, rolling_friction: f64) -> Material {
    Material { surface_energy_j_m2: GAMMA, ..material(restitution, friction, rolling_friction) }
}

fn young(stuff: &Material) -> f64 {
    hertz_mindlin::effective_young(stuff.young_pa, stuff.poisson, stuff.young_pa, stuff.poisson)
}

/// Two grains, or with `on_wall` one above a floor, that meet at a speed.
fn meeting(cohesion: Cohesion, on_wall: bool, restitution: f64, speed: f64) -> Setup {
    let gap = 1e-9 * RADIUS;
    let grains = if on_wall {
        vec![grain(1, [0.0, 0.0, RADIUS + gap], [0.0, 0.0, -speed])]
    } else {
        let half = RADIUS + 0.5 * gap;
        vec![
            grain(1, [0.0, 0.0, half], [0.0, 0.0, -0.5 * speed]),
            grain(2, [0.0, 0.0, -half], [0.0, 0.0, 0.5 * speed]),
        ]
    };
    let mut scene = setup(grains, sticky(restitution, 0.0, 0.0), STEP);
    scene.cohesion = cohesion;
    if on_wall {
        scene.walls.push(floor());
    }
    scene
}

/// R* and m* of the two cases.
fn reduced(on_wall: bool) -> (f64, f64) {
    if on_wall { (RADIUS, mass(RADIUS)) } else { (0.5 * RADIUS, 0.5 * mass(RADIUS)) }
}

/// Overlap of the contact [m], and speed at which it closes [m/s].
fn contact(simulation: &Simulation) -> (f64, f64) {
    let grains = simulation.particles();
    if grains.len() == 1 {
        return (RADIUS - grains.position[0].z, -grains.velocity[0].z);
    }
    let distance = grains.position[0].z - grains.position[1].z;
    (2.0 * RADIUS - distance, grains.velocity[1].z - grains.velocity[0].z)
}

#[test]
fn largest_pull_is_the_pull_off_force() {
    let young = young(&sticky(1.0, 0.0, 0.0));
    for on_wall in [false, true] {
        let (radius, mass) = reduced(on_wall);
        let fast = 3.0 * jkr::sticking_speed(WORK, radius, young, mass);
        for (cohesion, expected) in
            [(Cohesion::Jkr, jkr::pull_off(WORK, radius)), (Cohesion::Dmt, dmt::pull_off(WORK, radius))]
        {
            let mut simulation = Simulation::new(meeting(cohesion, on_wall, 1.0, fast)).unwrap();
            let (mut largest, mut before) = (0.0_f64, contact(&simulation).1);
            for _ in 0..20_000 {
                run(&mut simulation, 1);
                let speed = contact(&simulation).1;
                largest = largest.max(mass * (speed - before) / STEP);
                before = speed;
            }
            assert_eq!(simulation.contacts(), 0, "they part");
            // The change of a step is that of the mean of two forces.
            assert!(
                (largest / expected - 1.0).abs() < 1e-3,
                "{cohesion:?} {on_wall}: {largest:e} {expected:e}"
            );
        }
    }
}

#[test]
fn contact_without_load_has_the_closed_radius() {
    for on_wall in [false, true] {
        let scene = meeting(Cohesion::Jkr, on_wall, 0.1, 1e-3);
        let young = young(&scene.materials[0]);
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 60_000);
        let (radius, _) = reduced(on_wall);
        let contact_radius = jkr::contact_radius_of_load(0.0, WORK, radius, young);
        // δ₀ = a₀²/(3R*)
        let expected = contact_radius.powi(2) / (3.0 * radius);
        let (overlap, _) = contact(&simulation);
        assert!((overlap / expected - 1.0).abs() < 1e-3, "{on_wall}: {overlap:e} {expected:e}");
    }
}

#[test]
fn elastic_grains_lose_the_work_of_a_cycle_and_energy_closes() {
    let young = young(&sticky(1.0, 0.0, 0.0));
    for on_wall in [false, true] {
        let (radius, mass) = reduced(on_wall);
        let stick = jkr::sticking_speed(WORK, radius, young, mass);
        for (cohesion, factor, leaves) in [
            (Cohesion::Jkr, 0.98, false),
            (Cohesion::Jkr, 1.02, true),
            (Cohesion::Jkr, 2.0, true),
            (Cohesion::Dmt, 0.5, true),
        ] {
            let speed = factor * stick;
            let mut simulation = Simulation::new(meeting(cohesion, on_wall, 1.0, speed)).unwrap();
            let begin = simulation.energies(ElectricEnergy::LeftOut).unwrap();
            for _ in 0..400 {
                run(&mut simulation, 100);
                let now = simulation.energies(ElectricEnergy::LeftOut).unwrap();
                if simulation.contacts() > 0 {
                    let error = (now.kinetic + now.contact) / begin.kinetic - 1.0;
                    assert!(error.abs() < 2e-2, "{cohesion:?} {factor}: {error:e}");
                }
            }
            assert_eq!(simulation.contacts() == 0, leaves, "{cohesion:?} {factor} {on_wall}");
            if leaves {
                let lost = if cohesion == Cohesion::Jkr { stick * stick } else { 0.0 };
                let expected = (speed * speed - lost).sqrt();
                let out = -contact(&simulation).1;
                assert!((out / expected - 1.0).abs() < 4e-2, "{cohesion:?} {factor}: {out:e} {expected:e}");
            }
        }
    }
}

#[test]
fn step_that_passes_over_the_stretch_is_refused() {
    let mut scene = meeting(Cohesion::Jkr, false, 1.0, 1.0);
    scene.time.step = amberfield_core::Step::Seconds(3e-5);
    let error = Simulation::new(scene).unwrap_err().to_string();
    assert!(error.contains("pull-off limit"), "{error}");
}

#[test]
fn triangles_of_a_floor_do_not_matter() {
    let at = |walls| {
        let mut scene = meeting(Cohesion::Jkr, true, 0.5, 0.05);
        scene.walls = vec![walls];
        scene.particles.position[0] += Vector3::new(1e-4, 1.3e-4, 0.0);
        scene.particles.velocity[0].x = 0.03;
        scene.materials[0].friction = 0.4;
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 30_000);
        simulation.particles()
    };
    let (plane, mesh) = (at(floor()), at(mesh_floor(2e-2, 41)));
    assert!((plane.position[0] - mesh.position[0]).norm() < 1e-9 * RADIUS);
}

#[test]
fn charge_moves_over_the_area_of_the_contact_that_sticks() {
    /// Charge that a grain and a wall exchange [C], and the largest overlap [m].
    fn impact(cohesion: Cohesion) -> (f64, f64) {
        let mut scene = meeting(cohesion, true, 1.0, 0.05);
        let stuff = Material { work_function_ev: Some(4.5), ..scene.materials[0].clone() };
        scene.materials = vec![stuff.clone(), Material { work_function_ev: Some(4.6), ..stuff }];
        scene.walls[0].material = MaterialId(1);
        scene.walls[0].charging = WallCharging::Grounded;
        let settings = FieldSettings {
            method: Method::Direct,
            force_limit: Some(ForceLimit { factor: 0.0 }),
            ..FieldSettings::default()
        };
        let field = FieldStageSetup {
            transfer: Some(ChargeTransfer::new(5e-7)),
            ..FieldStageSetup::new(settings, vec![true])
        };
        scene.field = Some(field);
        let mut simulation = Simulation::new(scene).unwrap();
        let mut deepest = 0.0_f64;
        for _ in 0..1_500 {
            run(&mut simulation, 1);
            deepest = deepest.max(contact(&simulation).0);
        }
        (simulation.particles().charge[0], deepest)
    }
    let ((plain, overlap), (sticky, overlap_jkr)) = (impact(Cohesion::None), impact(Cohesion::Jkr));
    let scale = jkr::Scale::new(WORK, RADIUS, young(&crate::common::material(1.0, 0.0, 0.0)));
    let area_jkr = scale.radius(scale.root(overlap_jkr)).powi(2);
    let expected = area_jkr / (RADIUS * overlap);
    assert!(expected > 1.1, "{expected}");
    assert!((sticky / plain / expected - 1.0).abs() < 1e-2, "{} {expected}", sticky / plain);
}

#[test]
fn values_of_a_pair_replace_mixed_ones_in_any_order() {
    let rebound = |between: Option<[u16; 2]>| {
        let mut scene = meeting(Cohesion::None, false, 0.9, 0.1);
        scene.materials.push(Material { name: "steel".into(), ..material(0.9, 0.0, 0.0) });
        scene.particles.material[1] = MaterialId(1);
        scene.pairs.extend(between.map(|ids| MaterialPair {
            between: ids.map(MaterialId),
            restitution: Some(0.5),
            ..MaterialPair::default()
        }));
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 5_000);
        -contact(&simulation).1 / 0.1
    };
    assert!((rebound(None) - 0.9).abs() < 1e-3);
    assert!((rebound(Some([0, 1])) - 0.5).abs() < 1e-3);
    assert_eq!(rebound(Some([0, 1])), rebound(Some([1, 0])));
    assert_eq!(rebound(Some([0, 0])), rebound(None));
}

#[test]
fn work_of_a_pair_is_twice_its_surface_energy() {
    let largest = |energy: f64| {
        let mut scene = meeting(Cohesion::Dmt, false, 1.0, 0.05);
        scene.materials[0].surface_energy_j_m2 = 0.0;
        scene.pairs.push(MaterialPair { surface_energy_j_m2: Some(energy), ..MaterialPair::default() });
        let mut simulation = Simulation::new(scene).unwrap();
        let (mut largest, mut before) = (0.0_f64, 0.05);
        for _ in 0..10_000 {
            run(&mut simulation, 1);
            let speed = contact(&simulation).1;
            (largest, before) = (largest.max(0.5 * mass(RADIUS) * (speed - before) / STEP), speed);
        }
        largest
    };
    assert!((largest(GAMMA) / dmt::pull_off(WORK, 0.5 * RADIUS) - 1.0).abs() < 1e-3);
    assert!(largest(0.0) < 1e-12);
}

#[test]
fn bad_pairs_are_refused() {
    for (pair, text) in [
        (MaterialPair { between: [MaterialId(0), MaterialId(7)], ..MaterialPair::default() }, "unknown"),
        (MaterialPair { friction: Some(-1.0), ..MaterialPair::default() }, "friction"),
        (MaterialPair { restitution: Some(0.0), ..MaterialPair::default() }, "restitution"),
    ] {
        let mut scene = meeting(Cohesion::None, false, 1.0, 0.0);
        scene.pairs.push(pair);
        let error = Simulation::new(scene).unwrap_err().to_string();
        assert!(error.contains(text), "{error}");
    }
    let mut scene = meeting(Cohesion::None, false, 1.0, 0.0);
    scene.pairs = vec![MaterialPair { friction: Some(0.1), ..MaterialPair::default() }; 2];
    assert!(Simulation::new(scene).unwrap_err().to_string().contains("twice"));
}

/// A periodic box of sticky grains that clump, over a floor.
fn clump(cohesion: Cohesion) -> Setup {
    let side = 1.2e-2;
    let at = |number: u64| -side + 2.4e-3 * (0.5 + number as f64);
    let speed = |number: u64, factor: f64| 0.2 * (number as f64 * factor).fract() - 0.1;
    let grains = (0..1000).map(|number| {
        let position = [number % 10, number / 10 % 10, number / 100].map(at);
        let velocity = [0.618, 0.414, 0.303].map(|factor| speed(number, factor));
        let radius = if number % 3 == 0 { 0.7 * RADIUS } else { RADIUS };
        Grain { radius, ..grain(number, position, velocity) }
    });
    let mut scene = setup(grains.collect(), sticky(0.5, 0.4, 0.05), 2e-6);
    scene.cohesion = cohesion;
    let faces = [[Boundary::Periodic; 2], [Boundary::Periodic; 2], [Boundary::Open; 2]];
    let (low, high) = (Vector3::new(-side, -side, -side), Vector3::new(side, side, 2.0 * side));
    scene.domain = amberfield_core::Domain::new(low, high, faces).expect("a good box");
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut bottom = floor();
    bottom.shape = amberfield_core::WallShape::Plane { point: low, normal: Vector3::z() };
    scene.walls.push(bottom);
    scene
}

#[test]
fn resumed_run_is_the_one_that_was_not_stopped_for_any_threads() {
    for cohesion in [Cohesion::Jkr, Cohesion::Dmt] {
        let whole = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let mut simulation = Simulation::new(clump(cohesion)).unwrap();
                run(&mut simulation, 3_000);
                simulation
            })
        };
        let (one, three) = (whole(1), whole(3));
        assert!(one.contacts() > 100, "{}", one.contacts());
        assert_eq!(one.state(), three.state());
        let mut first = Simulation::new(clump(cohesion)).unwrap();
        run(&mut first, 1_234);
        let mut second = Simulation::resume(clump(cohesion), first.state()).unwrap();
        assert_eq!(second.contacts(), first.contacts());
        run(&mut second, 3_000 - 1_234);
        assert_eq!(second.state(), one.state());
    }
}
