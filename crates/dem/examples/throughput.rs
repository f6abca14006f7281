//! Particle-steps per second of plain DEM beds in a periodic box: `throughput [grains…]`, one line per volume
//! fraction with the wall-clock time of each stage. Run it with `--release` and `RAYON_NUM_THREADS=1`: the rate is
//! that of the main thread's processor time.

#![expect(clippy::print_stdout, reason = "a measuring program")]

use amberfield_core::{
    Boundary, Domain, Grain, GroupId, Material, MaterialId, OnExit, Particles, Skin, Step, TimeSettings,
    Vector3,
};
use amberfield_dem::{Setup, Simulation};
use rand::{RngExt, SeedableRng};
use std::time::Instant;

const RADIUS: f64 = 1e-3;
const DENSITY: f64 = 2500.0;

/// Grains at jittered lattice places in a periodic box of the given volume fraction; dense ones overlap.
fn setup(count: usize, fraction: f64) -> Setup {
    let volume = count as f64 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS.powi(3) / fraction;
    let length = volume.cbrt();
    let per_axis = (count as f64).cbrt().ceil() as usize;
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let spacing = length / per_axis as f64;
    let jitter = 0.3 * spacing;
    let particles: Particles = (0..count)
        .map(|k| {
            let cell = [k % per_axis, k / per_axis % per_axis, k / per_axis / per_axis];
            let at = |a: usize, r: f64| (cell[a] as f64 + 0.5) * spacing + jitter * r;
            let position = std::array::from_fn(|a| at(a, random.random_range(-1.0..1.0)));
            let velocity: [f64; 3] = std::array::from_fn(|_| random.random_range(-0.1..0.1));
            Grain {
                id: k as u64,
                position: Vector3::from(position),
                velocity: velocity.into(),
                angular_velocity: Vector3::zeros(),
                radius: RADIUS,
                density: DENSITY,
                charge: 0.0,
                material: MaterialId(0),
                group: GroupId(0),
            }
        })
        .collect();
    Setup {
        domain: Domain::new(Vector3::zeros(), Vector3::repeat(length), [[Boundary::Periodic; 2]; 3])
            .expect("positive extents"),
        materials: vec![Material {
            name: "glass".into(),
            density_kg_m3: DENSITY,
            young_pa: 1e7,
            young_real_pa: None,
            poisson: 0.25,
            restitution: 0.9,
            friction: 0.3,
            rolling_friction: 0.0,
            work_function_ev: None,
        }],
        particles,
        walls: Vec::new(),
        time: TimeSettings {
            step: Step::Seconds(8e-6),
            end_s: 1.0,
            gravity_m_s2: Vector3::zeros(),
            skin: Skin::Auto,
            allow_unstable: true,
            on_exit: OnExit::Stop,
            allow_overlap: true,
        },
        field: None,
    }
}

/// Relaxes overlaps with a dissipative material, then gives every grain a velocity again.
fn relaxed(count: usize, fraction: f64) -> Setup {
    let mut scene = setup(count, fraction);
    scene.materials[0].restitution = 0.05;
    for _ in 0..20 {
        let mut run = Simulation::new(scene.clone()).expect("overlaps are allowed");
        for _ in 0..200 {
            run.step().expect("periodic box");
        }
        scene.particles = run.particles();
        for v in &mut scene.particles.velocity {
            *v *= 0.1;
        }
    }
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(2);
    for v in &mut scene.particles.velocity {
        *v = Vector3::from_fn(|_, _| random.random_range(-0.1..0.1));
    }
    scene.materials[0].restitution = 0.9;
    scene
}

/// Seconds that the processor spent on this process (Linux; elsewhere the clock on the wall): other programs
/// on the machine disturb it less.
fn processor_seconds(start: Instant) -> f64 {
    std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok())
        .map_or_else(|| start.elapsed().as_secs_f64(), |nanoseconds| nanoseconds * 1e-9)
}

fn main() {
    let mut counts: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    if counts.is_empty() {
        counts = vec![10_000, 100_000];
    }
    for count in counts {
        for fraction in [0.1, 0.4, 0.6] {
            let mut run = Simulation::new(relaxed(count, fraction)).expect("overlaps are allowed");
            for _ in 0..100 {
                run.step().expect("periodic box");
            }
            let before = run.stage_seconds();
            let steps = (20_000_000 / count).max(50);
            let start = Instant::now();
            let begin = processor_seconds(start);
            for _ in 0..steps {
                run.step().expect("periodic box");
            }
            let seconds = processor_seconds(start) - begin;
            let rate = (steps * count) as f64 / seconds / 1e6;
            let contacts = run.contacts() as f64 / count as f64;
            print!("n {count:7}  vf {fraction}  {rate:6.2} M particle-steps/s  contacts {contacts:.2}  ");
            let per = 1e9 / (steps * count) as f64;
            for ((name, after), (_, before)) in run.stage_seconds().iter().zip(before) {
                print!("{name} {:.1} ns  ", (after - before) * per);
            }
            println!();
        }
    }
}
