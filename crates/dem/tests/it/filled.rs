//! Scenes that begin with the grains of another run: contacts go on where their rules are the same.

use crate::common::{RADIUS, floor, grain, lattice, material, run, setup, wall};
use amberfield_core::{
    Boundary, ContactRules, Domain, Grain, OnExit, Particles, RollingModel, Vector3, Wall, WallRule,
    WallShape,
};
use amberfield_dem::{DemError, Earlier, ElectricEnergy, Setup, Simulation};

/// Difference that sums in another order make within some hundred steps, over a radius.
const ROUND_OFF: f64 = 1e-9;
/// Difference by what a contact forgets, over a radius, at least.
const FORGOTTEN: f64 = 1e-6;
/// Relative difference of energies of the same springs.
const SAME_ENERGY: f64 = 1e-12;

fn rules(setup: &Setup) -> ContactRules {
    ContactRules {
        materials: setup.materials.clone(),
        pairs: setup.pairs.clone(),
        rolling_model: setup.rolling_model,
        cohesion: setup.cohesion,
        walls: setup.walls.iter().map(WallRule::of).collect(),
    }
}

/// Earlier run as another scene sees it: a simulation of a set-up.
fn earlier(before: &Setup, simulation: &Simulation, is_same: bool) -> Earlier {
    Earlier { state: simulation.state(), rules: rules(before), is_same }
}

/// Set-up with the grains of a simulation.
fn with_grains_of(simulation: &Simulation, setup: &Setup) -> Setup {
    Setup { particles: simulation.particles(), ..setup.clone() }
}

/// Heap of some layers that slides on a floor, in a box that is periodic sideways.
fn heap(restitution: f64) -> Setup {
    let half = 5.0 * RADIUS;
    let grains = lattice([-half, -half, 0.0], [half, half, 9.0 * RADIUS], 2.1 * RADIUS, 0.05, 5);
    let mut scene = setup(grains, material(restitution, 0.5, 0.1), 1e-5);
    let mut faces = [[Boundary::Periodic; 2]; 3];
    faces[2] = [Boundary::Open; 2];
    let corners = [Vector3::new(-half, -half, -RADIUS), Vector3::new(half, half, 40.0 * RADIUS)];
    scene.domain = Domain::new(corners[0], corners[1], faces).expect("a good scene");
    scene.walls = vec![floor()];
    scene.time.gravity_m_s2 = Vector3::new(2.0, 0.0, -9.81);
    scene
}

/// Largest way between the same grains, over a radius.
fn apart(domain: &Domain, one: &Particles, other: &Particles) -> f64 {
    assert_eq!(one.id, other.id);
    let extent = domain.extent();
    let way = |(a, b): (&Vector3<f64>, &Vector3<f64>)| {
        let mut way = a - b;
        for axis in 0..2 {
            way[axis] -= extent[axis] * (way[axis] / extent[axis]).round();
        }
        way.norm()
    };
    one.position.iter().zip(&other.position).map(way).fold(0.0, f64::max) / RADIUS
}

#[test]
fn run_in_two_scenes_equals_one_run_and_forgets_nothing() {
    // Without dashpots forces at the start are those of the last step, too.
    for (restitution, is_same) in [(0.6, true), (1.0, true), (1.0, false)] {
        let scene = Setup { rolling_model: RollingModel::Epsd2, ..heap(restitution) };
        let mut whole = Simulation::new(scene.clone()).expect("a good scene");
        run(&mut whole, 3000);
        assert!(whole.contacts() > 10, "{}", whole.contacts());
        let begin = with_grains_of(&whole, &scene);
        let filled = Simulation::filled(begin.clone(), earlier(&scene, &whole, is_same));
        let mut filled = filled.expect("a good scene");
        let mut begin = begin;
        begin.time.allow_overlap = true;
        let mut fresh = Simulation::new(begin).expect("a good scene");
        assert_eq!((filled.step_index(), filled.time_s()), (0, 0.0));
        [&mut whole, &mut filled, &mut fresh].into_iter().for_each(|simulation| run(simulation, 200));
        let [whole, filled, fresh] = [whole, filled, fresh].map(|simulation| simulation.particles());
        let [same, forgot] = [&filled, &fresh].map(|other| apart(&scene.domain, &whole, other));
        assert!(same < ROUND_OFF, "e = {restitution}, {is_same}: {same:e}");
        assert!(forgot > FORGOTTEN, "e = {restitution}: {forgot:e}");
    }
}

#[test]
fn sliding_grain_goes_on_bit_for_bit() {
    let mut one = grain(1, [0.0, 0.0, 0.999 * RADIUS], [0.1, 0.02, 0.0]);
    one.angular_velocity = Vector3::new(3.0, 20.0, -5.0);
    let mut scene = setup(vec![one], material(0.6, 0.3, 0.05), 1e-5);
    scene.walls = vec![floor()];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut whole = Simulation::new(scene.clone()).expect("a good scene");
    run(&mut whole, 777);
    let begin = with_grains_of(&whole, &scene);
    let mut filled = Simulation::filled(begin, earlier(&scene, &whole, true)).expect("a good scene");
    [&mut whole, &mut filled].into_iter().for_each(|simulation| run(simulation, 1000));
    assert!(whole.contacts() == 1);
    assert!(whole.particles() == filled.particles());
}

fn contact_energy(simulation: &mut Simulation) -> f64 {
    simulation.energies(ElectricEnergy::LeftOut).expect("energies").contact
}

