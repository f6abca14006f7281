//! Allocations: none in a step between two rebuilds, none for a field that is not there.

#[expect(dead_code, reason = "the other tests use all of it")]
mod common;

use amberfield_core::{Boundary, Domain, Vector3};
use amberfield_dem::{Setup, Simulation};
use common::{RADIUS, lattice, material, mesh_floor, run, setup};
use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

struct Counting;

static ALLOCATIONS: AtomicU64 = AtomicU64::new(0);
static BYTES: AtomicU64 = AtomicU64::new(0);
/// Held by the test that counts.
static TURN: Mutex<()> = Mutex::new(());

// SAFETY: every call is handed to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.fetch_add(1, Ordering::Relaxed);
        BYTES.fetch_add(layout.size() as u64, Ordering::Relaxed);
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

/// Runs a body on one thread (rayon's own queues may grow) while no other test allocates.
fn alone(body: impl FnOnce() + Send) {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool of one thread").install(body);
}

/// Allocations and their bytes in a body.
fn counted(body: impl FnOnce()) -> (u64, u64) {
    let before = (ALLOCATIONS.load(Ordering::Relaxed), BYTES.load(Ordering::Relaxed));
    body();
    (ALLOCATIONS.load(Ordering::Relaxed) - before.0, BYTES.load(Ordering::Relaxed) - before.1)
}

/// Grains that fall on a floor of triangles in a box that is periodic in x and y, `top` its face at z max.
fn bed(top: Boundary) -> Setup {
    let half = 12.0 * RADIUS;
    let grains = lattice([-half, -half, 0.0], [half, half, 20.0 * RADIUS], 2.05 * RADIUS, 0.1, 5);
    let mut scene = setup(grains, material(0.6, 0.4, 0.05), 5e-6);
    let mut faces = [[Boundary::Periodic; 2]; 3];
    faces[2] = [top; 2];
    let (min, max) = (Vector3::new(-half, -half, -RADIUS), Vector3::new(half, half, 40.0 * RADIUS));
    scene.domain = Domain::new(min, max, faces).expect("a good box");
    scene.walls = vec![mesh_floor(half, 7)];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    scene
}

/// Steps of 200 in which nothing is allocated, after the beginning.
fn silent_steps(scene: Setup) -> (usize, Simulation) {
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, 500);
    let silent = (0..200).filter(|_| counted(|| run(&mut simulation, 1)).0 == 0).count();
    (silent, simulation)
}

#[test]
fn steady_step_allocates_nothing() {
    alone(|| {
        let (silent, simulation) = silent_steps(bed(Boundary::Open));
        // Steps with a rebuild may let a list grow; they are rare.
        assert!(silent >= 180, "{silent}");
        assert!(simulation.contacts() > 20, "{}", simulation.contacts());
    });
}

#[test]
fn steady_step_with_walls_that_move_allocates_nothing() {
    use amberfield_core::{MotionKind, WallMotion};
    alone(|| {
        let mut scene = bed(Boundary::Open);
        let whole = |kind| WallMotion { kind, start_s: 0.0, end_s: f64::INFINITY };
        let direction = Vector3::z();
        scene.walls[0].motion = vec![
            whole(MotionKind::Servo { force_n: 1e-4, direction, most_m_s: 1e-3 }),
            whole(MotionKind::Rotate { origin: Vector3::zeros(), axis: direction, turns_per_s: 0.1 }),
        ];
        let (silent, simulation) = silent_steps(scene);
        assert!(silent >= 180, "{silent}");
        assert!(simulation.wall_work().is_some_and(|work| work != 0.0));
    });
}

mod charged {
    use super::*;
    use amberfield_core::{ChargeTransfer, FieldSettings, Tuning};
    use amberfield_dem::FieldStageSetup;

    fn with_field(mut scene: Setup, charge: f64) -> Setup {
        let count = scene.particles.len();
        let settings = FieldSettings { tuning: Tuning::Model, ..FieldSettings::default() };
        scene.particles.charge = (0..count).map(|i| if i % 2 == 0 { charge } else { -charge }).collect();
        scene.field = Some(FieldStageSetup::new(settings, vec![true; count]));
        scene
    }

    #[test]
    fn steady_charged_step_allocates_nothing() {
        alone(|| {
            let (silent, simulation) = silent_steps(with_field(bed(Boundary::Grounded), 1e-12));
            assert!(silent >= 180, "{silent}");
            let intervals = simulation.intervals().expect("a field");
            assert!(intervals.evaluations > 10, "{intervals:?}");
        });
    }

    #[test]
    fn steady_step_with_potentials_that_change_allocates_nothing() {
        use amberfield_core::{Axis, Course, FaceCourse, Side};
        let course = Course::Sine { amplitude: 500.0, frequency_hz: 400.0, phase: 0.0, offset: 0.0 };
        for axis in [Axis::Z, Axis::X] {
            alone(|| {
                let mut scene = with_field(bed(Boundary::Grounded), 1e-12);
                let beside = Vector3::x() * RADIUS;
                let (min, max) = (scene.domain.min() - beside, scene.domain.max() + beside);
                let mut faces = *scene.domain.faces();
                faces[axis.index()] = [Boundary::Grounded; 2];
                let courses = vec![FaceCourse { axis, side: Side::Max, course: course.clone() }];
                let domain = Domain::new(min, max, faces).expect("a good box");
                scene.domain = domain.with_courses(courses);
                scene.field.as_mut().expect("a field").settings.external_course = Some(Course::Sine {
                    amplitude: Vector3::x(),
                    frequency_hz: 300.0,
                    phase: 0.0,
                    offset: Vector3::y(),
                });
                let (silent, simulation) = silent_steps(scene);
                assert!(silent >= 180, "{silent}");
                assert!(simulation.intervals().expect("a field").evaluations > 10);
            });
        }
    }

    #[test]
    fn steady_step_with_charge_transfer_allocates_nothing() {
        alone(|| {
            let mut scene = with_field(bed(Boundary::Grounded), 1e-12);
            scene.materials[0].work_function_ev = Some(4.5);
            let field = scene.field.as_mut().expect("a field");
            field.transfer = Some(ChargeTransfer::new(5e-7));
            let (silent, simulation) = silent_steps(scene);
            assert!(silent >= 180, "{silent}");
            assert!(simulation.ledger().expect("charging").moved > 0.0);
        });
    }

    #[test]
    fn field_that_is_not_needed_allocates_nothing() {
        /// Bytes of the plan's sentences.
        const TEXT: u64 = 500;
        alone(|| {
            let bytes = |scene: Setup| {
                counted(|| {
                    let mut simulation = Simulation::new(scene).expect("a good scene");
                    run(&mut simulation, 100);
                })
                .1
            };
            // The first run of a process also pays for what threads set up once.
            bytes(bed(Boundary::Grounded));
            let plain = bytes(bed(Boundary::Grounded));
            let without_charge = bytes(with_field(bed(Boundary::Grounded), 0.0));
            let charged = bytes(with_field(bed(Boundary::Grounded), 1e-12));
            assert!(without_charge.abs_diff(plain) < TEXT, "{without_charge} {plain}");
            assert!(charged > 2 * plain, "{charged} {plain}: the comparison would say nothing");
        });
    }
}
