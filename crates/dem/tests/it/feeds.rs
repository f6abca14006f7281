//! Grains that come while a run goes on: where they appear, how many, and the books about them.

use crate::common::{RADIUS, floor, grain, material, mesh_floor, run, setup};
use amberfield_core::{
    Boundary, ChargeTransfer, CouplingInterval, Domain, Feed, FeedRegion, Feeds, FieldSettings, Grain,
    Material, MaterialId, Method, MotionKind, OnBlocked, OnExit, Particles, TriangleMesh, Vector3, Volume,
    Wall, WallCharging, WallMotion,
};
use amberfield_dem::{Book, FieldStageSetup, Setup, Simulation, State, Tally};
use proptest::prelude::*;

/// Half the width of the region of feeds [m].
pub(crate) const HALF: f64 = 8.0 * RADIUS;
pub(crate) const STEP: f64 = 2e-5;

pub(crate) fn high() -> FeedRegion {
    let (z, thick) = (40.0 * RADIUS, 4.0 * RADIUS);
    FeedRegion::Volume(Volume::Box {
        min: Vector3::new(-HALF, -HALF, z),
        max: Vector3::new(HALF, HALF, z + thick),
    })
}

pub(crate) fn feed(name: &str, region: FeedRegion) -> Feed {
    Feed {
        name: name.into(),
        region,
        velocity: Vector3::new(0.0, 0.0, -1.0),
        on_blocked: OnBlocked::Wait,
        seed: 7,
    }
}

/// Grains of two sizes, due one every `every` [s], of feeds that take turns.
pub(crate) fn feeds(list: Vec<Feed>, count: usize, every: f64, change: impl Fn(usize, &mut Grain)) -> Feeds {
    let number = list.len();
    let one = |k: usize| {
        let mut grain = grain(1000 + k as u64, [0.0; 3], [0.0, 0.0, -1.0]);
        grain.radius = if k.is_multiple_of(3) { RADIUS } else { 0.7 * RADIUS };
        grain.velocity = list[k % number].velocity;
        change(k, &mut grain);
        grain
    };
    Feeds {
        grains: (0..count).map(one).collect(),
        due_s: (0..count).map(|k| k as f64 * every).collect(),
        feed: (0..count).map(|k| (k % number) as u16).collect(),
        list,
    }
}

/// Two grains on a floor, in a box that is periodic sideways, into which feeds let more.
pub(crate) fn scene(feeds: Feeds, stuff: Material) -> Setup {
    let mut scene = setup(vec![grain(1, [0.0, 0.0, RADIUS], [0.0; 3])], stuff, STEP);
    let mut faces = [[Boundary::Periodic; 2]; 3];
    faces[2] = [Boundary::Open; 2];
    let (min, max) = (Vector3::new(-HALF, -HALF, -RADIUS), Vector3::new(HALF, HALF, 60.0 * RADIUS));
    scene.domain = Domain::new(min, max, faces).expect("a good box");
    scene.walls = vec![floor()];
    scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
    scene.time.on_exit = OnExit::Delete;
    scene.feeds = feeds;
    scene
}

fn bits(particles: &Particles) -> Vec<u64> {
    let vectors = particles.position.iter().chain(&particles.velocity).chain(&particles.angular_velocity);
    let numbers = vectors.flat_map(|v| v.iter().copied().collect::<Vec<_>>()).chain(particles.charge.clone());
    particles.id.iter().copied().chain(numbers.map(f64::to_bits)).collect()
}

fn with_threads<T: Send>(threads: usize, run: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads").install(run)
}

/// Charges and charge transfer for a scene, all grains members.
pub(crate) fn charged(mut scene: Setup, transfer: Option<ChargeTransfer>) -> Setup {
    let members = vec![true; scene.particles.len() + scene.feeds.grains.len()];
    let settings = FieldSettings { method: Method::Direct, ..FieldSettings::default() };
    scene.domain =
        Domain::new(scene.domain.min(), scene.domain.max(), [[Boundary::Open; 2]; 3]).expect("a good box");
    scene.field = Some(FieldStageSetup { transfer, ..FieldStageSetup::new(settings, members) });
    scene
}

