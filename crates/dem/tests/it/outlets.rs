//! Outlets: when grains leave, what is booked to whom, and what does not matter.

use crate::common::{RADIUS, domain, floor, grain, lattice, mass, material, run, setup};
use amberfield_core::{
    Axis, Boundary, CouplingInterval, Domain, FieldSettings, Method, Outlet, OutletRegion, Side, Vector3,
    Volume,
};
use amberfield_dem::{Book, DemError, ElectricEnergy, FieldStageSetup, Setup, Simulation, Tally, WayOut};

const STEP: f64 = 2e-5;
const GRAVITY: f64 = 9.81;

fn volume(name: &str, min: [f64; 3], max: [f64; 3]) -> Outlet {
    let region = OutletRegion::Volume(Volume::Box { min: min.into(), max: max.into() });
    Outlet { name: name.into(), region, each: true }
}

fn face(name: &str, axis: Axis, side: Side) -> Outlet {
    Outlet { name: name.into(), region: OutletRegion::Face(axis, side), each: false }
}

fn direct() -> FieldSettings {
    FieldSettings { method: Method::Direct, ..FieldSettings::default() }
}

/// Grains without friction that fall, with outlets.
fn falling(grains: Vec<amberfield_core::Grain>, outlets: Vec<Outlet>) -> Setup {
    let mut setup = setup(grains, material(0.8, 0.0, 0.0), STEP);
    setup.time.gravity_m_s2.z = -GRAVITY;
    setup.domain = domain(0.1, Boundary::Open);
    setup.outlets = outlets;
    setup
}

#[test]
fn a_grain_leaves_in_the_step_in_which_its_centre_comes_in() {
    let bin = volume("bin", [-0.05, -0.05, -0.1], [0.05, 0.05, -0.02]);
    let mut setup =
        falling(vec![grain(7, [0.0; 3], [0.0; 3]), grain(8, [0.07, 0.0, 0.0], [0.0; 3])], vec![bin]);
    setup.particles.charge = vec![3e-12, 5e-12];
    let mut simulation = Simulation::new(setup).unwrap();
    // ½ g t² = 0.02 m.
    let due = (2.0 * 0.02 / GRAVITY).sqrt();
    let steps = (due / STEP).ceil() as u64;
    run(&mut simulation, steps - 2);
    assert_eq!(simulation.len(), 2);
    run(&mut simulation, 3);
    assert_eq!(simulation.len(), 1);
    let [exit] = simulation.take_exits()[..] else { panic!("one grain left") };
    assert_eq!((exit.id, exit.way, exit.charge, exit.radius), (7, WayOut::Outlet(0), 3e-12, RADIUS));
    assert!((exit.time_s - due).abs() <= 1.01 * STEP && exit.position.z <= -0.02);
    assert!((exit.mass / mass(RADIUS) - 1.0).abs() < 1e-14);
    let [of_bin] = simulation.outlets() else { panic!("one outlet") };
    assert_eq!((of_bin[0].grains, of_bin[0].charge), (1, 3e-12));
    // The other falls past the bin, and ends the run at the face.
    let left = (0..10_000).find_map(|_| simulation.step().err());
    assert!(matches!(left, Some(DemError::Left { id: 8, .. })), "{left:?}");
}

#[test]
fn a_face_that_is_an_outlet_lets_grains_out_and_no_other_does() {
    let grains = || vec![grain(1, [0.0; 3], [0.0; 3]), grain(2, [0.0, 0.05, 0.0], [2.0, 0.0, 0.0])];
    let floor = face("floor", Axis::Z, Side::Min);
    let mut simulation = Simulation::new(falling(grains(), vec![floor.clone()])).unwrap();
    let end = (0..20_000).find_map(|_| simulation.step().err());
    assert!(matches!(&end, Some(DemError::Left { id: 2, face, .. }) if face == "x_max"), "{end:?}");
    let outlets = vec![face("side", Axis::X, Side::Max), floor];
    let mut simulation = Simulation::new(falling(grains(), outlets)).unwrap();
    run(&mut simulation, 10_000);
    let counts: Vec<u64> = simulation.outlets().iter().map(|of| Tally::sum(of).grains).collect();
    assert_eq!((simulation.len(), counts), (0, vec![1, 1]));
}

