//! Grains in a drum of 5000 triangles, at rest or turning: what the motion of walls costs. Count instructions
//! of both, in a release build:
//!
//! ```text
//! valgrind --tool=callgrind target/release/examples/drum rest
//! valgrind --tool=callgrind target/release/examples/drum turn
//! ```
//!
//! or time them with 10⁵ grains in a drum that is 2.6 times as large, for half of the steps:
//!
//! ```text
//! time target/release/examples/drum turn 2.6
//! ```

#![expect(clippy::print_stdout, reason = "a program of its own, whose lines are compared")]

#[expect(dead_code, reason = "the drum has grains and a box of its own")]
mod bed;

use amberfield_core::{
    Boundary, Domain, Grain, GroupId, MaterialId, MotionKind, OnExit, Skin, Step, TimeSettings, TriangleMesh,
    Vector3, Wall, WallCharging, WallMotion, WallShape,
};
use amberfield_dem::{Setup, Simulation};
use std::f64::consts::TAU;

/// Radius and half of the length of the small drum [m].
const DRUM: [f64; 2] = [0.03, 0.02];
/// Faces around and along; a face is two triangles.
const FACES: [u32; 2] = [125, 20];
/// Turns in a second.
const TURNS_PER_S: f64 = 0.5;
/// Distance of grains at the start [m].
const SPACING: f64 = 2.05 * bed::RADIUS;

/// Surface of a drum of a radius and half a length [m], about y.
fn surface([radius, half]: [f64; 2]) -> TriangleMesh {
    let at = |around: u32, along: u32| {
        let angle = TAU * f64::from(around) / f64::from(FACES[0]);
        let y = half * (2.0 * f64::from(along) / f64::from(FACES[1]) - 1.0);
        Vector3::new(radius * angle.sin(), y, -radius * angle.cos())
    };
    let places = (0..=FACES[1]).flat_map(|along| (0..FACES[0]).map(move |around| [around, along]));
    let vertices = places.map(|[around, along]| at(around, along)).collect();
    let number = |around: u32, along: u32| along * FACES[0] + around % FACES[0];
    let faces = (0..FACES[1]).flat_map(|along| (0..FACES[0]).map(move |around| [around, along]));
    let cut = |[i, j]: [u32; 2]| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    TriangleMesh { vertices, triangles: faces.flat_map(cut).collect() }
}

/// Grains that fill the lower half of a drum of a radius and half a length [m].
fn grains([drum, half]: [f64; 2]) -> Vec<Grain> {
    let range = |half: f64| {
        let count = (2.0 * half / SPACING) as i32;
        (0..count).map(move |k| (f64::from(k) + 0.5 - 0.5 * f64::from(count)) * SPACING)
    };
    let places = range(drum).flat_map(|x| range(half).map(move |y| [x, y]));
    let places = places.flat_map(|[x, y]| range(drum).map(move |z| Vector3::new(x, y, z)));
    let inside = |place: &Vector3<f64>| place.x.hypot(place.z) < drum - 1.02 * bed::RADIUS && place.z < 0.0;
    let grain = |(id, position): (usize, Vector3<f64>)| Grain {
        id: id as u64,
        position,
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
        radius: bed::RADIUS,
        density: 2500.0,
        charge: 0.0,
        material: MaterialId(0),
        group: GroupId(0),
    };
    places.filter(inside).enumerate().map(grain).collect()
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let turns = arguments.next().as_deref() == Some("turn");
    let factor = arguments.next().map(|word| word.parse::<f64>().expect("a number"));
    let steps = if factor.is_some() { 5 * bed::STEPS } else { 10 * bed::STEPS };
    let size = DRUM.map(|length| factor.unwrap_or(1.0) * length);
    let wall = |shape: WallShape, motion: Vec<WallMotion>| Wall {
        name: "drum".to_owned(),
        shape,
        material: MaterialId(0),
        charging: WallCharging::None,
        bounds_field: false,
        motion,
    };
    let kind = MotionKind::Rotate { origin: Vector3::zeros(), axis: Vector3::y(), turns_per_s: TURNS_PER_S };
    let turning = WallMotion { kind, start_s: 0.0, end_s: f64::INFINITY };
    let end = |normal: Vector3<f64>| wall(WallShape::Plane { point: normal * -size[1], normal }, Vec::new());
    let drum = wall(WallShape::Mesh(surface(size)), if turns { vec![turning] } else { Vec::new() });
    let setup = Setup {
        domain: Domain::new(
            Vector3::repeat(-1.3 * size[0]),
            Vector3::repeat(1.3 * size[0]),
            [[Boundary::Open; 2]; 3],
        )
        .expect("positive extents"),
        materials: bed::materials(),
        rolling_model: Default::default(),
        cohesion: Default::default(),
        pairs: Vec::new(),
        particles: grains(size).into_iter().collect(),
        walls: vec![drum, end(Vector3::y()), end(-Vector3::y())],
        time: TimeSettings {
            step: Step::Seconds(bed::STEP_S),
            end_s: 1.0,
            gravity_m_s2: Vector3::new(0.0, 0.0, -9.81),
            skin: Skin::Metres(bed::SKIN_M),
            allow_unstable: false,
            on_exit: OnExit::Stop,
            allow_overlap: false,
        },
        gas: None,
        field: None,
        feeds: Default::default(),
        outlets: Vec::new(),
    };
    let mut simulation = Simulation::new(setup).expect("a good scene");
    for _ in 0..steps {
        simulation.step().expect("nobody leaves");
    }
    println!("{} grains", simulation.len());
    bed::tell(simulation.contacts(), simulation.particles().velocity.into_iter());
}
