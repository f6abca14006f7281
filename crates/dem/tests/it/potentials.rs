//! Potentials and an external field that change with time: closed forms, other ways to the same field, and
//! what must not matter.

use crate::common::{RADIUS, floor, grain, lattice, mass, material, run, setup};
use amberfield_core::{
    Axis, Boundary, ChargeTransfer, CouplingInterval, Course, CourseRow, Domain, FaceCourse, FieldSettings,
    Grain, MaterialId, Method, PotentialCourse, Side, Step, Tuning, Vector3, Wall, WallCharging,
};
use amberfield_dem::{ElectricEnergy, FieldStageSetup, Setup, Simulation};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use std::f64::consts::{PI, TAU};

/// Frequency [Hz], and steps of 5 µs in a period.
const FREQUENCY: f64 = 500.0;
const PERIOD: u64 = 400;
const STEP: f64 = 5e-6;
/// Height of the box [m].
const HEIGHT: f64 = 0.03;

fn sine<T>(amplitude: T, phase: f64, offset: T) -> Course<T> {
    Course::Sine { amplitude, frequency_hz: FREQUENCY, phase, offset }
}

fn table(rows: impl IntoIterator<Item = (f64, f64)>) -> PotentialCourse {
    let rows = rows.into_iter().map(|(time_s, value)| CourseRow { time_s, value }).collect();
    Course::Table { name: "v.csv".into(), rows }
}

fn face(axis: Axis, side: Side, course: PotentialCourse) -> FaceCourse {
    FaceCourse { axis, side, course }
}

fn settings(method: Method, interval: CouplingInterval) -> FieldSettings {
    FieldSettings {
        method,
        tolerance: 1e-3,
        tuning: Tuning::Model,
        coupling_interval: interval,
        ..FieldSettings::default()
    }
}

const GROUNDED: Boundary = Boundary::Grounded;
/// Plates across z, sides that are periodic.
const PLATES: [[Boundary; 2]; 3] = [[Boundary::Periodic; 2], [Boundary::Periodic; 2], [GROUNDED; 2]];
const BOX: [[Boundary; 2]; 3] = [[GROUNDED; 2]; 3];

/// Grains in a box, `charge` that of each by its number.
fn scene(
    grains: Vec<Grain>,
    charge: impl Fn(usize) -> f64,
    faces: [[Boundary; 2]; 3],
    courses: Vec<FaceCourse>,
    settings: FieldSettings,
) -> Setup {
    let count = grains.len();
    let mut scene = setup(grains, material(0.8, 0.3, 0.0), STEP);
    let half = 0.5 * HEIGHT;
    let (low, high) = (Vector3::new(-half, -half, 0.0), Vector3::new(half, half, HEIGHT));
    scene.domain = Domain::new(low, high, faces).expect("a good box").with_courses(courses);
    scene.particles.charge = (0..count).map(charge).collect();
    scene.field = Some(FieldStageSetup::new(settings, vec![true; count]));
    scene
}

fn bed() -> Vec<Grain> {
    lattice([-0.01, -0.01, 0.005], [0.01, 0.01, 0.025], 3.5 * RADIUS, 0.05, 7)
}

fn sign(n: usize) -> f64 {
    if n.is_multiple_of(2) { 2e-12 } else { -2e-12 }
}

fn final_run(scene: Setup, steps: u64) -> Simulation {
    let mut simulation = Simulation::new(scene).expect("a good scene");
    run(&mut simulation, steps);
    simulation
}

/// Largest difference of velocities over the largest change of any [0 to 1].
fn apart(one: &Simulation, other: &Simulation, start: &[Grain]) -> f64 {
    let (one, other) = (one.particles(), other.particles());
    let change = one.velocity.iter().zip(start).map(|(v, grain)| (v - grain.velocity).norm());
    let difference = one.velocity.iter().zip(&other.velocity).map(|(a, b)| (a - b).norm());
    difference.fold(0.0, f64::max) / change.fold(0.0, f64::max)
}

fn same(one: &Simulation, other: &Simulation) {
    let (one, other) = (one.particles(), other.particles());
    assert_eq!(one.position, other.position);
    assert_eq!(one.velocity, other.velocity);
    assert_eq!(one.charge, other.charge);
}

