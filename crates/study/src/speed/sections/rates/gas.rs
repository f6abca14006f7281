//! A frictionless elastic gas of charged grains keeps its energy.

use super::Rows;
use crate::beds;
use amberfield_core::{CouplingInterval, FieldSettings, Tuning};
use amberfield_dem::{ElectricEnergy, FieldStageSetup, Setup, Simulation};
use anyhow::Result;

pub(super) const STUDY: &str = "gas";
pub(super) const GRAINS: usize = 1000;
const STEPS: usize = 100_000;
/// Coulomb energy at contact as large as the kinetic energy [C].
const CHARGE: f64 = 1e-10;

pub(super) fn measure(quick: bool, rows: &mut Rows) -> Result<()> {
    let steps = if quick { 500 } else { STEPS };
    let gas = |charge: f64, tolerance: f64, interval: CouplingInterval| {
        let mut scene = beds::sparse(GRAINS);
        scene.materials[0].restitution = 1.0;
        scene.materials[0].friction = 0.0;
        let count = scene.particles.len();
        let settings = FieldSettings {
            tolerance,
            coupling_interval: interval,
            tuning: Tuning::Model,
            ..FieldSettings::default()
        };
        scene.particles.charge = (0..count).map(|i| if i % 2 == 0 { charge } else { -charge }).collect();
        scene.field = Some(FieldStageSetup::new(settings, vec![true; count]));
        scene
    };
    look(rows, "without charge", gas(0.0, 1e-2, CouplingInterval::Auto), steps)?;
    look(rows, "tolerance 1e-2, auto", gas(CHARGE, 1e-2, CouplingInterval::Auto), steps)?;
    look(rows, "tolerance 1e-3, auto", gas(CHARGE, 1e-3, CouplingInterval::Auto), steps)?;
    look(rows, "tolerance 1e-2, every step", gas(CHARGE, 1e-2, CouplingInterval::Steps(1)), steps / 10)
}

fn look(rows: &mut Rows, case: &str, setup: Setup, steps: usize) -> Result<()> {
    let mut simulation = Simulation::new(setup)?;
    let total = |simulation: &mut Simulation| -> Result<(f64, f64)> {
        let energies = simulation.energies(ElectricEnergy::Evaluated)?;
        let electric = energies.electric.unwrap_or(0.0);
        Ok((energies.kinetic + energies.contact + electric, energies.kinetic))
    };
    let (start, kinetic) = total(&mut simulation)?;
    let mut drift = 0.0_f64;
    for step in 1..=steps {
        simulation.step()?;
        if step % (steps / 100).max(1) == 0 {
            drift = drift.max((total(&mut simulation)?.0 - start).abs());
        }
    }
    rows.add(STUDY, case, "steps", steps as f64);
    rows.add(STUDY, case, "evaluations", simulation.intervals().map_or(0.0, |i| i.evaluations as f64));
    rows.add(STUDY, case, "energy drift", drift / kinetic);
    Ok(())
}
