//! Walls that move: what they do to grains, their work, and that lists and checkpoints follow them.

use crate::common::{RADIUS, grain, lattice, mass, material, mesh_floor, run, setup};
use amberfield_core::{
    Boundary, Domain, MotionKind, MotionRow, TriangleMesh, Vector3, Wall, WallMotion, WallShape,
};
use amberfield_dem::{DemError, ElectricEnergy, Setup, Simulation};

const G: f64 = 9.81;

fn ground() -> Wall {
    crate::common::wall(WallShape::Plane { point: Vector3::zeros(), normal: Vector3::z() })
}

fn moved(wall: Wall, kinds: Vec<MotionKind>) -> Wall {
    let whole = |kind| WallMotion { kind, start_s: 0.0, end_s: f64::INFINITY };
    Wall { motion: kinds.into_iter().map(whole).collect(), ..wall }
}

fn rotate(origin: [f64; 3], axis: Vector3<f64>, turns_per_s: f64) -> MotionKind {
    MotionKind::Rotate { origin: origin.into(), axis, turns_per_s }
}

fn vibrate(height: f64, frequency_hz: f64) -> MotionKind {
    MotionKind::Vibrate { amplitude: Vector3::new(0.0, 0.0, height), frequency_hz, phase: 0.0 }
}

fn table(velocity: Vector3<f64>) -> MotionKind {
    let rotation = Vector3::zeros();
    let row = |time_s: f64| MotionRow { time_s, displacement: velocity * time_s, rotation };
    MotionKind::Table { origin: Vector3::zeros(), rows: [0.0, 0.5, 1.0, 2.0].map(row).to_vec() }
}

/// Some grains that fall onto a floor.
fn bed(walls: Vec<Wall>, step_s: f64) -> Setup {
    let grains = lattice([-6e-3, -6e-3, 0.0], [6e-3, 6e-3, 9e-3], 2.4e-3, 0.1, 3);
    let mut scene = setup(grains, material(0.7, 0.4, 0.05), step_s);
    scene.walls = walls;
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -G);
    scene
}

fn start(scene: Setup) -> Simulation {
    Simulation::new(scene).expect("a good scene")
}

#[test]
fn wall_that_moves_with_velocity_zero_is_a_wall_at_rest_bit_for_bit() {
    let zero = Vector3::zeros();
    let row = |time_s: f64| MotionRow { time_s, displacement: zero, rotation: zero };
    let kinds = [
        MotionKind::Translate(zero),
        MotionKind::Slide(zero),
        rotate([0.3, 0.2, 0.1], Vector3::y(), 0.0),
        MotionKind::Vibrate { amplitude: zero, frequency_hz: 50.0, phase: 0.3 },
        MotionKind::Table { origin: Vector3::repeat(0.7), rows: vec![row(0.0), row(1.0)] },
    ];
    for wall in [ground, || mesh_floor(0.02, 7)] {
        let mut rest = start(bed(vec![wall()], 5e-6));
        run(&mut rest, 5000);
        assert!(rest.contacts() > 5);
        for kind in kinds.clone() {
            let mut moving = start(bed(vec![moved(wall(), vec![kind.clone()])], 5e-6));
            run(&mut moving, 5000);
            assert_eq!(moving.particles(), rest.particles(), "{kind:?}");
            assert_eq!(moving.wall_work(), Some(0.0), "{kind:?}");
            assert_eq!(moving.wall_loads(), rest.wall_loads(), "{kind:?}");
        }
    }
}

#[test]
fn lists_follow_a_wall_that_hits_grains_and_throws_them_ahead() {
    // A plate that goes at u hits a grain at rest, without loss: it leaves at 2u. The grain lies far off.
    let u = 0.5;
    let plate = |kind| moved(mesh_floor(0.02, 3), vec![kind]);
    for kind in [MotionKind::Translate(Vector3::z() * u), table(Vector3::z() * u)] {
        let mut scene = setup(vec![grain(1, [0.0, 0.0, 0.02], [0.0; 3])], material(1.0, 0.0, 0.0), 1e-6);
        scene.walls = vec![plate(kind.clone())];
        let mut simulation = start(scene);
        run(&mut simulation, 45_000);
        let speed = simulation.particles().velocity[0].z;
        assert!((speed / (2.0 * u) - 1.0).abs() < 1e-4, "{kind:?}: {speed}");
        let gained = 0.5 * mass(RADIUS) * speed * speed;
        let work = simulation.wall_work().expect("a wall moves");
        assert!((work / gained - 1.0).abs() < 1e-4, "{kind:?}: {work:e} J for {gained:e} J");
    }
}