#[test]
fn lone_grain_in_an_alternating_field_follows_the_closed_form_to_the_order_of_the_integrator() {
    let (amplitude, offset) = (Vector3::new(0.0, 3e5, -4e5), Vector3::new(1e4, 0.0, 0.0));
    let (phase, charge, start) = (0.7, 1e-11, Vector3::new(0.3, 0.0, 0.1));
    let error = |step_s: f64, interval: CouplingInterval| {
        let settings = FieldSettings {
            external_course: Some(sine(amplitude, phase, offset)),
            ..settings(Method::Direct, interval)
        };
        let grains = vec![grain(1, [0.0, 0.0, 0.01], start.into())];
        let open = [[Boundary::Open; 2]; 3];
        let mut scene = scene(grains, |_| charge, open, Vec::new(), settings);
        scene.time.step = Step::Seconds(step_s);
        let end = (3.3 / (FREQUENCY * step_s)).round() as u64;
        let simulation = final_run(scene, end);
        let (t, omega, by_mass) = (simulation.time_s(), TAU * FREQUENCY, charge / mass(RADIUS));
        let swing = amplitude * (by_mass / (omega * omega));
        let expected = Vector3::new(0.0, 0.0, 0.01)
            + start * t
            + swing * (omega * t * phase.cos() - (omega * t + phase).sin() + phase.sin())
            + offset * (0.5 * by_mass * t * t);
        (simulation.particles().position[0] - expected).norm() / swing.norm()
    };
    let auto = CouplingInterval::Auto;
    let coarse = error(4e-5, auto);
    let fine = error(2e-5, auto);
    assert!(coarse < 3e-2, "{coarse:e}");
    assert!((3.6..4.4).contains(&(coarse / fine)), "{coarse:e} {fine:e}");
    // An interval changes nothing: the field is added at the present time.
    let fixed = error(2e-5, CouplingInterval::Steps(37));
    assert!((fixed / fine - 1.0).abs() < 1e-9, "{fixed:e} {fine:e}");
}

#[test]
fn alternating_plates_are_an_alternating_external_field_between_grounded_ones() {
    for method in [Method::Direct, Method::P3m] {
        let voltage = 6000.0;
        let base = settings(method, CouplingInterval::Steps(7));
        let external = FieldSettings {
            external_course: Some(sine(Vector3::new(0.0, 0.0, -voltage / HEIGHT), 0.4, Vector3::zeros())),
            ..base.clone()
        };
        let courses = vec![face(Axis::Z, Side::Max, sine(voltage, 0.4, 0.0))];
        let plates = final_run(scene(bed(), sign, PLATES, courses, base.clone()), 900);
        let field = final_run(scene(bed(), sign, PLATES, Vec::new(), external), 900);
        let apart_by = apart(&plates, &field, &bed());
        assert!(apart_by < 1e-9, "{method}: {apart_by:e}");
        // Half of it on each plate, in opposite phase, in any order.
        let mut halves = vec![
            face(Axis::Z, Side::Max, sine(0.5 * voltage, 0.4, 0.0)),
            face(Axis::Z, Side::Min, sine(0.5 * voltage, 0.4 + PI, 0.0)),
        ];
        let one = final_run(scene(bed(), sign, PLATES, halves.clone(), base.clone()), 900);
        assert!(apart(&one, &plates, &bed()) < 1e-9);
        halves.reverse();
        same(&one, &final_run(scene(bed(), sign, PLATES, halves, base), 900));
    }
}

#[test]
fn fine_table_is_the_sine_and_a_slow_sine_a_constant() {
    let courses = |course: PotentialCourse| vec![face(Axis::Z, Side::Max, course)];
    let steps = CouplingInterval::Steps(5);
    let of = |faces, course| scene(bed(), sign, faces, courses(course), settings(Method::Direct, steps));
    for faces in [PLATES, BOX] {
        let exact = sine(5000.0, 0.3, 200.0);
        let rows = (0..2000).map(|n| f64::from(n) * 5e-6).map(|t| (t, exact.at(t)));
        let by_table = final_run(of(faces, table(rows)), 600);
        let by_sine = final_run(of(faces, exact), 600);
        let apart_by = apart(&by_table, &by_sine, &bed());
        assert!(apart_by < 1e-6, "{apart_by:e}");

        let slow = Course::Sine { amplitude: 5e3, frequency_hz: 1e-9, phase: TAU / 4.0, offset: 0.0 };
        let slow = final_run(of(faces, slow), 600);
        let level = final_run(of(faces, table([(1.0, 5e3), (2.0, 5e3)])), 600);
        let mut constant = faces;
        constant[2][1] = Boundary::Potential(5e3);
        let constant =
            scene(bed(), sign, constant, Vec::new(), settings(Method::Direct, CouplingInterval::Steps(5)));
        let constant = final_run(constant, 600);
        for (name, other) in [("slow", slow), ("level", level)] {
            let apart_by = apart(&other, &constant, &bed());
            assert!(apart_by < 1e-9, "{name} {apart_by:e}");
        }
    }
}

