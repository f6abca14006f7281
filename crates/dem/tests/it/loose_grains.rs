//! Grains that came and have no list yet, since they are alone.

use crate::common::{RADIUS, material, mesh_floor};
use crate::feeds::{HALF, STEP, feed, feeds, high, scene};
use amberfield_core::{Domain, Grain, MotionKind, Particles, Vector3, Wall, WallMotion};
use amberfield_dem::Simulation;

/// Pairs that overlap, and grains that overlap a floor at a height [m], looked for one by one.
fn overlaps(domain: &Domain, particles: &Particles, floor: f64) -> usize {
    let (x, r) = (&particles.position, &particles.radius);
    let pairs = (0..r.len()).flat_map(|i| (0..i).map(move |j| [i, j]));
    let touching = pairs.filter(|&[i, j]| domain.shortest(x[i] - x[j]).norm() < r[i] + r[j]).count();
    touching + (0..r.len()).filter(|&i| (x[i].z - floor).abs() < r[i]).count()
}

#[test]
fn no_contact_of_grains_that_came_is_missed() {
    // Grains of all sizes rain slowly into a swarm, catch up with each other and meet a floor that comes up.
    let scattered = |k: usize, grain: &mut Grain| {
        let at = |n: usize| (((k + 1) * n) as f64 * 0.618_033_988_75).fract() - 0.5;
        grain.radius = RADIUS * [1.0, 0.6, 1.6, 0.7, 0.8][k % 5];
        grain.velocity = Vector3::new(2.0 * at(3), 2.0 * at(7), -1.0 + 1.5 * at(11));
    };
    for (every, rise) in [(7.0, 0.0), (7.0, 0.7), (50.0, 0.0), (50.0, 0.7)] {
        let rain = feeds(vec![feed("a", high())], (2000.0 / every) as usize, every * STEP, scattered);
        let mut scene = scene(rain, material(0.9, 0.3, 0.0));
        scene.time.allow_unstable = true;
        let kind = MotionKind::Translate(Vector3::new(0.0, 0.0, rise));
        let motion = vec![WallMotion { kind, start_s: 0.0, end_s: f64::INFINITY }];
        scene.walls = vec![Wall { motion, ..mesh_floor(2.0 * HALF, 5) }];
        let domain = scene.domain.clone();
        let mut run = Simulation::new(scene).unwrap();
        let mut sum = 0;
        for step in 0..2000 {
            run.step().unwrap();
            let found = overlaps(&domain, &run.particles(), rise * run.time_s());
            assert_eq!(run.contacts(), found, "every {every} steps, rise {rise} m/s, step {step}");
            sum += found;
        }
        assert!(sum > 200, "{sum} contacts are too few");
    }
}
