//! Files of LAMMPS and LIGGGHTS: text dump and data file of spheres with charge.

use super::atomic::write_atomically;
use crate::SceneError;
use crate::particles::{Factors, Snapshot, SnapshotBox, Units};
use nalgebra::Vector3;
use std::f64::consts::PI;
use std::io::{self, Write};
use std::path::Path;

/// Largest id that LAMMPS takes in its usual build.
const LARGEST_ID: u64 = 0x7fff_ffff;

/// Writes a text dump (`dump custom`) with all that the snapshot has; numbers have 17 digits.
///
/// # Errors
/// Errors of the operating system.
pub(super) fn write_dump(path: &Path, snapshot: &Snapshot, units: Units) -> Result<(), SceneError> {
    let factors = units.factors();
    let bounds = bounds_of(snapshot);
    write_atomically(path, |writer| {
        writeln!(writer, "ITEM: UNITS\n{}", units.name())?;
        if let Some(time) = snapshot.time_s {
            writeln!(writer, "ITEM: TIME\n{:.16e}", time / factors.time)?;
        }
        writeln!(writer, "ITEM: TIMESTEP\n{}", snapshot.step.unwrap_or(0))?;
        writeln!(writer, "ITEM: NUMBER OF ATOMS\n{}", snapshot.len())?;
        let flags = bounds.is_periodic.map(|is_periodic| if is_periodic { "pp" } else { "ff" });
        writeln!(writer, "ITEM: BOX BOUNDS {}", flags.join(" "))?;
        for axis in 0..3 {
            let ends = [bounds.min_m[axis], bounds.max_m[axis]].map(|end| end / factors.length);
            writeln!(writer, "{:.16e} {:.16e}", ends[0], ends[1])?;
        }
        let columns = DumpColumns::of(snapshot);
        writeln!(writer, "ITEM: ATOMS {}", columns.names())?;
        (0..snapshot.len()).try_for_each(|index| columns.write(writer, snapshot, &factors, index))
    })
}

/// Columns of a dump beside id, type and place.
struct DumpColumns {
    velocity: bool,
    spin: bool,
    radius: bool,
    density: bool,
    charge: bool,
}

impl DumpColumns {
    fn of(snapshot: &Snapshot) -> Self {
        Self {
            velocity: snapshot.velocities_m_s().is_some(),
            spin: snapshot.angular_velocities_rad_s().is_some(),
            radius: snapshot.radii_m().is_some(),
            density: snapshot.densities_kg_m3().is_some(),
            charge: snapshot.charges_c().is_some(),
        }
    }

    fn names(&self) -> String {
        let groups = [
            (true, "id type x y z"),
            (self.velocity, "vx vy vz"),
            (self.spin, "omegax omegay omegaz"),
            (self.radius, "radius"),
            // Mass is what other programs read; the density is exact.
            (self.density && self.radius, "mass"),
            (self.density, "density"),
            (self.charge, "q"),
        ];
        let present = groups.into_iter().filter(|(is_there, _)| *is_there);
        present.map(|(_, names)| names).collect::<Vec<_>>().join(" ")
    }

    fn write(
        &self,
        writer: &mut dyn Write,
        snapshot: &Snapshot,
        factors: &Factors,
        index: usize,
    ) -> io::Result<()> {
        let grain = snapshot.particles().grain(index);
        write!(writer, "{} {}", grain.id, u32::from(grain.material.0) + 1)?;
        write_vector(writer, &grain.position, factors.length)?;
        if self.velocity {
            write_vector(writer, &grain.velocity, factors.velocity)?;
        }
        if self.spin {
            write_vector(writer, &grain.angular_velocity, 1.0 / factors.time)?;
        }
        if self.radius {
            write!(writer, " {:.16e}", grain.radius / factors.length)?;
        }
        if self.density && self.radius {
            let mass = 4.0 / 3.0 * PI * grain.radius.powi(3) * grain.density;
            write!(writer, " {:.16e}", mass / factors.mass)?;
        }
        if self.density {
            write!(writer, " {:.16e}", grain.density / factors.density)?;
        }
        if self.charge {
            write!(writer, " {:.16e}", grain.charge / factors.charge)?;
        }
        writeln!(writer)
    }
}