/// A bed that bounces on a floor, with a net velocity towards outlets.
fn bed(outlets: Vec<Outlet>) -> Setup {
    let grains = lattice([0.0, -0.03, 0.005], [0.04, 0.03, 0.02], 2.6 * RADIUS, 0.3, 5);
    let mut setup = falling(grains, outlets);
    setup.walls = vec![floor()];
    setup.particles.velocity.iter_mut().for_each(|velocity| velocity.x += 0.5);
    (0..setup.particles.len()).for_each(|i| setup.particles.charge[i] = 1e-13 * (i as f64 - 100.0));
    let open = [Boundary::Open; 2];
    setup.domain =
        Domain::new(Vector3::repeat(-0.1), Vector3::repeat(0.1), [open, [Boundary::Periodic; 2], open])
            .expect("a good box");
    setup
}

#[test]
fn an_outlet_cut_in_two_takes_the_same_grains_and_the_books_close() {
    let whole = vec![volume("a", [0.05, -0.1, 0.0], [0.07, 0.1, 0.1])];
    let halves = || {
        let one = volume("a", [0.05, -0.1, 0.0], [0.07, 0.013, 0.1]);
        vec![one, volume("b", [0.05, 0.013, 0.0], [0.07, 0.1, 0.1])]
    };
    let of = |outlets: Vec<Outlet>| {
        let mut simulation = Simulation::new(bed(outlets)).unwrap();
        run(&mut simulation, 4000);
        simulation
    };
    let (mut one, mut two) = (of(whole), of(halves()));
    let rows = |simulation: &mut Simulation| -> Vec<_> {
        simulation.take_exits().iter().map(|exit| (exit.step, exit.id, exit.charge)).collect()
    };
    let (left, same) = (rows(&mut one), rows(&mut two));
    assert!(left.len() > 100, "{}", left.len());
    assert_eq!(left, same);
    assert_eq!(one.particles(), two.particles());
    let sum = Tally::sum(two.outlets().iter().flatten());
    let taken = Tally::sum(one.outlets().iter().flatten());
    assert_eq!(sum.grains, taken.grains);
    assert!(two.outlets().iter().all(|of| of[0].grains > 0));
    for simulation in [&one, &two] {
        let book = Book::sum(&simulation.books().unwrap());
        let all = Tally::sum(simulation.outlets().iter().flatten());
        assert_eq!(book.left.grains, all.grains);
        assert_eq!(book.inside.grains, book.start.grains - book.left.grains);
        assert!((book.inside.mass + book.left.mass - book.start.mass).abs() < 1e-12 * book.start.mass);
        assert!(book.charge_off().abs() < 1e-12 * 1e-13 * 100.0 * 300.0);
    }
}

#[test]
fn checkpoints_and_threads_change_nothing() {
    let outlets = || vec![volume("a", [0.05, -0.1, 0.0], [0.07, 0.1, 0.1])];
    let mut whole = Simulation::new(bed(outlets())).unwrap();
    run(&mut whole, 4000);
    let mut first = Simulation::new(bed(outlets())).unwrap();
    run(&mut first, 2600);
    assert!(first.outlets()[0][0].grains > 0, "nothing has left by then");
    let state = first.checkpoint().unwrap();
    let mut second = Simulation::resume(bed(outlets()), state).unwrap();
    run(&mut second, 1400);
    assert_eq!(whole.checkpoint().unwrap(), second.checkpoint().unwrap());
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    let alone = pool.install(|| {
        let mut simulation = Simulation::new(bed(outlets())).unwrap();
        run(&mut simulation, 4000);
        simulation.checkpoint().unwrap()
    });
    assert_eq!(whole.checkpoint().unwrap(), alone);
}

