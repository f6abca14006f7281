//! The electric field stage: forces, groups, interval, limiter, checkpoint.

use crate::common::{RADIUS, grain, lattice, mass, material, run, setup};
use amberfield_core::{CouplingInterval, FieldSettings, ForceLimit, Method, Permittivity, Vector3};
use amberfield_dem::{ElectricEnergy, FieldStageSetup, Setup, Simulation};

const CHARGE: f64 = 1e-10;

fn charged(distance: f64, interval: CouplingInterval) -> Setup {
    let mut scene = setup(
        vec![grain(1, [0.0; 3], [0.0; 3]), grain(2, [distance, 0.0, 0.0], [0.0; 3])],
        material(0.9, 0.3, 0.0),
        1e-6,
    );
    scene.particles.charge = vec![CHARGE, -CHARGE];
    let settings =
        FieldSettings { method: Method::Direct, coupling_interval: interval, ..FieldSettings::default() };
    scene.field = Some(FieldStageSetup::new(settings, vec![true; 2]));
    scene
}

#[test]
fn opposite_charges_fall_towards_each_other_with_coulombs_force() {
    let distance = 10.0 * RADIUS;
    let mut simulation = Simulation::new(charged(distance, CouplingInterval::Steps(1))).unwrap();
    run(&mut simulation, 1000);
    let p = simulation.particles();
    let force = Permittivity::VACUUM.coulomb() * CHARGE * CHARGE / (distance * distance);
    let expected = force / mass(RADIUS) * simulation.time_s();
    // The grains have come closer by 1e-5 of their distance.
    assert!((p.velocity[0].x / expected - 1.0).abs() < 1e-4, "{} {expected}", p.velocity[0].x);
    assert!((p.velocity[0] + p.velocity[1]).norm() < 1e-12 * expected);
    let energy = simulation.energies(ElectricEnergy::Evaluated).unwrap();
    let electric = -Permittivity::VACUUM.coulomb() * CHARGE * CHARGE / (p.position[1] - p.position[0]).norm();
    assert!((energy.electric.unwrap() / electric - 1.0).abs() < 1e-9);
    assert_eq!(simulation.energies(ElectricEnergy::Forecast).unwrap(), energy);
}

#[test]
fn extrapolated_field_conserves_energy_and_tells_it_between_evaluations() {
    let mut simulation = Simulation::new(charged(6.0 * RADIUS, CouplingInterval::Auto)).unwrap();
    let total = |s: &mut Simulation| {
        let e = s.energies(ElectricEnergy::Evaluated).unwrap();
        (e.kinetic + e.electric.unwrap(), e.kinetic)
    };
    let (start, _) = total(&mut simulation);
    for _ in 0..6 {
        run(&mut simulation, 10_000);
        let fresh = simulation.energies(ElectricEnergy::Evaluated).unwrap();
        let forecast = simulation.energies(ElectricEnergy::Forecast).unwrap();
        let (fresh, forecast) = (fresh.electric.unwrap(), forecast.electric.unwrap());
        assert!((forecast / fresh - 1.0).abs() < 1e-2, "{forecast:e} {fresh:e}");
    }
    let (end, kinetic) = total(&mut simulation);
    // Travel between evaluations: a hundredth of a radius.
    assert!((end - start).abs() < 0.01 * kinetic, "{start:e} {end:e} {kinetic:e}");
}

#[test]
fn outsiders_neither_make_nor_feel_the_field() {
    let mut scene = charged(10.0 * RADIUS, CouplingInterval::Auto);
    scene.particles.push(amberfield_core::Grain {
        charge: 5.0 * CHARGE,
        ..grain(3, [0.0, 4.0 * RADIUS, 0.0], [0.0; 3])
    });
    scene.field.as_mut().unwrap().member.push(false);
    let simulation = Simulation::new(scene).unwrap();
    let forces = simulation.electric_forces().unwrap();
    assert_eq!(forces[2], Vector3::zeros());
    assert!(forces[0].y.abs() < 1e-12 * forces[0].x && forces[0].x > 0.0, "{forces:?}");
}

#[test]
fn scene_without_charge_has_no_field_stage() {
    let mut scene = charged(10.0 * RADIUS, CouplingInterval::Auto);
    scene.particles.charge = vec![0.0; 2];
    let mut simulation = Simulation::new(scene).unwrap();
    assert!(!simulation.plan().has("field") && simulation.field().is_none());
    assert!(simulation.plan().left_out().iter().any(|e| e.stage == "field" && e.reason.contains("zero")));
    assert_eq!(simulation.energies(ElectricEnergy::Evaluated).unwrap().electric, None);
}

#[test]
fn force_limit_shortens_and_books() {
    let mut scene = charged(3.0 * RADIUS, CouplingInterval::Steps(2));
    // f m skin/Δt² with a factor that bites.
    let factor = 1e-9;
    scene.field.as_mut().unwrap().settings.force_limit = Some(ForceLimit { factor });
    let mut simulation = Simulation::new(scene).unwrap();
    run(&mut simulation, 10);
    let limited = simulation.limited().unwrap();
    assert_eq!((limited.grains, limited.steps, limited.grain_steps), (2, 10, 20));
    let unlimited = Permittivity::VACUUM.coulomb() * CHARGE * CHARGE / (9.0 * RADIUS * RADIUS);
    assert!((limited.largest_force_n / unlimited - 1.0).abs() < 1e-6, "{limited:?}");
    let bound = factor * mass(RADIUS) * simulation.skin_m() / (simulation.step_s() * simulation.step_s());
    assert!((simulation.electric_forces().unwrap()[0].norm() / bound - 1.0).abs() < 1e-12);
}

#[test]
fn charged_run_resumes_with_the_same_bits() {
    let scene = || {
        let half = 7.0 * RADIUS;
        let grains = lattice([-half; 3], [half; 3], 2.2 * RADIUS, 0.3, 9);
        let count = grains.len();
        let mut scene = setup(grains, material(0.8, 0.3, 0.02), 5e-6);
        scene.particles.charge =
            (0..count).map(|k| if k % 2 == 0 { 0.2 * CHARGE } else { -0.2 * CHARGE }).collect();
        let settings = FieldSettings { method: Method::Direct, ..FieldSettings::default() };
        scene.field = Some(FieldStageSetup::new(settings, vec![true; count]));
        scene
    };
    let mut whole = Simulation::new(scene()).unwrap();
    run(&mut whole, 107);
    let state = whole.state();
    assert_eq!(state.choice(), Some(whole.field().unwrap().choice()));
    run(&mut whole, 107);
    let mut resumed = Simulation::resume(scene(), state).unwrap();
    run(&mut resumed, 107);
    assert_eq!(whole.particles(), resumed.particles());
    assert_eq!(whole.electric_forces(), resumed.electric_forces());
}

#[test]
fn too_long_a_step_for_the_charges_is_refused() {
    let mut scene = charged(3.0 * RADIUS, CouplingInterval::Auto);
    scene.particles.charge = vec![1e-3, -1e-3];
    let text = Simulation::new(scene).unwrap_err().to_string();
    assert!(text.contains("electric pair") || text.contains("plasma"), "{text}");
}