fn write_vector(writer: &mut dyn Write, vector: &Vector3<f64>, unit: f64) -> io::Result<()> {
    vector.iter().try_for_each(|number| write!(writer, " {:.16e}", number / unit))
}

/// Writes a data file for `atom_style hybrid sphere charge` (`read_data` of LAMMPS); numbers have 17 digits.
///
/// # Errors
/// Grains without radius or density, ids that LAMMPS does not take, and errors of the operating system.
pub(super) fn write_data(path: &Path, snapshot: &Snapshot, units: Units) -> Result<(), SceneError> {
    let refuse = |problem: String| SceneError::Unwritable { path: path.to_path_buf(), reason: problem };
    let point = snapshot.particles().radius.iter().position(|radius| *radius == 0.0);
    let grain = |index: usize| snapshot.ids()[index];
    if snapshot.radii_m().is_none() || snapshot.densities_kg_m3().is_none() {
        return Err(refuse(
            "a data file needs radii and densities or masses, and the grains have none".to_owned(),
        ));
    }
    if let Some(index) = point {
        return Err(refuse(format!("a data file needs a radius, and grain {} has none", grain(index))));
    }
    if let Some(id) = snapshot.ids().iter().find(|id| !(1..=LARGEST_ID).contains(*id)) {
        return Err(refuse(format!(
            "LAMMPS takes ids from 1 to {LARGEST_ID}, and a grain has {id}; give others"
        )));
    }
    let (factors, bounds) = (units.factors(), bounds_of(snapshot));
    let particles = snapshot.particles();
    let types = particles.material.iter().map(|material| u32::from(material.0) + 1).max().unwrap_or(1);
    write_atomically(path, |writer| {
        writeln!(
            writer,
            "LAMMPS data file of amberfield: units = {}, atom_style = hybrid sphere charge\n\n\
             {} atoms\n{types} atom types\n",
            units.name(),
            snapshot.len()
        )?;
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let ends = [bounds.min_m[axis], bounds.max_m[axis]].map(|end| end / factors.length);
            writeln!(writer, "{:.16e} {:.16e} {name}lo {name}hi", ends[0], ends[1])?;
        }
        writeln!(writer, "\nAtoms # hybrid\n")?;
        for index in 0..snapshot.len() {
            let grain = particles.grain(index);
            write!(writer, "{} {}", grain.id, u32::from(grain.material.0) + 1)?;
            write_vector(writer, &grain.position, factors.length)?;
            let (diameter, density) = (2.0 * grain.radius / factors.length, grain.density / factors.density);
            writeln!(writer, " {diameter:.16e} {density:.16e} {:.16e}", grain.charge / factors.charge)?;
        }
        writeln!(writer, "\nVelocities\n")?;
        for index in 0..snapshot.len() {
            let grain = particles.grain(index);
            write!(writer, "{}", grain.id)?;
            write_vector(writer, &grain.velocity, factors.velocity)?;
            write_vector(writer, &grain.angular_velocity, 1.0 / factors.time)?;
            writeln!(writer)?;
        }
        Ok(())
    })
}

/// Box of a snapshot, or one around its grains.
fn bounds_of(snapshot: &Snapshot) -> SnapshotBox {
    snapshot.bounds.unwrap_or_else(|| {
        let grains = snapshot.positions_m().iter().zip(&snapshot.particles().radius);
        let start = (Vector3::repeat(f64::INFINITY), Vector3::repeat(f64::NEG_INFINITY));
        let (min_m, max_m) = grains.fold(start, |(min, max), (place, radius)| {
            (min.inf(&place.add_scalar(-radius)), max.sup(&place.add_scalar(*radius)))
        });
        SnapshotBox { min_m, max_m, is_periodic: [false; 3] }
    })
}
