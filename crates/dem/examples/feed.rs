//! Grains that lie on a floor, with a feed of 10⁴ grains a second above them or without: what a feed costs.
//! Count instructions of both, in a release build:
//!
//! ```text
//! valgrind --tool=callgrind target/release/examples/feed without
//! valgrind --tool=callgrind target/release/examples/feed with
//! ```

#[expect(dead_code, reason = "the bed has grains and a box of its own")]
mod bed;

use amberfield_core::{
    Boundary, Domain, Feed, FeedRegion, Feeds, Grain, GroupId, MaterialId, OnBlocked, OnExit, Particles,
    Skin, Step, TimeSettings, Vector3, Volume, Wall, WallCharging, WallShape,
};
use amberfield_dem::{Setup, Simulation};

/// Grains along each axis.
const GRAINS: [usize; 3] = [22, 22, 21];
/// Grains that come [1/s], and their speed [m/s].
const RATE: f64 = 1e4;
const SPEED: f64 = 0.5;

fn grain(id: usize, position: Vector3<f64>, velocity: Vector3<f64>) -> Grain {
    Grain {
        id: id as u64,
        position,
        velocity,
        angular_velocity: Vector3::zeros(),
        radius: bed::RADIUS,
        density: 2500.0,
        charge: 0.0,
        material: MaterialId(0),
        group: GroupId(0),
    }
}

/// Columns of grains that touch.
fn heap() -> Particles {
    let [nx, ny, nz] = GRAINS;
    let place = |k: usize| {
        let cell = [k % nx, k / nx % ny, k / nx / ny];
        Vector3::from(cell.map(|at| (2 * at + 1) as f64 * bed::RADIUS))
    };
    (0..nx * ny * nz).map(|k| grain(k, place(k), Vector3::zeros())).collect()
}

/// A feed all over the box, above the heap.
fn feeds(domain: &Domain) -> Feeds {
    let above = Vector3::new(0.0, 0.0, 0.5 * domain.max().z);
    let velocity = Vector3::new(0.0, 0.0, -SPEED);
    let count = (RATE * bed::STEP_S * bed::STEPS as f64) as usize;
    Feeds {
        list: vec![Feed {
            name: "rain".to_owned(),
            region: FeedRegion::Volume(Volume::Box { min: domain.min() + above, max: domain.max() }),
            velocity,
            on_blocked: OnBlocked::Stop,
            seed: 1,
        }],
        grains: (0..count).map(|k| grain(1_000_000 + k, Vector3::zeros(), velocity)).collect(),
        due_s: (0..count).map(|k| k as f64 / RATE).collect(),
        feed: vec![0; count],
    }
}

fn main() {
    let is_fed = std::env::args().nth(1).as_deref() == Some("with");
    let [nx, ny, nz] = GRAINS.map(|count| 2.0 * count as f64 * bed::RADIUS);
    let faces = [[Boundary::Periodic; 2], [Boundary::Periodic; 2], [Boundary::Open; 2]];
    let domain =
        Domain::new(Vector3::zeros(), Vector3::new(nx, ny, 4.0 * nz), faces).expect("positive extents");
    let floor = Wall {
        name: "floor".to_owned(),
        shape: WallShape::Plane { point: Vector3::zeros(), normal: Vector3::z() },
        material: MaterialId(0),
        charging: WallCharging::None,
        bounds_field: false,
        motion: Vec::new(),
    };
    let setup = Setup {
        materials: bed::materials(),
        rolling_model: Default::default(),
        cohesion: Default::default(),
        pairs: Vec::new(),
        particles: heap(),
        walls: vec![floor],
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
        feeds: if is_fed { feeds(&domain) } else { Feeds::default() },
        outlets: Vec::new(),
        domain,
    };
    let mut simulation = Simulation::new(setup).expect("a good scene");
    for _ in 0..bed::STEPS {
        simulation.step().expect("nobody leaves");
    }
    bed::tell(simulation.contacts(), simulation.particles().velocity.into_iter());
}