#[test]
fn grains_come_as_they_are_due_and_touch_nothing() {
    let every = 3.3 * STEP;
    let mut run = Simulation::new(scene(
        feeds(vec![feed("a", high())], 400, every, |_, _| {}),
        material(0.7, 0.3, 0.0),
    ))
    .unwrap();
    assert_eq!(run.len(), 1);
    for step in 1..=1000_u64 {
        let before = run.len();
        run.step().unwrap();
        let come = run.len() - before;
        let due = ((step - 1) as f64 * STEP / every) as usize + 1;
        // Looked at every ten steps.
        let fed = run.feeds()[0].fed.grains as usize;
        assert!(fed <= due && fed + 4 > due.min(400), "{fed} of {due} in step {step}");
        if come > 0 {
            let p = run.particles();
            for i in p.len() - come..p.len() {
                let r = p.radius[i];
                assert!((0..2).all(|a| p.position[i][a].abs() <= HALF - r), "{}", p.position[i]);
                for j in 0..i {
                    let apart = (p.position[i] - p.position[j]).norm();
                    assert!(apart > r + p.radius[j], "grains {i} and {j} at step {step}");
                }
            }
        }
    }
    let account = &run.feeds()[0];
    assert!(account.owed.grains == 0 && account.fed.grains > 290, "{account:?}");
}

#[test]
fn grains_come_clear_of_a_wall_that_moves_through_their_region() {
    let mut scene =
        scene(feeds(vec![feed("a", high())], 600, 1.7 * STEP, |_, _| {}), material(0.7, 0.3, 0.0));
    let (speed, kind) = (2.0, MotionKind::Translate(Vector3::new(0.0, 0.0, 2.0)));
    let motion = vec![WallMotion { kind, start_s: 0.0, end_s: f64::INFINITY }];
    scene.walls = vec![Wall { motion, ..mesh_floor(2.0 * HALF, 5) }];
    let mut run = Simulation::new(scene).unwrap();
    let mut near = f64::INFINITY;
    for _ in 0..1100 {
        let before = run.feeds()[0].fed.grains;
        run.step().unwrap();
        let come = (run.feeds()[0].fed.grains - before) as usize;
        let p = run.particles();
        for i in p.len() - come..p.len() {
            let off = (p.position[i].z - speed * run.time_s()).abs() - p.radius[i];
            assert!(off > 0.0, "{off} at {} s", run.time_s());
            near = near.min(off);
        }
    }
    assert!(near < 0.5 * RADIUS, "{near}: the wall came through");
}

#[test]
fn a_grain_falls_from_where_it_came_as_a_free_one() {
    let one = feeds(vec![feed("a", high())], 1, 1.0, |_, _| {});
    let mut simulation = Simulation::new(scene(one, material(1.0, 0.0, 0.0))).unwrap();
    run(&mut simulation, 1);
    let start = simulation.particles().grain(1);
    assert_eq!(start.velocity, Vector3::new(0.0, 0.0, -1.0));
    run(&mut simulation, 500);
    let (end, t) = (simulation.particles().grain(1), 500.0 * STEP);
    let expected = start.position.z - t - 0.5 * 9.81 * t * t;
    assert!((end.position.z - expected).abs() < 1e-12, "{} {expected}", end.position.z);
    assert!((end.velocity.z + 1.0 + 9.81 * t).abs() < 1e-12, "{}", end.velocity.z);
}