#[test]
fn p3m_and_direct_move_grains_alike() {
    for faces in [PLATES, BOX] {
        let courses = vec![face(Axis::Z, Side::Max, sine(3000.0, 0.0, 0.0))];
        let of = |method| {
            final_run(
                scene(bed(), sign, faces, courses.clone(), settings(method, CouplingInterval::Auto)),
                800,
            )
        };
        let apart_by = apart(&of(Method::P3m), &of(Method::Direct), &bed());
        assert!(apart_by < 3e-3, "{apart_by:e}");
    }
}

/// Squared error of the forces of the last step, and their square.
fn error_of_forces(domain: &Domain, run: &Simulation, settings: &FieldSettings) -> [f64; 2] {
    let particles = run.particles();
    let positions: Vec<_> = particles.position.iter().map(|x| domain.wrap(*x)).collect();
    let mut field = ElectricField::new(domain, settings, &positions, &particles.charge).expect("a field");
    field.set_time(run.time_s());
    let mut values = FieldValues::default();
    let wanted = Wanted { potential: false, components: false };
    field.evaluate(&positions, &particles.charge, wanted, &mut values).expect("a good scene");
    let used = run.electric_forces().expect("a field");
    let mut sums = [0.0; 2];
    for ((used, e), q) in used.iter().zip(&values.e).zip(&particles.charge) {
        sums[0] += (used - e * *q).norm_squared();
        sums[1] += ((e - field.external()) * *q).norm_squared();
    }
    sums
}

#[test]
fn evaluations_follow_potentials_whose_field_varies_and_the_stated_error_is_the_true_one() {
    let of = |courses: Vec<FaceCourse>| {
        let settings = FieldSettings { tolerance: 1e-2, ..settings(Method::Direct, CouplingInterval::Auto) };
        let scene = scene(bed(), sign, BOX, courses, settings.clone());
        let domain = scene.domain.clone();
        let mut simulation = Simulation::new(scene).expect("a good scene");
        let (periods, mut error) = (3, 0.0);
        for _ in 0..periods * PERIOD {
            simulation.step().expect("a good step");
            let [wrong, size] = error_of_forces(&domain, &simulation, &settings);
            error += wrong / size;
        }
        let steps = (periods * PERIOD) as f64;
        let intervals = simulation.intervals().expect("a field");
        (intervals.evaluations / periods, intervals.error(), (error / steps).sqrt())
    };
    // An offset keeps the field away from zero, where the error has no scale.
    let (evaluations, stated, truth) = of(vec![face(Axis::X, Side::Min, sine(4000.0, 0.2, 6000.0))]);
    assert!(evaluations >= 20, "{evaluations}");
    assert!(stated < 2.0 * truth && stated > truth / 3.0 && truth < 1e-2, "{stated:e} {truth:e}");

    let rows = [(0.0, 2000.0), (1e-3, 9000.0), (2e-3, 3000.0), (4e-3, 6000.0)];
    let (evaluations, stated, truth) = of(vec![face(Axis::X, Side::Min, table(rows))]);
    assert!(evaluations >= 15, "{evaluations}");
    assert!(stated < 2.0 * truth && stated > truth / 3.0 && truth < 1e-2, "{stated:e} {truth:e}");
}

#[test]
fn energy_between_evaluations_is_that_of_the_present_potentials() {
    let courses = vec![face(Axis::Z, Side::Max, sine(6000.0, 0.0, 0.0))];
    let settings = FieldSettings {
        external_course: Some(sine(Vector3::new(0.0, 0.0, 1e5), 1.0, Vector3::zeros())),
        ..settings(Method::Direct, CouplingInterval::Steps(50))
    };
    let mut simulation =
        Simulation::new(scene(bed(), sign, PLATES, courses, settings)).expect("a good scene");
    let mut largest = 0.0_f64;
    let mut worst = 0.0_f64;
    for _ in 0..40 {
        run(&mut simulation, 23);
        let fresh = simulation.energies(ElectricEnergy::Evaluated).expect("a field").electric.expect("one");
        let told = simulation.energies(ElectricEnergy::Forecast).expect("a field").electric.expect("one");
        largest = largest.max(fresh.abs());
        worst = worst.max((told - fresh).abs());
    }
    assert!(worst < 1e-3 * largest, "{worst:e} {largest:e}");
}