#[test]
fn ball_on_a_belt_slips_and_rolls_and_a_belt_is_a_plate_that_translates() {
    let (u, friction) = (0.2, 0.3);
    let ride = |wall: Wall, steps: u64| {
        let weight = mass(RADIUS) * G;
        let young = 1e7 / (2.0 * (1.0 - 0.25 * 0.25));
        let overlap = (weight / (4.0 / 3.0 * young * RADIUS.sqrt())).powf(2.0 / 3.0);
        let ball = grain(1, [0.0, 0.0, RADIUS - overlap], [0.0; 3]);
        let mut scene = setup(vec![ball], material(0.5, friction, 0.0), 2e-6);
        scene.walls = vec![wall];
        scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -G);
        let mut simulation = start(scene);
        run(&mut simulation, steps);
        simulation.particles().grain(0)
    };
    let belt = || moved(mesh_floor(0.2, 40), vec![MotionKind::Slide(Vector3::new(u, 0.0, 0.0))]);
    let plate = || moved(mesh_floor(0.2, 40), vec![MotionKind::Translate(Vector3::new(u, 0.0, 0.0))]);
    // It slips for 2u/(7μg), and gains speed at μg until then.
    let slips = 2.0 * u / (7.0 * friction * G);
    let half = (0.5 * slips / 2e-6).round() as u64;
    let speed = ride(belt(), half).velocity.x;
    assert!((speed / (friction * G * half as f64 * 2e-6) - 1.0).abs() < 2e-3, "{speed}");
    let after = (2.0 * slips / 2e-6).round() as u64;
    let (on_belt, on_plate) = (ride(belt(), after), ride(plate(), after));
    assert!((on_belt.velocity.x / (2.0 / 7.0 * u) - 1.0).abs() < 2e-3, "{}", on_belt.velocity.x);
    let apart = (on_belt.position - on_plate.position).norm() / RADIUS;
    assert!(apart < 1e-6, "{apart:e}");
}

#[test]
fn grain_rides_on_a_turntable_and_its_spring_turns_with_it() {
    let (turns, radius, friction) = (2.0, 0.02, 0.5);
    let omega = std::f64::consts::TAU * turns;
    assert!(omega * omega * radius < friction * G);
    let mut rider = grain(1, [radius, 0.0, RADIUS * (1.0 - 1e-5)], [0.0, omega * radius, 0.0]);
    rider.angular_velocity = Vector3::z() * omega;
    // Rolling friction holds the ball, as a block would stand.
    let mut scene = setup(vec![rider], material(0.5, friction, 10.0), 2e-6);
    scene.walls = vec![moved(mesh_floor(0.05, 4), vec![rotate([0.0; 3], Vector3::z(), turns)])];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -G);
    let mut simulation = start(scene);
    let mut steps = 0;
    for _ in 0..5 {
        run(&mut simulation, 25_000);
        steps += 25_000;
        let place = simulation.particles().position[0];
        let angle = omega * 2e-6 * f64::from(steps);
        let known = Vector3::new(angle.cos(), angle.sin(), 0.0) * radius;
        let apart = (place - known).xy().norm() / RADIUS;
        assert!(apart < 0.02, "after {steps} steps: {apart}");
    }
}

#[test]
fn drum_that_has_turned_once_is_where_it_was() {
    let mesh = |turned: bool| {
        let mut scene = bed(vec![mesh_floor(0.02, 3)], 5e-6);
        let mut motion = moved(mesh_floor(0.02, 3), vec![rotate([0.0; 3], Vector3::x(), 500.0)]).motion;
        motion[0].end_s = 2e-3;
        scene.walls[0].motion = if turned { motion } else { Vec::new() };
        // Nobody is near while it turns.
        scene.particles.position.iter_mut().for_each(|x| x.z += 0.025);
        let mut simulation = start(scene);
        run(&mut simulation, 16_000);
        assert!(simulation.particles().velocity.iter().any(|v| v.z > 0.0), "nobody has bounced");
        simulation.particles()
    };
    assert_eq!(mesh(true), mesh(false));
}