#[test]
fn threads_checkpoints_and_a_later_end_change_no_bit() {
    let make = |count: usize| {
        let list = vec![feed("a", high()), Feed { seed: 9, ..feed("b", high()) }];
        let charge =
            |k: usize, grain: &mut Grain| grain.charge = if k.is_multiple_of(2) { 2e-12 } else { -1e-12 };
        charged(scene(feeds(list, count, 2.0 * STEP, charge), work(0.3)), Some(ChargeTransfer::new(5e-7)))
    };
    let whole = |threads: usize| {
        with_threads(threads, || {
            let mut simulation = Simulation::new(make(400)).unwrap();
            run(&mut simulation, 1500);
            (bits(&simulation.particles()), simulation.feeds())
        })
    };
    let one = whole(1);
    assert!(one.1.iter().map(|feed| feed.fed.grains).sum::<u64>() > 300, "{:?}", one.1);
    assert!(one == whole(3));
    for (stop, count) in [(437, 400), (438, 230), (650, 400)] {
        // A run that ends earlier knows only the grains that are due until then.
        let mut simulation = Simulation::new(make(count)).unwrap();
        run(&mut simulation, stop);
        let bytes = bincode::serde::encode_to_vec(simulation.state(), bincode::config::standard()).unwrap();
        let (state, _): (State, usize) =
            bincode::serde::decode_from_slice(&bytes, bincode::config::standard()).unwrap();
        let mut resumed = Simulation::resume(make(400), state).unwrap();
        run(&mut resumed, 1500 - stop);
        assert!(one == (bits(&resumed.particles()), resumed.feeds()), "stopped at {stop}");
    }
}

/// Material with a work function.
fn work(friction: f64) -> Material {
    Material { work_function_ev: Some(4.5), ..material(0.6, friction, 0.0) }
}

#[test]
fn a_full_region_is_owed_in_its_order_or_ends_the_run() {
    // Nothing moves the grains out of the region, so that it fills.
    let still = |on_blocked| {
        let mut full = feed("full", high());
        (full.velocity, full.on_blocked) = (Vector3::zeros(), on_blocked);
        let mut scene = scene(feeds(vec![full], 4000, 1e-2 * STEP, |_, _| {}), material(0.7, 0.0, 0.0));
        scene.time.gravity_m_s2 = Vector3::zeros();
        scene
    };
    let mut waits = Simulation::new(still(OnBlocked::Wait)).unwrap();
    run(&mut waits, 60);
    let account = waits.feeds().remove(0);
    assert!(account.owed.grains > 1000 && account.fed.grains > 60, "{account:?}");
    assert_eq!(account.owed.grains + account.fed.grains, 4000);
    let come = waits.particles();
    assert!((1..come.len()).all(|i| come.id[i] == 999 + i as u64), "they come in their order");
    let mut stops = Simulation::new(still(OnBlocked::Stop)).unwrap();
    let error = (0..60).find_map(|_| stops.step().err()).expect("it is full");
    assert!(error.to_string().contains("feed \"full\" finds no place for grain"), "{error}");
}

#[test]
fn feeds_that_can_never_do_what_they_shall_are_refused() {
    let refused = |region: FeedRegion, velocity: f64, every: f64, word: &str| {
        let bad = Feed { velocity: Vector3::z() * velocity, ..feed("bad", region) };
        let error = Simulation::new(scene(feeds(vec![bad], 500, every, |_, _| {}), work(0.0))).unwrap_err();
        assert!(error.to_string().contains(word), "{word}: {error}");
    };
    let small = |half: f64| {
        FeedRegion::Volume(Volume::Box {
            min: Vector3::new(-half, -half, 0.01),
            max: Vector3::new(half, half, 0.02),
        })
    };
    refused(small(0.9 * RADIUS), -1.0, STEP, "does not fit into its region");
    refused(small(2.0 * HALF), -1.0, STEP, "beyond the domain");
    refused(small(2.0 * RADIUS), -1.0, 0.1 * STEP, "rate_kg_s");
    refused(FeedRegion::Face(face(HALF)), 0.0, STEP, "velocity_m_s is zero");
    let along = |velocity: Vector3<f64>| {
        let bad = Feed { velocity, ..feed("bad", FeedRegion::Face(face(0.6 * HALF))) };
        Simulation::new(scene(feeds(vec![bad], 5, STEP, |_, _| {}), work(0.0))).map(|_| ())
    };
    // 5° and 7° off the face.
    let error = along(Vector3::new(1.0, 0.0, -0.0875)).unwrap_err();
    assert!(error.to_string().contains("along its face, 5.0° off it"), "{error}");
    assert!(along(Vector3::new(1.0, 0.0, -0.1228)).is_ok());
    refused(FeedRegion::Face(face(0.8 * RADIUS)), -1.0, STEP, "does not fit");
}

