//! Statistics of small beds at rest, with the field at every step and now and then.

use super::Rows;
use super::bed::Bed;
use amberfield_core::{CouplingInterval, Vector3};
use amberfield_dem::{ElectricEnergy, Setup, Simulation};
use anyhow::Result;
use std::path::Path;

pub(super) const STUDY: &str = "replicas";
pub(super) const REFERENCE_TOLERANCE: f64 = 1e-3;
pub(super) const SEEDS: usize = 6;
pub(super) const QUANTITIES: [&str; 7] = [
    "mean height [m]",
    "kinetic energy [J]",
    "contact energy [J]",
    "electric energy [J]",
    "contacts per grain",
    "neighbours within 1.1 diameters",
    "neighbours within 2 diameters",
];
const GRAINS: usize = 2000;
/// Side of the bed's box, which keeps the depth of the case [m].
const SIDE: f64 = 0.0019;

pub(super) fn measure(path: &Path, quick: bool, rows: &mut Rows) -> Result<()> {
    let seeds = if quick { 2 } else { SEEDS };
    let (mut every, mut auto) = (Vec::new(), Vec::new());
    for seed in 1..=seeds {
        let overrides = [
            format!("domain.max_m=[{SIDE}, {SIDE}, 0.01]"),
            format!("particles.generate.count={GRAINS}"),
            format!("particles.generate.seed={seed}"),
            format!("particles.generate.region.box.max_m=[{SIDE}, {SIDE}, 0.0075]"),
        ];
        let bed = Bed::read(path, &overrides)?;
        let end_s = if quick { 1e-4 } else { bed.end_s };
        every.push(at_rest(bed.charged(REFERENCE_TOLERANCE, CouplingInterval::Steps(1)), end_s)?);
        auto.push(at_rest(bed.charged(1e-2, CouplingInterval::Auto), end_s)?);
    }
    for (index, quantity) in QUANTITIES.into_iter().enumerate() {
        let of = |all: &[[f64; 7]]| mean_and_variance(all.iter().map(|one| one[index]));
        let ((every, every_variance), (auto, auto_variance)) = (of(&every), of(&auto));
        rows.add(STUDY, "every step", quantity, every);
        rows.add(STUDY, "auto", quantity, auto);
        let error = ((every_variance + auto_variance) / seeds as f64).sqrt();
        rows.add(STUDY, "difference", quantity, (auto - every) / error.max(f64::MIN_POSITIVE));
    }
    Ok(())
}

/// The quantities at the end.
fn at_rest(setup: Setup, end_s: f64) -> Result<[f64; 7]> {
    let mut simulation = Simulation::new(setup)?;
    while simulation.time_s() < end_s {
        simulation.step()?;
    }
    let energies = simulation.energies(ElectricEnergy::Evaluated)?;
    let particles = simulation.particles();
    let count = particles.len() as f64;
    let diameter = 2.0 * particles.radius[0];
    let height = particles.position.iter().map(|x| x.z).sum::<f64>() / count;
    let within = |distance: f64| neighbours(&particles.position, distance * diameter) / count;
    Ok([
        height,
        energies.kinetic,
        energies.contact,
        energies.electric.unwrap_or(0.0),
        simulation.contacts() as f64 / count,
        within(1.1),
        within(2.0),
    ])
}

/// Ordered pairs closer than a distance; x and y are periodic.
fn neighbours(positions: &[Vector3<f64>], distance: f64) -> f64 {
    let image = |d: f64| d - SIDE * (d / SIDE).round();
    let near = |a: &Vector3<f64>, b: &Vector3<f64>| {
        let d = a - b;
        Vector3::new(image(d.x), image(d.y), d.z).norm() < distance
    };
    let of = |(i, a): (usize, &Vector3<f64>)| {
        positions.iter().enumerate().filter(|&(j, b)| i != j && near(a, b)).count()
    };
    positions.iter().enumerate().map(of).sum::<usize>() as f64
}

fn mean_and_variance(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    (mean, values.map(|value| (value - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0))
}
