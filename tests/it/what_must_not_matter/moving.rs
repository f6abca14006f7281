//! Motions of walls that physics does not see, after which a grain moves as before: a line each.

use super::walls::common::{RADIUS, grain, material, run, setup};
use super::walls::{HALF, sheet};
use amberfield_core::{Grain, MotionKind, Vector3, Wall, WallMotion};
use amberfield_dem::Simulation;

/// A change of the floor's motion, and of the frame.
struct Line {
    name: &'static str,
    known: fn() -> Vec<WallMotion>,
    changed: fn() -> Vec<WallMotion>,
    /// Velocity of the frame in which the scene is seen [m/s].
    frame: [f64; 3],
    /// Difference of places over the radius.
    bound: f64,
}

/// Difference that other roundings make.
const ROUND_OFF: f64 = 1e-6;

fn of(kinds: Vec<MotionKind>) -> Vec<WallMotion> {
    kinds.into_iter().map(|kind| WallMotion { kind, start_s: 0.0, end_s: f64::INFINITY }).collect()
}

fn rotate(turns_per_s: f64, end_s: f64) -> WallMotion {
    let kind = MotionKind::Rotate { origin: Vector3::zeros(), axis: Vector3::z(), turns_per_s };
    WallMotion { kind, start_s: 0.0, end_s }
}

fn along(x: f64, y: f64) -> Vector3<f64> {
    Vector3::new(x, y, 0.0)
}

const LINES: [Line; 7] = [
    Line {
        name: "velocity zero",
        known: Vec::new,
        changed: || of(vec![MotionKind::Translate(Vector3::zeros())]),
        frame: [0.0; 3],
        bound: 0.0,
    },
    Line {
        name: "a motion that begins later",
        known: Vec::new,
        changed: || vec![WallMotion { start_s: 1.0, ..rotate(3.0, 2.0) }],
        frame: [0.0; 3],
        bound: 0.0,
    },
    Line {
        name: "a whole turn before anybody is there",
        known: Vec::new,
        changed: || vec![rotate(500.0, 2e-3)],
        frame: [0.0; 3],
        bound: 0.0,
    },
    Line {
        name: "a frame that moves",
        known: Vec::new,
        changed: || of(vec![MotionKind::Translate(Vector3::new(0.3, -0.2, 0.5))]),
        frame: [0.3, -0.2, 0.5],
        bound: ROUND_OFF,
    },
    Line {
        name: "a belt as a plate",
        known: || of(vec![MotionKind::Slide(along(0.2, -0.1))]),
        changed: || of(vec![MotionKind::Translate(along(0.2, -0.1))]),
        frame: [0.0; 3],
        bound: ROUND_OFF,
    },
    Line {
        name: "one motion in two parts",
        known: || of(vec![MotionKind::Translate(along(0.2, -0.1))]),
        changed: || of(vec![MotionKind::Translate(along(0.2, 0.0)), MotionKind::Translate(along(0.0, -0.1))]),
        frame: [0.0; 3],
        bound: ROUND_OFF,
    },
    Line {
        name: "a turn there and back",
        known: Vec::new,
        changed: || {
            let turn = |turns_per_s: f64| rotate(turns_per_s, f64::INFINITY);
            vec![turn(3.0), turn(-3.0)]
        },
        frame: [0.0; 3],
        bound: ROUND_OFF,
    },
];

/// Grain that bounces and slides over a floor, seen in a frame.
fn over(motion: Vec<WallMotion>, frame: [f64; 3]) -> Grain {
    let frame = Vector3::from(frame);
    let mut thrown = grain(1, [-4e-3, -2e-3, RADIUS * 1.2], [0.4, 0.2, -0.05]);
    thrown.velocity += frame;
    let mut scene = setup(vec![thrown], material(0.3, 0.4, 0.02), 2e-6);
    scene.walls = vec![Wall { motion, ..sheet(HALF, HALF, [7, 5]) }];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, 10_000);
    let mut found = simulation.particles().grain(0);
    found.position -= frame * simulation.time_s();
    found
}

#[test]
fn how_a_motion_is_told_does_not_matter() {
    for Line { name, known, changed, frame, bound } in &LINES {
        let (known, found) = (over(known(), [0.0; 3]), over(changed(), *frame));
        let apart = (found.position - known.position).norm() / RADIUS;
        assert!(apart <= *bound, "{name}: {apart:e}");
    }
}
