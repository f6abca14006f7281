//! Snapshot: the grains of a file at one time, in SI units, whichever program wrote it.

use super::units::Units;
use amberfield_core::{GroupId, MaterialId, Particles};
use nalgebra::Vector3;

/// Choices for files that do not say everything themselves.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SnapshotOptions {
    /// Unit style of a dump or a VTK file of LAMMPS or LIGGGHTS.
    pub units: Option<Units>,
    /// Step of the frame, in a file with several; the last one without.
    pub step: Option<u64>,
    /// Names of the materials of types 1, 2, …
    pub materials_by_type: Vec<String>,
}

/// Choices for a file that hold whatever its grains are read for.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct FileChoices {
    /// Unit style that the user names.
    pub(crate) units: Option<Units>,
    /// Step of the frame.
    pub(crate) step: Option<u64>,
}

/// Particles of a file or a generator.
#[derive(Debug)]
pub(crate) struct ReadParticles {
    /// Particles, in the order of the file.
    pub(crate) particles: Particles,
    /// Names of the groups, `all` first.
    pub(crate) groups: Vec<String>,
    /// Flag of charges that were given; without, all charges are 0.
    pub(crate) has_charge: bool,
}

impl From<Snapshot> for ReadParticles {
    fn from(snapshot: Snapshot) -> Self {
        Self { has_charge: snapshot.given.charge, particles: snapshot.particles, groups: snapshot.groups }
    }
}

/// Box of a snapshot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SnapshotBox {
    /// Lower corner [m].
    pub min_m: Vector3<f64>,
    /// Upper corner [m].
    pub max_m: Vector3<f64>,
    /// Axes along which the box repeats.
    pub is_periodic: [bool; 3],
}

/// Grains of a file at one time, in SI units.
///
/// All arrays have the same length and order, that of the file. What the file does not have is `None`.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// Step of the program that wrote the file.
    pub step: Option<u64>,
    /// Time [s].
    pub time_s: Option<f64>,
    /// Box.
    pub bounds: Option<SnapshotBox>,
    /// Names of the materials, to which [`Self::material_ids`] points.
    pub materials: Vec<String>,
    /// Names of the groups, to which [`Self::group_ids`] points; `all` is first.
    pub groups: Vec<String>,
    /// Columns of the file that were not read.
    pub unused: Vec<String>,
    pub(super) particles: Particles,
    pub(super) given: Given,
}

/// Flags of what a snapshot has beside places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// Radii.
    pub radius: bool,
    /// Charges.
    pub charge: bool,
    /// Velocities.
    pub velocity: bool,
    /// Angular velocities.
    pub angular_velocity: bool,
    /// Densities.
    pub density: bool,
    /// Materials.
    pub material: bool,
}

impl Given {
    /// Flags of grains that have everything.
    const ALL: Self = Self {
        radius: true,
        charge: true,
        velocity: true,
        angular_velocity: true,
        density: true,
        material: true,
    };
}

impl Snapshot {
    /// Snapshot of grains that have everything, without names, box and time.
    #[must_use]
    pub fn of(particles: Particles) -> Self {
        Self {
            step: None,
            time_s: None,
            bounds: None,
            materials: Vec::new(),
            groups: vec!["all".to_owned()],
            unused: Vec::new(),
            particles,
            given: Given::ALL,
        }
    }

    /// Snapshot of grains that have only what is given; their other numbers do not count.
    #[must_use]
    pub fn with(particles: Particles, given: Given) -> Self {
        Self { given, ..Self::of(particles) }
    }

    /// Number of grains.
    #[must_use]
    pub fn len(&self) -> usize {
        self.particles.len()
    }

    /// Whether there is no grain.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.particles.is_empty()
    }

    /// Grains with zeros for all that the file does not have.
    #[must_use]
    pub fn particles(&self) -> &Particles {
        &self.particles
    }

    /// Grains with zeros for all that the file does not have.
    #[must_use]
    pub fn into_particles(self) -> Particles {
        self.particles
    }

    /// Ids; 1, 2, … in a file without.
    #[must_use]
    pub fn ids(&self) -> &[u64] {
        &self.particles.id
    }

    /// Centres [m].
    #[must_use]
    pub fn positions_m(&self) -> &[Vector3<f64>] {
        &self.particles.position
    }

    /// Radii [m].
    #[must_use]
    pub fn radii_m(&self) -> Option<&[f64]> {
        self.given.radius.then_some(&self.particles.radius[..])
    }

    /// Charges [C].
    #[must_use]
    pub fn charges_c(&self) -> Option<&[f64]> {
        self.given.charge.then_some(&self.particles.charge[..])
    }

    /// Velocities [m/s].
    #[must_use]
    pub fn velocities_m_s(&self) -> Option<&[Vector3<f64>]> {
        self.given.velocity.then_some(&self.particles.velocity[..])
    }

    /// Angular velocities [rad/s].
    #[must_use]
    pub fn angular_velocities_rad_s(&self) -> Option<&[Vector3<f64>]> {
        self.given.angular_velocity.then_some(&self.particles.angular_velocity[..])
    }

    /// Densities [kg/m³], also where the file has masses.
    #[must_use]
    pub fn densities_kg_m3(&self) -> Option<&[f64]> {
        self.given.density.then_some(&self.particles.density[..])
    }

    /// Indices of the grains' materials in [`Self::materials`].
    #[must_use]
    pub fn material_ids(&self) -> Option<&[MaterialId]> {
        self.given.material.then_some(&self.particles.material[..])
    }

    /// Indices of the grains' groups in [`Self::groups`].
    #[must_use]
    pub fn group_ids(&self) -> &[GroupId] {
        &self.particles.group
    }
}

/// Columns of dumps that say nothing of what is read here: forces, images, ranks and the like.
const HARMLESS: [&str; 22] = [
    "ix", "iy", "iz", "fx", "fy", "fz", "tqx", "tqy", "tqz", "proc", "procp1", "mol", "element", "mux",
    "muy", "muz", "mu", "id", "type", "x", "y", "z",
];

impl Snapshot {
    /// Columns that were not read, without those that are no property of a grain, or another form of one that
    /// was read.
    pub(crate) fn unused_quantities(&self) -> Vec<&str> {
        let is_harmless = |name: &str| {
            HARMLESS.contains(&name)
                || ["xu", "yu", "zu", "xs", "ys", "zs", "xsu", "ysu", "zsu"].contains(&name)
        };
        self.unused.iter().map(String::as_str).filter(|name| !is_harmless(name)).collect()
    }
}
