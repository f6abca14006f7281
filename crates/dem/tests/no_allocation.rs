//! A step between two rebuilds allocates nothing.

mod common;

use amberfield_core::{Boundary, Domain, Vector3};
use amberfield_dem::Simulation;
use common::{RADIUS, lattice, material, mesh_floor, run, setup};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};

struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);

// SAFETY: every call is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        // SAFETY: same contract as this function's.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: same contract as this function's.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

#[test]
fn steady_step_allocates_nothing() {
    let half = 12.0 * RADIUS;
    let grains = lattice([-half, -half, 0.0], [half, half, 20.0 * RADIUS], 2.05 * RADIUS, 0.1, 5);
    let mut scene = setup(grains, material(0.6, 0.4, 0.05), 5e-6);
    let mut faces = [[Boundary::Periodic; 2]; 3];
    faces[2] = [Boundary::Open; 2];
    scene.domain =
        Domain::new(Vector3::new(-half, -half, -RADIUS), Vector3::new(half, half, 1.0), faces).unwrap();
    scene.walls = vec![mesh_floor(half, 7)];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    // One thread: rayon's own queues may grow.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| {
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 500);
        let counts: Vec<u64> = (0..200)
            .map(|_| {
                let before = ALLOCATIONS.load(Ordering::Relaxed);
                run(&mut simulation, 1);
                ALLOCATIONS.load(Ordering::Relaxed) - before
            })
            .collect();
        let silent = counts.iter().filter(|&&n| n == 0).count();
        // Steps with a rebuild may let a list grow; they are rare.
        assert!(silent >= 180, "{counts:?}");
        assert!(simulation.contacts() > 20, "{}", simulation.contacts());
    });
}