/// Square face high in the box.
fn face(half: f64) -> TriangleMesh {
    let z = 45.0 * RADIUS;
    let corner = |x: f64, y: f64| Vector3::new(x * half, y * half, z);
    TriangleMesh {
        vertices: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
    }
}

#[test]
fn grains_come_through_a_face_and_in_a_cylinder() {
    let base = Vector3::new(0.0, 0.0, 40.0 * RADIUS);
    let (radius, length) = (5.0 * RADIUS, 5.0 * RADIUS);
    let tube = FeedRegion::Volume(Volume::Cylinder { base, axis: Vector3::z(), radius, length });
    for (region, low) in [(FeedRegion::Face(face(0.6 * HALF)), 43.0), (tube, 40.0)] {
        let mut simulation =
            Simulation::new(scene(feeds(vec![feed("a", region)], 100, 10.0 * STEP, |_, _| {}), work(0.2)))
                .unwrap();
        run(&mut simulation, 1);
        let first = simulation.particles().grain(1);
        let radius = first.position.xy().norm();
        assert!(first.position.z > low * RADIUS && radius < 0.75 * HALF, "{}", first.position);
        run(&mut simulation, 1000);
        assert_eq!(simulation.feeds()[0].fed.grains, 100);
    }
}

#[test]
fn newcomers_are_felt_as_in_a_run_that_evaluates_every_step() {
    let run_with = |interval: CouplingInterval| {
        let list = vec![feed("a", high())];
        let charge =
            |k: usize, grain: &mut Grain| grain.charge = if k.is_multiple_of(2) { 4e-11 } else { -3e-11 };
        let mut scene = charged(scene(feeds(list, 60, 8.0 * STEP, charge), material(0.8, 0.0, 0.0)), None);
        if let Some(field) = &mut scene.field {
            field.settings.coupling_interval = interval;
            field.settings.tolerance = 1e-3;
        }
        let mut simulation = Simulation::new(scene).unwrap();
        run(&mut simulation, 700);
        (simulation.particles(), simulation.intervals().unwrap().evaluations)
    };
    let (exact, all) = run_with(CouplingInterval::Steps(1));
    let (forecast, evaluations) = run_with(CouplingInterval::Auto);
    assert!(all > 700 && evaluations < 500, "{evaluations} of {all}");
    let fall = 9.81 * 700.0 * STEP;
    let speeds = exact.velocity.iter().zip(&forecast.velocity).map(|(a, b)| (a - b).norm());
    let moved = exact.velocity.iter().map(|v| v.xy().norm()).fold(0.0, f64::max);
    let apart = speeds.fold(0.0, f64::max);
    assert!(moved > 0.01 * fall && apart < 0.02 * moved, "{apart} of {moved}");
}

#[test]
fn newcomers_between_plates_fall_sideways_at_once_and_alike() {
    let charge = |_: usize, grain: &mut Grain| grain.charge = 1e-16;
    let mut scene = scene(feeds(vec![feed("a", high())], 3, 100.0 * STEP, charge), material(0.8, 0.0, 0.0));
    scene.particles = Particles::default();
    scene.walls.clear();
    let mut scene = charged(scene, None);
    let (min, max, open) = (scene.domain.min(), scene.domain.max(), [Boundary::Open; 2]);
    let plates = [Boundary::Potential(1e3), Boundary::Potential(-1e3)];
    scene.domain = Domain::new(min, max, [plates, open, open]).expect("a good box");
    let mut simulation = Simulation::new(scene).unwrap();
    let (mut entered, mut steps) = (Vec::new(), 0_u32);
    while steps < 260 {
        run(&mut simulation, 1);
        steps += 1;
        entered.resize(simulation.len(), steps);
    }
    let field = 2e3 / (max.x - min.x);
    let particles = simulation.particles();
    assert_eq!(particles.len(), 3);
    for (i, entered) in entered.iter().enumerate() {
        let due = particles.charge[i] * field / particles.mass(i) * f64::from(steps - entered) * STEP;
        let found = particles.velocity[i].x;
        assert!((found / due - 1.0).abs() < 2e-4, "grain {i}: {found:e} m/s after {due:e}");
    }
    assert!(simulation.intervals().unwrap().evaluations < 130);
}

