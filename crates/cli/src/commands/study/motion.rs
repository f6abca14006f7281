//! A run of a study.

use crate::run::{SolverFolder, begin, connect_solver, read_scene, setup_of};
use amberfield_core::Vector3;
use amberfield_dem::ElectricEnergy;
use amberfield_scene::Purpose;
use amberfield_study::sweep::Moved;
use std::path::Path;
use std::time::Instant;

/// Runs a scene to its end; `nudge` displaces its grains by so many radii, every other one the other way.
pub(super) fn simulate(scene: &Path, set: &[String], nudge: f64, looks: usize) -> Result<Moved, String> {
    let said = |failure: crate::failure::Failure| failure.message().to_owned();
    let folder = SolverFolder::temporary().map_err(said)?;
    let mut scene = read_scene(scene, set, Purpose::Run, &folder).map_err(said)?;
    let particles = &mut scene.particles;
    for (index, (position, radius)) in particles.position.iter_mut().zip(&particles.radius).enumerate() {
        let way = nudge * radius;
        *position += Vector3::repeat(if index % 2 == 0 { way } else { -way });
    }
    let solver = connect_solver(&mut scene, &folder).map_err(said)?;
    let setup = setup_of(&mut scene, None, solver).map_err(said)?;
    let (domain, end_s) = (setup.domain.clone(), setup.time.end_s);
    let mut run = begin(&scene, setup).map_err(said)?;
    let start = run.particles();
    // Without the jumps by a period.
    let (mut before, mut now) = (start.position.clone(), start.position.clone());
    let mut moved =
        Moved { end_s, positions: vec![start.position], charges: vec![start.charge], ..Moved::default() };
    let begun = Instant::now();
    for look in 1..=looks {
        let until = end_s * look as f64 / looks as f64 - 0.5 * run.step_s();
        while run.time_s() < until {
            run.step().map_err(|error| error.to_string())?;
        }
        let particles = run.particles();
        if particles.len() != now.len() {
            return Err("grains have left the domain: their trajectories end there".to_owned());
        }
        for ((now, before), place) in now.iter_mut().zip(&mut before).zip(&particles.position) {
            *now += domain.shortest(place - *before);
            *before = *place;
        }
        moved.positions.push(now.clone());
        moved.charges.push(particles.charge);
    }
    moved.seconds = begun.elapsed().as_secs_f64();
    moved.steps = run.step_index();
    moved.evaluations = run.intervals().map_or(0, |intervals| intervals.evaluations);
    moved.kinetic_j = run.energies(ElectricEnergy::LeftOut).map_err(|error| error.to_string())?.kinetic;
    moved.contacts_per_grain = run.contacts() as f64 / run.len().max(1) as f64;
    Ok(moved)
}
