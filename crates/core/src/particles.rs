//! The particle arrays.

use crate::material::MaterialId;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Index into the scene's list of group names; 0 is the group `all` that grains without a group belong to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct GroupId(pub u16);

/// One grain, as read from a file or made by a generator.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Grain {
    /// Unique id.
    pub id: u64,
    /// Centre [m].
    pub position: Vector3<f64>,
    /// Velocity [m/s].
    pub velocity: Vector3<f64>,
    /// Angular velocity [rad/s].
    pub angular_velocity: Vector3<f64>,
    /// Radius [m].
    pub radius: f64,
    /// Density [kg/m³].
    pub density: f64,
    /// Charge [C].
    pub charge: f64,
    /// Material.
    pub material: MaterialId,
    /// Group.
    pub group: GroupId,
}

/// Grains as a structure of arrays; every array of grains has the same length and order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Particles {
    /// Unique ids.
    pub id: Vec<u64>,
    /// Centres [m].
    pub position: Vec<Vector3<f64>>,
    /// Velocities [m/s].
    pub velocity: Vec<Vector3<f64>>,
    /// Angular velocities [rad/s].
    pub angular_velocity: Vec<Vector3<f64>>,
    /// Radii [m].
    pub radius: Vec<f64>,
    /// Densities [kg/m³].
    pub density: Vec<f64>,
    /// Charges [C].
    pub charge: Vec<f64>,
    /// Materials.
    pub material: Vec<MaterialId>,
    /// Groups.
    pub group: Vec<GroupId>,
    /// Groups whose grains never move nor turn.
    pub fixed_groups: Vec<GroupId>,
}

impl Particles {
    /// Number of grains.
    #[must_use]
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Whether there is no grain.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// Appends a grain.
    pub fn push(&mut self, grain: Grain) {
        self.id.push(grain.id);
        self.position.push(grain.position);
        self.velocity.push(grain.velocity);
        self.angular_velocity.push(grain.angular_velocity);
        self.radius.push(grain.radius);
        self.density.push(grain.density);
        self.charge.push(grain.charge);
        self.material.push(grain.material);
        self.group.push(grain.group);
    }

    /// Appends all grains of other arrays.
    pub fn append(&mut self, others: &Self) {
        (0..others.len()).for_each(|index| self.push(others.grain(index)));
    }

    /// The grain at an index.
    ///
    /// # Panics
    /// When the index is out of range.
    #[must_use]
    pub fn grain(&self, index: usize) -> Grain {
        Grain {
            id: self.id[index],
            position: self.position[index],
            velocity: self.velocity[index],
            angular_velocity: self.angular_velocity[index],
            radius: self.radius[index],
            density: self.density[index],
            charge: self.charge[index],
            material: self.material[index],
            group: self.group[index],
        }
    }

    /// Whether the grain at an index never moves.
    ///
    /// # Panics
    /// When the index is out of range.
    #[must_use]
    pub fn is_fixed(&self, index: usize) -> bool {
        self.fixed_groups.contains(&self.group[index])
    }

    /// Indices of the grains that move.
    pub fn moving(&self) -> impl Iterator<Item = usize> {
        (0..self.len()).filter(|&index| !self.is_fixed(index))
    }

    /// Mass m = (4/3)πr³ρ [kg] of the grain at an index.
    ///
    /// # Panics
    /// When the index is out of range.
    #[must_use]
    pub fn mass(&self, index: usize) -> f64 {
        4.0 / 3.0 * std::f64::consts::PI * self.radius[index].powi(3) * self.density[index]
    }

    /// Sum of all charges [C].
    #[must_use]
    pub fn net_charge(&self) -> f64 {
        self.charge.iter().sum()
    }
}

impl FromIterator<Grain> for Particles {
    fn from_iter<T: IntoIterator<Item = Grain>>(grains: T) -> Self {
        let mut particles = Self::default();
        for grain in grains {
            particles.push(grain);
        }
        particles
    }
}