#[test]
fn grains_that_leave_are_felt_no_more_as_in_a_run_that_evaluates_every_step() {
    let run_with = |interval: CouplingInterval| {
        let mut grains = lattice([-0.02; 3], [0.02; 3], 6.0 * RADIUS, 0.02, 3);
        for (k, grain) in grains.iter_mut().enumerate() {
            grain.charge = if k % 3 == 0 { -2e-11 } else { 3e-11 };
            grain.velocity.x += 1.0;
        }
        let count = grains.len();
        let mut setup = falling(grains, vec![volume("a", [0.03, -0.1, -0.1], [0.05, 0.1, 0.1])]);
        setup.time.gravity_m_s2.z = 0.0;
        let settings = FieldSettings { coupling_interval: interval, tolerance: 1e-3, ..direct() };
        setup.field = Some(FieldStageSetup::new(settings, vec![true; count]));
        let mut simulation = Simulation::new(setup).unwrap();
        run(&mut simulation, 1500);
        let energies = simulation.energies(ElectricEnergy::Forecast).unwrap().electric.unwrap();
        let exact = simulation.energies(ElectricEnergy::Evaluated).unwrap().electric.unwrap();
        assert!((energies - exact).abs() < 0.02 * exact.abs(), "{energies:e} {exact:e}");
        let intervals = simulation.intervals().unwrap();
        (simulation.particles(), intervals.evaluations, intervals.error(), count)
    };
    let (exact, all, ..) = run_with(CouplingInterval::Steps(1));
    let (forecast, evaluations, error, count) = run_with(CouplingInterval::Auto);
    assert!(exact.len() + 20 < count && exact.id == forecast.id, "{} of {count}", exact.len());
    assert!(all > 1500 && evaluations < 500 && error < 1e-3, "{evaluations} of {all}, {error:e}");
    let gained = exact.velocity.iter().map(|v| v.yz().norm()).fold(0.0, f64::max);
    let apart =
        exact.velocity.iter().zip(&forecast.velocity).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    assert!(apart < 2e-3 * gained, "{apart:e} of {gained:e}");
}

#[test]
fn a_periodic_box_does_not_hide_grains_from_an_outlet() {
    // It flies out of the period and comes in at the other side, where the outlet is.
    let mut setup = falling(vec![grain(1, [0.0, 0.08, 0.0], [0.0, 1.0, 0.0])], Vec::new());
    setup.time.gravity_m_s2.z = 0.0;
    setup.domain = domain(0.1, Boundary::Periodic);
    setup.outlets = vec![volume("a", [-0.1, -0.1, -0.1], [0.1, -0.09, 0.1])];
    let mut simulation = Simulation::new(setup).unwrap();
    let steps = (0..3000).take_while(|_| simulation.step().is_ok() && !simulation.is_empty()).count();
    assert!((steps as f64 * STEP - 0.02).abs() < 2.0 * STEP, "{steps}");
}

#[test]
fn outlets_that_cannot_be_are_refused() {
    let refused = |outlets: Vec<Outlet>, words: &str| {
        let mut setup = falling(vec![grain(1, [0.0; 3], [0.0; 3])], outlets);
        setup.domain = Domain::new(
            Vector3::repeat(-0.1),
            Vector3::repeat(0.1),
            [[Boundary::Open; 2], [Boundary::Periodic; 2], [Boundary::Open; 2]],
        )
        .expect("a good box");
        let message = Simulation::new(setup).expect_err("impossible").to_string();
        assert!(message.contains(words) && message.contains("outlet \""), "{message}");
    };
    refused(vec![volume("a", [0.0; 3], [0.05, 0.05, 0.2])], "beyond the domain");
    refused(vec![face("a", Axis::Y, Side::Min)], "periodic");
    refused(vec![face("a", Axis::Z, Side::Min), face("b", Axis::Z, Side::Min)], "z_min");
}