/// Energy that a grain has too much or too little after jumps on a plate that shakes [J].
fn misses(step_s: f64) -> f64 {
    let mut scene = setup(vec![grain(1, [0.0, 0.0, 1.5e-3], [0.0; 3])], material(1.0, 0.0, 0.0), step_s);
    scene.walls = vec![moved(ground(), vec![vibrate(2e-4, 37.0)])];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -G);
    let mut simulation = start(scene);
    let sum = |simulation: &mut Simulation| {
        let energies = simulation.energies(ElectricEnergy::LeftOut).expect("no field");
        energies.kinetic + energies.contact + energies.gravity - simulation.wall_work().expect("it moves")
    };
    let before = sum(&mut simulation);
    run(&mut simulation, (0.06 / step_s).round() as u64);
    let work = simulation.wall_work().expect("it moves").abs();
    assert!(work > 1e-8, "{work:e}");
    (sum(&mut simulation) - before).abs()
}

#[test]
fn energy_closes_with_the_work_of_walls_to_second_order() {
    let [coarse, fine] = [4e-6, 2e-6].map(misses);
    let order = (coarse / fine).log2();
    assert!(order > 1.5, "{coarse:e} J, {fine:e} J: order {order}");
}

#[test]
fn run_that_goes_on_is_the_one_that_was_not_stopped() {
    let scene = || {
        let press = MotionKind::Servo { force_n: 2e-3, direction: -Vector3::z(), most_m_s: 0.2 };
        let lid = WallShape::Plane { point: Vector3::new(0.0, 0.0, 0.012), normal: -Vector3::z() };
        let spin = rotate([1e-3, 0.0, 0.0], Vector3::z(), 3.0);
        bed(
            vec![
                moved(mesh_floor(0.02, 5), vec![vibrate(1e-4, 200.0), spin]),
                moved(crate::common::wall(lid), vec![press]),
            ],
            5e-6,
        )
    };
    let mut whole = start(scene());
    run(&mut whole, 4000);
    let state = whole.state();
    let mut again = Simulation::resume(scene(), state.clone()).expect("its own state");
    assert_eq!(again.state(), state);
    run(&mut whole, 3000);
    run(&mut again, 3000);
    assert_eq!(again.particles(), whole.particles());
    assert_eq!(again.state(), whole.state());
}

#[test]
fn servo_presses_a_bed_with_its_force() {
    let force_n = 5e-3;
    let press = MotionKind::Servo { force_n, direction: -Vector3::z(), most_m_s: 0.1 };
    let lid = WallShape::Plane { point: Vector3::new(0.0, 0.0, 0.012), normal: -Vector3::z() };
    let side =
        |normal: Vector3<f64>| crate::common::wall(WallShape::Plane { point: normal * -6.1e-3, normal });
    let mut walls = vec![ground(), moved(crate::common::wall(lid), vec![press])];
    walls.extend([Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y()].map(side));
    let mut simulation = start(bed(walls, 1e-5));
    run(&mut simulation, 30_000);
    let mut mean = 0.0;
    for _ in 0..1000 {
        run(&mut simulation, 1);
        mean += simulation.wall_loads().expect("walls")[1].normal.z / 1000.0;
    }
    assert!((mean / force_n - 1.0).abs() < 0.02, "{mean:e} N");
}

#[test]
fn plate_goes_round_a_periodic_box_with_its_rider() {
    let faces = [[Boundary::Periodic; 2], [Boundary::Periodic; 2], [Boundary::Open; 2]];
    let half = 6e-3;
    let box_of = || Domain::new(Vector3::repeat(-half), Vector3::repeat(half), faces).expect("a good box");
    let ride = |u: Vector3<f64>| {
        let mut rider = grain(1, [1e-3, 2e-3, RADIUS * (1.0 - 1e-5)], u.into());
        rider.angular_velocity = Vector3::zeros();
        let mut scene = setup(vec![rider], material(0.5, 0.3, 0.0), 2e-6);
        scene.domain = box_of();
        scene.walls = vec![moved(mesh_floor(half, 3), vec![MotionKind::Translate(u)])];
        scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -G);
        let mut simulation = start(scene);
        run(&mut simulation, 60_000);
        let place = simulation.particles().position[0] - u * 0.12;
        (box_of().wrap(place), simulation.wall_loads().expect("a wall")[0].normal.z)
    };
    let (known, load) = ride(Vector3::zeros());
    assert!((load + mass(RADIUS) * G).abs() < 1e-3 * mass(RADIUS) * G, "{load:e}");
    let (found, load) = ride(Vector3::new(0.31, -0.17, 0.0));
    let apart = box_of().shortest(found - known).norm() / RADIUS;
    assert!(apart < 1e-6, "{apart:e}");
    assert!((load + mass(RADIUS) * G).abs() < 1e-3 * mass(RADIUS) * G, "{load:e}");
}

