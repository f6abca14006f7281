//! Groups whose grains never move.

use crate::SceneError;
use crate::particles::ReadParticles;
use crate::table::SceneTable;
use crate::tree::nearest;
use amberfield_core::GroupId;
use nalgebra::Vector3;

/// Reads `fixed_groups` into the particles. Grains of another run come to rest (`is_filled`); others must be
/// at rest.
pub(super) fn fix_groups(
    table: &SceneTable<'_>,
    read: &mut ReadParticles,
    is_filled: bool,
) -> Result<(), SceneError> {
    let Some(names) = table.words("fixed_groups")? else { return Ok(()) };
    for name in names {
        read.particles.fixed_groups.extend(groups_of(table, name, &read.groups)?);
    }
    let particles = &mut read.particles;
    for index in 0..particles.len() {
        if !particles.is_fixed(index) {
            continue;
        }
        let motion = [particles.velocity[index], particles.angular_velocity[index]];
        if !is_filled && motion.iter().any(|vector| vector.norm() != 0.0) {
            let group = &read.groups[usize::from(particles.group[index].0)];
            return Err(table.bad(
                "fixed_groups",
                format!(
                    "grain {} of group \"{group}\" has a velocity or an angular velocity, but is never to \
                     move; give it zeros, or take the group out",
                    particles.id[index]
                ),
            ));
        }
        particles.velocity[index] = Vector3::zeros();
        particles.angular_velocity[index] = Vector3::zeros();
    }
    Ok(())
}

/// Groups that a name stands for: `all` are all of them.
fn groups_of(table: &SceneTable<'_>, name: &str, groups: &[String]) -> Result<Vec<GroupId>, SceneError> {
    let numbered = || (0_u16..).map(GroupId).zip(groups);
    if name == "all" {
        return Ok(numbered().map(|(id, _)| id).collect());
    }
    if let Some((id, _)) = numbered().find(|(_, known)| *known == name) {
        return Ok(vec![id]);
    }
    let names: Vec<&str> = groups.iter().map(String::as_str).collect();
    let near = nearest(name, &names).unwrap_or("all");
    Err(table
        .bad("fixed_groups", format!("no grain is in the group \"{name}\"; the nearest group is \"{near}\"")))
}
