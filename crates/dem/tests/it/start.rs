//! Scenes that are refused at the start, and grains that leave.

use crate::common::{RADIUS, domain, floor, grain, material, run, setup};
use amberfield_core::{Boundary, OnExit, Step, Vector3};
use amberfield_dem::{DemError, Simulation};

fn two(distance: f64) -> amberfield_dem::Setup {
    setup(
        vec![grain(7, [0.0; 3], [0.0; 3]), grain(9, [distance, 0.0, 0.0], [0.0; 3])],
        material(0.9, 0.3, 0.0),
        1e-6,
    )
}

#[test]
fn deep_overlap_is_refused_unless_allowed() {
    let error = Simulation::new(two(1.4 * RADIUS)).unwrap_err();
    assert!(matches!(error, DemError::Overlap { count: 1, id: 7, .. }), "{error}");
    assert!(error.to_string().contains("grain 7 and grain 9"), "{error}");
    let mut allowed = two(1.4 * RADIUS);
    allowed.time.allow_overlap = true;
    assert!(Simulation::new(allowed).is_ok());
    assert!(Simulation::new(two(1.989 * RADIUS)).is_err());
    assert!(Simulation::new(two(1.991 * RADIUS)).is_ok());
}

#[test]
fn coincident_centres_are_always_refused() {
    let mut scene = two(0.0);
    scene.time.allow_overlap = true;
    assert_eq!(Simulation::new(scene).unwrap_err(), DemError::Coincident { id_i: 7, id_j: 9 });
}

#[test]
fn grain_behind_a_wall_is_refused() {
    let mut scene = setup(vec![grain(3, [0.0, 0.0, -RADIUS], [0.0; 3])], material(0.9, 0.0, 0.0), 1e-6);
    scene.walls = vec![floor()];
    assert!(matches!(Simulation::new(scene).unwrap_err(), DemError::Overlap { id: 3, .. }));
}

#[test]
fn step_beyond_a_guard_is_refused_unless_allowed() {
    let scene = |allow| {
        let mut scene = two(3.0 * RADIUS);
        scene.time.step = Step::Seconds(1e-3);
        scene.time.allow_unstable = allow;
        scene
    };
    let error = Simulation::new(scene(false)).unwrap_err();
    assert!(matches!(error, DemError::Unstable { guard: "rayleigh", .. }), "{error}");
    assert!(Simulation::new(scene(true)).is_ok());
}

#[test]
fn automatic_step_is_a_fifth_of_the_tightest_guard() {
    let mut scene = two(3.0 * RADIUS);
    scene.time.step = Step::Auto;
    let simulation = Simulation::new(scene).unwrap();
    let margin = simulation.guards().iter().map(|g| g.margin).fold(f64::INFINITY, f64::min);
    assert!((margin - 5.0).abs() < 1e-9, "{:?}", simulation.guards());
}

#[test]
fn speeding_grain_breaks_the_guard_while_running() {
    let mut scene = setup(vec![grain(1, [0.0; 3], [0.0; 3])], material(0.9, 0.0, 0.0), 5e-5);
    scene.domain = domain(1e6, Boundary::Open);
    scene.time.gravity_m_s2 = Vector3::new(1e7, 0.0, 0.0);
    let mut simulation = Simulation::new(scene).unwrap();
    let error = (0..10_000).find_map(|_| simulation.step().err()).unwrap();
    assert!(matches!(error, DemError::Unstable { guard: "hertz" | "travel", .. }), "{error}");
}

#[test]
fn short_periodic_box_is_refused() {
    let mut scene = setup(vec![grain(1, [0.0; 3], [0.0; 3])], material(0.9, 0.0, 0.0), 1e-6);
    scene.domain = domain(1.9 * RADIUS, Boundary::Periodic);
    let text = Simulation::new(scene).unwrap_err().to_string();
    assert!(text.contains("periodic axis x"), "{text}");
}

#[test]
fn duplicate_ids_and_bad_values_are_refused() {
    let mut scene = two(3.0 * RADIUS);
    scene.particles.id[1] = 7;
    assert!(Simulation::new(scene).unwrap_err().to_string().contains("id 7 is used twice"));
    let mut scene = two(3.0 * RADIUS);
    scene.particles.radius[0] = f64::NAN;
    assert!(Simulation::new(scene).unwrap_err().to_string().contains("grain 7: radius"));
    let mut scene = two(3.0 * RADIUS);
    scene.materials[0].restitution = 1.5;
    assert!(Simulation::new(scene).unwrap_err().to_string().contains("restitution must be in (0, 1]"));
    let mut scene = two(3.0 * RADIUS);
    scene.particles.position[0].x = 2.0;
    assert!(Simulation::new(scene).unwrap_err().to_string().contains("grain 7 is outside the domain"));
}

#[test]
fn leaving_grain_stops_the_run_or_is_removed() {
    let scene = |on_exit| {
        let mut scene = setup(
            vec![
                grain(4, [0.0, 0.0, 0.999], [0.0, 0.0, 1.0]),
                grain(5, [0.0, 0.0, -0.5], [0.0; 3]),
                grain(6, [0.0, 0.0, -0.5 + 1.99 * RADIUS], [0.0; 3]),
            ],
            material(0.9, 0.3, 0.0),
            1e-5,
        );
        scene.time.on_exit = on_exit;
        scene
    };
    let mut simulation = Simulation::new(scene(OnExit::Stop)).unwrap();
    let error = (0..200).find_map(|_| simulation.step().err()).unwrap();
    let DemError::Left { id, face, .. } = &error else { panic!("{error}") };
    assert_eq!((*id, face.as_str()), (4, "z_max"));
    let mut simulation = Simulation::new(scene(OnExit::Delete)).unwrap();
    run(&mut simulation, 200);
    assert_eq!(simulation.particles().id, [5, 6]);
    assert!(simulation.particles().velocity[1].z > 0.0);
}

#[test]
fn outlook_without_a_start_is_that_of_the_run() {
    let mut scene = two(2.5 * RADIUS);
    scene.particles.velocity[1] = Vector3::new(0.3, 0.0, 0.0);
    scene.time.step = amberfield_core::Step::Auto;
    let alone = amberfield_dem::Outlook::of(&scene).expect("a good scene").expect("no field");
    let started = Simulation::new(scene).expect("a good scene").outlook();
    assert_eq!((alone.step_s, alone.skin_m), (started.step_s, started.skin_m));
    assert_eq!((alone.guards, alone.plan), (started.guards, started.plan));
    assert_eq!((alone.grains, alone.fastest_m_s), (2, started.fastest_m_s));
}
