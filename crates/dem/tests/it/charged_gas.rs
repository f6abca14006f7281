//! A frictionless elastic gas of charged grains keeps its energy, although its field is evaluated now and
//! then only.

use crate::common::{RADIUS, lattice, material, run, setup};
use amberfield_core::{Boundary, CouplingInterval, Domain, FieldSettings, Tuning, Vector3};
use amberfield_dem::{ElectricEnergy, FieldStageSetup, Setup, Simulation};

/// Coulomb energy at contact as large as the mean kinetic energy [C].
const CHARGE: f64 = 1e-10;

fn gas() -> Setup {
    let half = 7.0 * RADIUS;
    let grains = lattice([-half, -half, -half], [half, half, half], 3.5 * RADIUS, 0.1, 9);
    let mut scene = setup(grains, material(1.0, 0.0, 0.0), 8e-6);
    scene.domain = Domain::new(Vector3::repeat(-half), Vector3::repeat(half), [[Boundary::Periodic; 2]; 3])
        .expect("a good box");
    let count = scene.particles.len();
    scene.particles.charge = (0..count).map(|i| if i % 2 == 0 { CHARGE } else { -CHARGE }).collect();
    let settings = FieldSettings {
        tolerance: 1e-2,
        coupling_interval: CouplingInterval::Auto,
        tuning: Tuning::Model,
        ..FieldSettings::default()
    };
    scene.field = Some(FieldStageSetup::new(settings, vec![true; count]));
    scene
}

#[test]
fn charged_gas_keeps_its_energy_over_a_hundred_thousand_steps() {
    let mut simulation = Simulation::new(gas()).unwrap();
    let total = |s: &mut Simulation| {
        let e = s.energies(ElectricEnergy::Evaluated).unwrap();
        (e.kinetic + e.contact + e.electric.unwrap(), e.kinetic)
    };
    let (start, kinetic) = total(&mut simulation);
    let mut drift = 0.0_f64;
    for _ in 0..100 {
        run(&mut simulation, 1000);
        drift = drift.max((total(&mut simulation).0 - start).abs() / kinetic);
    }
    let intervals = simulation.intervals().unwrap();
    assert!(simulation.step_index() == 100_000 && intervals.evaluations < 50_000, "{intervals:?}");
    assert!(drift < 0.02, "{drift}");
}