#[test]
fn an_empty_box_is_filled_and_empties_again() {
    let mut scene = scene(feeds(vec![feed("a", high())], 40, 5.0 * STEP, |_, _| {}), material(0.7, 0.3, 0.1));
    scene.particles = Particles::default();
    scene.walls.clear();
    let scene = charged(scene, None);
    let mut simulation = Simulation::new(scene).unwrap();
    assert!(simulation.is_empty());
    run(&mut simulation, 5000);
    let book = Book::sum(&simulation.books().unwrap());
    assert_eq!((book.fed.grains, book.left.grains, book.inside.grains), (40, 40, 0));
    assert!((book.fed.mass - book.left.mass).abs() < 1e-12 * book.fed.mass);
}

/// Difference of a sum of two numbers from a third, over their size.
fn off(book: &Book) -> f64 {
    let Book { start, fed, left, inside, .. } = book;
    let mass =
        (inside.mass - (start.mass + fed.mass - left.mass)).abs() / (start.mass + fed.mass).max(1e-300);
    let sizes = [start, fed, left, inside].map(|tally: &Tally| tally.charge.abs()).iter().sum::<f64>();
    let charge = book.charge_off().abs() / (sizes + book.gained.abs() + 1e-15);
    mass.max(charge)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    /// Grains inside are those that were there and came, less those that left, for every material: number,
    /// mass and charge, with what contacts moved.
    #[test]
    fn books_close(
        seed in 0_u64..1000, every in 1.0..12.0_f64, difference in -0.5..0.5_f64, top in 20.0..46.0_f64,
        insulating in any::<bool>(), charge in -2e-12..2e-12_f64
    ) {
        let list = vec![Feed { seed, ..feed("a", high()) }, Feed { seed: seed + 1, ..feed("b", high()) }];
        let change = |k: usize, grain: &mut Grain| {
            grain.material = MaterialId((k.is_multiple_of(3)).into());
            grain.charge = charge * (k % 5) as f64;
            grain.velocity.x = 0.3 * ((k % 7) as f64 - 3.0);
        };
        let mut scene = scene(feeds(list, 250, every * STEP, change), work(0.3));
        let other = Material { work_function_ev: Some(4.5 + difference), ..scene.materials[0].clone() };
        scene.materials.push(other);
        scene.walls[0].charging = if insulating { WallCharging::Insulating } else { WallCharging::Grounded };
        scene.walls[0].material = MaterialId(1);
        // Grains that bounce leave through the sides, since they are open in a field.
        let mut scene = charged(scene, Some(ChargeTransfer::new(5e-7)));
        scene.time.gravity_m_s2.z = -top;
        let mut simulation = Simulation::new(scene).unwrap();
        for _ in 0..4 {
            run(&mut simulation, 400);
            let books = simulation.books().unwrap();
            let all = Book::sum(&books);
            for book in books.iter().chain([&all]) {
                let Book { start, fed, left, inside, .. } = book;
                prop_assert_eq!(inside.grains, start.grains + fed.grains - left.grains);
                prop_assert!(off(book) < 1e-12, "{:e}: {book:?}", off(book));
            }
            let walls: f64 = simulation.ledger().unwrap().walls.iter().sum();
            let sizes = all.inside.charge.abs() + all.fed.charge.abs() + walls.abs() + 1e-15;
            prop_assert!((all.gained + walls).abs() < 1e-12 * sizes, "{:e} {walls:e}", all.gained);
        }
    }
}
