//! Grains of another run, from one of its checkpoints.

use super::description::Filled;
use super::physics::Physics;
use crate::SceneError;
use crate::checkpoint::{Parts, SavedGrains, checkpoints, decode};
use crate::materials::Materials;
use crate::particles::ReadParticles;
use crate::source::{SceneSource, read_bytes};
use crate::table::SceneTable;
use amberfield_core::{Domain, Fingerprint, MaterialId, Particles};
use std::path::PathBuf;

/// Reads the grains of a checkpoint, or of the newest one of a run folder.
pub(super) fn read_filled(
    table: &SceneTable<'_>,
    from: &str,
    domain: Option<&Domain>,
    materials: &Materials,
    source: &mut SceneSource,
) -> Result<(ReadParticles, Filled), SceneError> {
    let checkpoint = checkpoint_of(table, from, source)?;
    let bytes = read_bytes(&checkpoint).map_err(|reason| table.bad("from", reason))?;
    let mut print = Fingerprint::new();
    print.add(&bytes);
    source.add(from, &print);
    let file = checkpoint.display().to_string();
    let bad = |problem: String| table.bad("from", format!("{file} {problem}"));
    let parts = Parts::of(&bytes).map_err(bad)?;
    let unreadable =
        |error| bad(format!("has grains that cannot be read ({error}); take another checkpoint"));
    let saved: SavedGrains = decode(parts.grains).map_err(unreadable)?;
    let physics: Physics = decode(parts.physics).map_err(unreadable)?;
    let SavedGrains { mut particles, groups, rules } = saved;
    if !is_sound(&particles, groups.len(), rules.materials.len()) {
        return Err(bad("has grains whose numbers do not fit together; take another checkpoint".to_owned()));
    }
    if particles.is_empty() {
        return Err(bad("has no grains: all of them have left; take an earlier checkpoint".to_owned()));
    }
    // What never moved there may move here.
    particles.fixed_groups.clear();
    let names: Vec<&str> = rules.materials.iter().map(|material| material.name.as_str()).collect();
    rename(&mut particles, &names, materials, &file)?;
    if let Some(domain) = domain {
        refuse_outside(&particles, domain, &file)?;
    }
    let filled = Filled { checkpoint, rules, is_same: false, physics, print: print.value() };
    Ok((ReadParticles { particles, groups, has_charge: true }, filled))
}

/// Path of a checkpoint; a run folder, and its folder of checkpoints, stand for the newest one.
fn checkpoint_of(table: &SceneTable<'_>, from: &str, source: &SceneSource) -> Result<PathBuf, SceneError> {
    let path = source.path(from);
    if !path.is_dir() {
        return Ok(path);
    }
    let newest = [path.join("checkpoints"), path.clone()].iter().find_map(|folder| checkpoints(folder).pop());
    newest.ok_or_else(|| {
        let problem = format!(
            "{} has no checkpoints/*.amber; name a run folder that has, or a checkpoint",
            path.display()
        );
        table.bad("from", problem)
    })
}

/// Whether arrays have one length, and numbers stand for groups and materials that there are.
fn is_sound(particles: &Particles, groups: usize, materials: usize) -> bool {
    let count = particles.len();
    let lengths = [
        particles.position.len(),
        particles.velocity.len(),
        particles.angular_velocity.len(),
        particles.radius.len(),
        particles.density.len(),
        particles.charge.len(),
        particles.material.len(),
        particles.group.len(),
    ];
    lengths.iter().all(|length| *length == count)
        && particles.group.iter().all(|group| usize::from(group.0) < groups)
        && particles.material.iter().all(|material| usize::from(material.0) < materials)
}

/// Turns numbers of the other scene's materials into those of this scene, by their names.
fn rename(
    particles: &mut Particles,
    names: &[&str],
    materials: &Materials,
    file: &str,
) -> Result<(), SceneError> {
    let found: Vec<Result<MaterialId, String>> = names.iter().map(|name| materials.find(name)).collect();
    for (material, id) in particles.material.iter_mut().zip(&particles.id) {
        let number = usize::from(material.0);
        *material = found[number].clone().map_err(|problem| {
            let problem = format!(
                "grain {id} is of \"{}\": {problem}; give [[materials]] with the names of that run",
                names[number]
            );
            SceneError::file(file, problem)
        })?;
    }
    Ok(())
}

/// Refuses grains outside the domain.
fn refuse_outside(particles: &Particles, domain: &Domain, file: &str) -> Result<(), SceneError> {
    let mut outside = (0..particles.len()).filter(|&index| !domain.contains(&particles.position[index]));
    let Some(first) = outside.next() else { return Ok(()) };
    let (count, place) = (1 + outside.count(), particles.position[first]);
    let problem = format!(
        "{count} grain(s) lie outside the domain, of them grain {} at ({}, {}, {}) m; enlarge the domain, or \
         let them leave that run first",
        particles.id[first], place.x, place.y, place.z
    );
    Err(SceneError::file(file, problem))
}
