//! Snapshots as files of this and other programs.

use super::atomic::write_atomically;
use super::lammps::{write_data, write_dump};
use super::particles_csv::quoted;
use super::vtu::{Named, Values, write_grains};
use crate::SceneError;
use crate::particles::{Snapshot, Units};
use std::path::Path;

/// Endings of the files that are written, and what they are.
const ENDINGS: &str = ".csv (table), .vtu (ParaView), .lammpstrj or .dump (dump of LAMMPS), .data (data \
                       file of LAMMPS)";

/// Writes a snapshot in the form that the file's ending names: `.csv`, `.vtu`, `.lammpstrj` or `.dump`
/// (text dump of LAMMPS), `.data` (data file of LAMMPS).
///
/// Units other than SI are for dumps and data files. What the snapshot does not have is left out.
///
/// # Errors
/// Other endings, grains that lack what the form needs, and errors of the operating system.
pub fn write_snapshot(path: &Path, snapshot: &Snapshot, units: Units) -> Result<(), SceneError> {
    let refuse = |reason: String| SceneError::Unwritable { path: path.to_path_buf(), reason };
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_ascii_lowercase());
    match (ending.as_deref().unwrap_or_default(), units) {
        ("lammpstrj" | "dump", units) => write_dump(path, snapshot, units),
        ("data", units) => write_data(path, snapshot, units),
        ("csv", Units::Si) => write_csv(path, snapshot),
        ("vtu", Units::Si) => write_vtu(path, snapshot),
        ("csv" | "vtu", _) => {
            Err(refuse(format!("this form is in SI units, not {}; leave the units out", units.name())))
        }
        _ => Err(refuse(format!("its ending says no form; name a file {ENDINGS}"))),
    }
}

/// Writes a table with the columns that the snapshot has; numbers have 17 digits.
fn write_csv(path: &Path, snapshot: &Snapshot) -> Result<(), SceneError> {
    let materials: Vec<String> = snapshot.materials.iter().map(|name| quoted(name)).collect();
    let groups: Vec<String> = snapshot.groups.iter().map(|name| quoted(name)).collect();
    let (radii, charges) = (snapshot.radii_m(), snapshot.charges_c());
    let (velocities, spins) = (snapshot.velocities_m_s(), snapshot.angular_velocities_rad_s());
    let densities = snapshot.densities_kg_m3();
    let material_ids = snapshot.material_ids().filter(|_| !materials.is_empty());
    let is_grouped = groups.len() > 1;
    let columns = [
        (true, "id,x_m,y_m,z_m"),
        (radii.is_some(), "radius_m"),
        (charges.is_some(), "charge_C"),
        (velocities.is_some(), "vx_m_s,vy_m_s,vz_m_s"),
        (spins.is_some(), "wx_rad_s,wy_rad_s,wz_rad_s"),
        (densities.is_some(), "density_kg_m3"),
        (material_ids.is_some(), "material"),
        (is_grouped, "group"),
    ];
    let header: Vec<&str> =
        columns.iter().filter(|(is_there, _)| *is_there).map(|(_, names)| *names).collect();
    write_atomically(path, |writer| {
        writeln!(writer, "{}", header.join(","))?;
        for index in 0..snapshot.len() {
            write!(writer, "{}", snapshot.ids()[index])?;
            let place = snapshot.positions_m()[index];
            let numbers = place
                .iter()
                .chain(radii.map(|list| &list[index]))
                .chain(charges.map(|list| &list[index]))
                .chain(velocities.map(|list| &list[index]).into_iter().flatten())
                .chain(spins.map(|list| &list[index]).into_iter().flatten())
                .chain(densities.map(|list| &list[index]));
            for number in numbers {
                write!(writer, ",{number:.16e}")?;
            }
            if let Some(ids) = material_ids {
                let name = materials.get(usize::from(ids[index].0)).map_or("", String::as_str);
                write!(writer, ",{name}")?;
            }
            if is_grouped {
                let name =
                    groups.get(usize::from(snapshot.group_ids()[index].0)).map_or("all", String::as_str);
                write!(writer, ",{name}")?;
            }
            writeln!(writer)?;
        }
        Ok(())
    })
}

/// Writes a file for ParaView with the arrays that the snapshot has, and the names of materials and groups.
fn write_vtu(path: &Path, snapshot: &Snapshot) -> Result<(), SceneError> {
    let particles = snapshot.particles();
    let mut arrays: Vec<Named<'_>> = vec![("id", Values::Ids(&particles.id))];
    arrays.extend(snapshot.radii_m().map(|radii| ("radius_m", Values::Numbers(radii))));
    arrays.extend(snapshot.charges_c().map(|charges| ("charge_C", Values::Numbers(charges))));
    arrays.extend(snapshot.velocities_m_s().map(|list| ("velocity_m_s", Values::Vectors(list))));
    let spins = snapshot.angular_velocities_rad_s();
    arrays.extend(spins.map(|list| ("angular_velocity_rad_s", Values::Vectors(list))));
    arrays.extend(snapshot.densities_kg_m3().map(|list| ("density_kg_m3", Values::Numbers(list))));
    let materials = snapshot.material_ids().map(|ids| ids.iter().map(|id| id.0).collect());
    arrays.extend(materials.map(|numbers| ("material", Values::Groups(numbers))));
    arrays.push(("group", Values::Groups(snapshot.group_ids().iter().map(|id| id.0).collect())));
    let names = [("materials", &snapshot.materials[..]), ("groups", &snapshot.groups[..])];
    write_grains(path, &particles.position, &arrays, &field_data(&names))
}

/// Element with lists of names: their bytes as numbers, each name with a 0 at its end.
fn field_data(lists: &[(&str, &[String])]) -> String {
    let arrays = lists.iter().filter(|(_, names)| !names.is_empty()).map(|(list, names)| {
        let bytes = names.iter().flat_map(|name| name.bytes().filter(|byte| *byte != 0).chain([0]));
        let bytes: Vec<String> = bytes.map(|byte| byte.to_string()).collect();
        format!(
            "<DataArray type=\"String\" Name=\"{list}\" NumberOfTuples=\"{}\" format=\"ascii\">{}\
             </DataArray>\n",
            names.len(),
            bytes.join(" ")
        )
    });
    format!("<FieldData>\n{}</FieldData>\n", arrays.collect::<String>())
}