/// A run from which a grain in the middle of the list leaves, with the energy of its contacts.
fn after_an_exit() -> (Setup, Simulation, f64) {
    let mut scene = heap(0.6);
    scene.time.on_exit = OnExit::Delete;
    let thrown = Grain { velocity: Vector3::new(0.0, 0.0, 20.0), ..scene.particles.grain(0) };
    let thrown = Grain { id: 9999, position: Vector3::new(0.0, 0.0, 38.0 * RADIUS), ..thrown };
    let grains: Vec<Grain> = (0..scene.particles.len()).map(|i| scene.particles.grain(i)).collect();
    let middle = grains.len() / 2;
    let grains = grains[..middle].iter().chain([&thrown]).chain(&grains[middle..]).copied();
    scene.particles = grains.collect();
    let mut simulation = Simulation::new(scene.clone()).expect("a good scene");
    run(&mut simulation, 3000);
    assert_eq!(simulation.len() + 1, scene.particles.len());
    let energy = contact_energy(&mut simulation);
    (scene, simulation, energy)
}

#[test]
fn springs_go_along_where_rules_are_the_same_and_begin_anew_elsewhere() {
    let (scene, simulation, before) = after_an_exit();
    let energy_in = |change: &dyn Fn(&mut Setup)| {
        let mut other = with_grains_of(&simulation, &scene);
        change(&mut other);
        let filled = Simulation::filled(other, earlier(&scene, &simulation, false));
        contact_energy(&mut filled.expect("a good scene"))
    };
    let is_same = |energy: f64| (energy / before - 1.0).abs() < SAME_ENERGY;
    let same = energy_in(&|_| {});
    assert!(is_same(same), "{same:e} {before:e}");
    // The rest of the scene does not matter: step, gravity, restitution, more materials, more walls.
    let other = energy_in(&|setup| {
        setup.time.gravity_m_s2 = Vector3::zeros();
        setup.time.step = amberfield_core::Step::Seconds(2e-6);
        setup.materials[0].restitution = 0.9;
        let first = amberfield_core::Material { name: "steel".into(), ..material(0.2, 0.9, 0.0) };
        setup.materials.insert(0, first);
        setup.particles.material.fill(amberfield_core::MaterialId(1));
        let lid = WallShape::Plane { point: 40.0 * RADIUS * Vector3::z(), normal: -Vector3::z() };
        let mut floor = floor();
        floor.material = amberfield_core::MaterialId(1);
        setup.walls = vec![wall(lid), Wall { name: "another name".into(), ..floor }];
    });
    assert!(is_same(other), "{other:e} {before:e}");
    // Normal springs follow from overlaps; the others are what is forgotten.
    let slippery = energy_in(&|setup| setup.materials[0].friction = 0.4);
    let lost = 1.0 - slippery / before;
    assert!((1e-4..0.5).contains(&lost), "{lost:e}");
    // A wall elsewhere is another one, the grains are the same.
    let deeper = WallShape::Plane { point: -1e-9 * RADIUS * Vector3::z(), normal: Vector3::z() };
    let moved = energy_in(&|setup| setup.walls = vec![wall(deeper.clone())]);
    assert!(moved < before * (1.0 - 1e-8) && moved > slippery, "{moved:e} {before:e} {slippery:e}");
}

#[test]
fn overlaps_of_the_run_are_allowed_and_new_ones_are_not() {
    let deep = [
        grain(1, [0.0, 0.0, 0.96 * RADIUS], [0.0; 3]),
        grain(2, [1.93 * RADIUS, 0.0, 0.95 * RADIUS], [0.0; 3]),
    ];
    let mut scene = setup(deep.to_vec(), material(0.6, 0.3, 0.0), 1e-6);
    scene.walls = vec![floor()];
    scene.time.allow_overlap = true;
    let simulation = Simulation::new(scene.clone()).expect("a good scene");
    let mut strict = with_grains_of(&simulation, &scene);
    strict.time.allow_overlap = false;
    assert!(matches!(Simulation::new(strict.clone()).unwrap_err(), DemError::Overlap { count: 3, .. }));
    let begin = |setup: Setup| Simulation::filled(setup, earlier(&scene, &simulation, false));
    let mut good = begin(strict.clone()).expect("the run had them");
    run(&mut good, 10);
    // A wall that was not there, next to one grain.
    let side = WallShape::Plane { point: -0.97 * RADIUS * Vector3::x(), normal: Vector3::x() };
    let mut new = strict.clone();
    new.walls.push(Wall { name: "side".into(), ..wall(side) });
    let error = begin(new).unwrap_err();
    assert!(matches!(error, DemError::Overlap { count: 1, id: 1, .. }), "{error}");
    assert!(error.to_string().contains("wall 'side'"), "{error}");
    // The same floor, nearer.
    let mut nearer = strict;
    let raised = WallShape::Plane { point: 0.01 * RADIUS * Vector3::z(), normal: Vector3::z() };
    nearer.walls = vec![wall(raised)];
    let error = begin(nearer).unwrap_err();
    assert!(matches!(error, DemError::Overlap { count: 2, id: 2, .. }), "{error}");
}

#[test]
fn grains_of_another_run_are_refused() {
    let scene = heap(0.6);
    let simulation = Simulation::new(scene.clone()).expect("a good scene");
    let mut other = scene.clone();
    other.particles = (1..scene.particles.len()).map(|i| scene.particles.grain(i)).collect();
    let error = Simulation::filled(other, earlier(&scene, &simulation, false)).unwrap_err();
    assert!(error.to_string().contains("not those of the set-up"), "{error}");
}