#[test]
fn runs_go_on_from_a_checkpoint_with_the_same_bits() {
    for faces in [PLATES, BOX] {
        let of = || {
            let courses = vec![
                face(Axis::Z, Side::Max, sine(6000.0, 0.3, 100.0)),
                face(Axis::Z, Side::Min, table([(0.0, 0.0), (1.1e-3, 500.0), (3e-3, -900.0)])),
            ];
            let settings = FieldSettings {
                external_course: Some(sine(Vector3::new(1e4, 0.0, 2e4), 1.0, Vector3::zeros())),
                ..settings(Method::Direct, CouplingInterval::Auto)
            };
            let mut scene = scene(bed(), sign, faces, courses, settings);
            scene.materials[0].work_function_ev = Some(4.0);
            scene.materials.push(scene.materials[0].clone());
            scene.materials[1].work_function_ev = Some(5.0);
            scene.walls = vec![Wall { charging: WallCharging::Grounded, material: MaterialId(1), ..floor() }];
            scene.time.gravity_m_s2 = Vector3::new(0.0, 0.0, -9.81);
            scene.field.as_mut().expect("a field").transfer = Some(ChargeTransfer::new(5e-7));
            scene
        };
        let whole = final_run(of(), 1000);
        let mut first = final_run(of(), 437);
        let state = first.checkpoint().expect("a state");
        let mut second = Simulation::resume(of(), state).expect("a good state");
        run(&mut second, 1000 - 437);
        same(&whole, &second);
        assert_eq!(whole.intervals(), second.intervals());
    }
}

#[test]
fn contacts_trade_in_the_field_of_their_time() {
    // Two grains meet head-on along the field, without charge: what moves is E at the contact's time.
    let moved = |interval: CouplingInterval, field: Option<Course<Vector3<f64>>>| {
        let settings = FieldSettings { external_course: field, ..settings(Method::Direct, interval) };
        let grains = vec![
            grain(1, [0.0, 0.0, 0.010], [0.0, 0.0, 0.3]),
            grain(2, [0.0, 0.0, 0.010 + 2.2 * RADIUS], [0.0, 0.0, -0.3]),
        ];
        let mut scene = scene(grains, |_| 0.0, [[Boundary::Open; 2]; 3], Vec::new(), settings);
        scene.materials[0].work_function_ev = Some(4.5);
        scene.field.as_mut().expect("a field").transfer = Some(ChargeTransfer::new(5e-7));
        final_run(scene, 300).particles().charge[0]
    };
    let e = Vector3::new(0.0, 0.0, 1e5);
    let every = moved(CouplingInterval::Steps(1), Some(sine(e, 0.0, Vector3::zeros())));
    let rare = moved(CouplingInterval::Steps(60), Some(sine(e, 0.0, Vector3::zeros())));
    assert!(every != 0.0);
    assert!((rare / every - 1.0).abs() < 0.02, "{rare:e} {every:e}");
    // The contact comes after 333 µs, a third of half a period, and grows for some dozens of steps.
    let constant = moved(
        CouplingInterval::Steps(1),
        Some(Course::Table {
            name: "e.csv".into(),
            rows: [0.0, 1.0].map(|time_s| CourseRow { time_s, value: e }).to_vec(),
        }),
    );
    let share = every / constant;
    assert!((0.6..1.0).contains(&share), "{share}");
}

#[test]
fn steps_and_intervals_that_do_not_show_a_frequency_are_refused_and_automatic_ones_do() {
    let courses = || vec![face(Axis::Z, Side::Max, sine(6000.0, 0.0, 0.0))];
    let refused = |scene: Setup| Simulation::new(scene).expect_err("too long").to_string();
    let of = |faces, interval| scene(bed(), sign, faces, courses(), settings(Method::Direct, interval));
    let mut long = of(PLATES, CouplingInterval::Auto);
    long.time.allow_unstable = true;
    long.time.step = Step::Seconds(1.1e-4);
    let said = refused(long);
    assert!(said.contains("1e-4") && said.contains("20 steps"), "{said}");
    let said = refused(of(BOX, CouplingInterval::Steps(21)));
    assert!(said.contains("coupling_interval = 21") && said.contains("at most 20 steps"), "{said}");
    assert!(Simulation::new(of(PLATES, CouplingInterval::Steps(21))).is_ok());

    let fast = Course::Sine { amplitude: 1.0, frequency_hz: 1e5, phase: 0.0, offset: 0.0 };
    let courses = vec![face(Axis::Z, Side::Max, fast)];
    let mut auto = scene(bed(), sign, PLATES, courses, settings(Method::Direct, CouplingInterval::Auto));
    auto.time.step = Step::Auto;
    let simulation = Simulation::new(auto).expect("a good scene");
    assert!(simulation.step_s() <= 5e-7);

    let kolehmainen = FieldSettings {
        cutoff_radius_m: Some(5e-3),
        ..settings(Method::Kolehmainen, CouplingInterval::Auto)
    };
    let courses = vec![face(Axis::Z, Side::Max, sine(6000.0, 0.0, 0.0))];
    let said = refused(scene(bed(), sign, PLATES, courses, kolehmainen));
    assert!(said.contains("kolehmainen") && said.contains("p3m"), "{said}");
}
