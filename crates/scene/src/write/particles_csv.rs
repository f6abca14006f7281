//! CSV of particles, with the columns that scenes read.

use super::atomic::write_atomically;
use crate::SceneError;
use crate::files::GRAINS_CSV;
use amberfield_core::{Material, Particles};
use std::path::Path;

/// Writes grains with all columns.
///
/// Numbers have 17 significant digits, so that they are read back bit for bit.
///
/// # Errors
/// Errors of the operating system.
pub fn write_particles_csv(
    path: &Path,
    particles: &Particles,
    materials: &[Material],
    groups: &[String],
) -> Result<(), SceneError> {
    let material_names: Vec<String> = materials.iter().map(|material| quoted(&material.name)).collect();
    let group_names: Vec<String> = groups.iter().map(|group| quoted(group)).collect();
    write_atomically(path, |writer| {
        writeln!(writer, "{}", GRAINS_CSV.heading().join(","))?;
        for index in 0..particles.len() {
            let grain = particles.grain(index);
            let (x, v, w) = (grain.position, grain.velocity, grain.angular_velocity);
            write!(writer, "{},{:.16e},{:.16e},{:.16e},", grain.id, x.x, x.y, x.z)?;
            write!(writer, "{:.16e},{:.16e},", grain.radius, grain.charge)?;
            write!(writer, "{:.16e},{:.16e},{:.16e},{:.16e},{:.16e},{:.16e},", v.x, v.y, v.z, w.x, w.y, w.z)?;
            let material = material_names.get(usize::from(grain.material.0)).map_or("", String::as_str);
            let group = group_names.get(usize::from(grain.group.0)).map_or("all", String::as_str);
            writeln!(writer, "{:.16e},{material},{group}", grain.density)?;
        }
        Ok(())
    })
}

/// Quotes a name that has separators in it.
pub(super) fn quoted(name: &str) -> String {
    if name.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", name.replace('"', "\"\""))
    } else {
        name.to_owned()
    }
}