#[test]
fn scene_in_a_frame_that_moves_is_the_same() {
    let fly = |u: Vector3<f64>| {
        let mut scene = bed(vec![moved(mesh_floor(0.02, 5), vec![MotionKind::Translate(u)])], 5e-6);
        scene.particles.velocity.iter_mut().for_each(|v| *v += u);
        let mut simulation = start(scene);
        run(&mut simulation, 4000);
        let shift = u * simulation.time_s();
        simulation.particles().position.iter().map(|x| x - shift).collect::<Vec<_>>()
    };
    let (known, found) = (fly(Vector3::zeros()), fly(Vector3::new(0.7, -1.1, 0.4)));
    let apart = known.iter().zip(&found).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / RADIUS;
    assert!(apart < 1e-6, "{apart:e}");
}

#[test]
fn rotation_carries_a_mesh_as_turned_vertices_would() {
    // A paddle that swept by a third of a turn and stopped is one that stands there.
    let angle: f64 = std::f64::consts::TAU / 3.0;
    let paddle = |turned: bool| {
        let at = |radius: f64, z: f64| {
            let angle = if turned { angle } else { 0.0 };
            Vector3::new(radius * angle.cos(), radius * angle.sin(), z)
        };
        let vertices = vec![at(1e-3, 0.0), at(0.02, 0.0), at(0.02, 0.02), at(1e-3, 0.02)];
        crate::common::wall(WallShape::Mesh(TriangleMesh { vertices, triangles: vec![[0, 1, 2], [0, 2, 3]] }))
    };
    let hit = |turned: bool| {
        let mut swept = moved(paddle(false), vec![rotate([0.0; 3], Vector3::z(), 10.0)]);
        swept.motion[0].end_s = 1.0 / 30.0;
        let start_at = [-0.02, -2e-3, 5e-3];
        let mut scene = setup(vec![grain(1, start_at, [0.1, 0.2, 0.0])], material(0.8, 0.3, 0.0), 2e-6);
        scene.walls = vec![if turned { paddle(true) } else { swept }];
        let mut simulation = start(scene);
        run(&mut simulation, 100_000);
        simulation.particles().grain(0)
    };
    let (known, found) = (hit(true), hit(false));
    assert!(known.velocity.x != 0.1, "it must hit");
    assert!((known.position - found.position).norm() / RADIUS < 1e-6);
}

#[test]
fn motions_that_cannot_be_followed_are_refused() {
    let refused = |wall: Wall, step_s: f64| match Simulation::new(bed(vec![wall], step_s)) {
        Err(error) => error,
        Ok(_) => panic!("it must be refused"),
    };
    let fast = moved(ground(), vec![MotionKind::Translate(-Vector3::z() * 200.0)]);
    assert!(matches!(refused(fast, 5e-6), DemError::Unstable { guard: "wall motion", .. }));
    let spun = moved(mesh_floor(0.02, 2), vec![rotate([0.0; 3], Vector3::z(), 1e4)]);
    assert!(matches!(refused(spun, 5e-6), DemError::Unstable { guard: "wall motion", .. }));
    let mut backwards = moved(ground(), vec![MotionKind::Translate(Vector3::z())]);
    (backwards.motion[0].start_s, backwards.motion[0].end_s) = (1.0, 0.5);
    assert!(refused(backwards, 5e-6).to_string().contains("ends before it begins"));
    let row = |time_s| MotionRow { time_s, displacement: Vector3::zeros(), rotation: Vector3::zeros() };
    let rows = vec![row(0.0), row(0.0)];
    let flat = moved(ground(), vec![MotionKind::Table { origin: Vector3::zeros(), rows }]);
    assert!(refused(flat, 5e-6).to_string().contains("times that rise"));
    // Where it begins, it stands in grains.
    let row = |time_s| MotionRow { displacement: Vector3::z() * 2e-3, ..row(time_s) };
    let rows = vec![row(0.0), row(1.0)];
    let inside = moved(ground(), vec![MotionKind::Table { origin: Vector3::zeros(), rows }]);
    assert!(matches!(refused(inside, 5e-6), DemError::Overlap { .. }));
}
