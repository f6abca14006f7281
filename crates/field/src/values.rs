//! Results of an evaluation, and the arithmetic of a field and its potential at one place.

use nalgebra::Vector3;
use std::ops::{Add, AddAssign, Mul, Sub, SubAssign};

/// Field and potential at one place; zero by default. Levels that sum over charges leave Coulomb's constant
/// out (4πε = 1): their E is in C/m² and their potential in C/m until it multiplies them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FieldAt {
    /// E [V/m].
    pub e: Vector3<f64>,
    /// Potential [V].
    pub potential: f64,
}

impl FieldAt {
    /// A potential [V] without a field.
    #[must_use]
    pub fn of_potential(potential: f64) -> Self {
        Self { potential, ..Self::default() }
    }
}

impl Add for FieldAt {
    type Output = Self;

    #[inline]
    fn add(self, other: Self) -> Self {
        Self { e: self.e + other.e, potential: self.potential + other.potential }
    }
}

impl Sub for FieldAt {
    type Output = Self;

    #[inline]
    fn sub(self, other: Self) -> Self {
        Self { e: self.e - other.e, potential: self.potential - other.potential }
    }
}

impl AddAssign for FieldAt {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for FieldAt {
    #[inline]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Mul<f64> for FieldAt {
    type Output = Self;

    #[inline]
    fn mul(self, factor: f64) -> Self {
        Self { e: self.e * factor, potential: self.potential * factor }
    }
}

impl Mul<FieldAt> for f64 {
    type Output = FieldAt;

    #[inline]
    fn mul(self, field: FieldAt) -> FieldAt {
        field * self
    }
}

/// Results that an evaluation is asked for beyond E; what is not asked for is not computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wanted {
    /// The potential.
    pub potential: bool,
    /// The parts of E by level.
    pub components: bool,
}

/// Parts of E [V/m], one vector per particle, in the order of the sum; a part that is not there is zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Components {
    /// Pairs (and their images) within the cut-off radius.
    pub near: Vec<Vector3<f64>>,
    /// Middle grid, only with a field solver's mesh.
    pub middle: Vec<Vector3<f64>>,
    /// Everything smooth: the internal grid, modes of the box, or a mesh with its boundary conditions.
    pub far: Vec<Vector3<f64>>,
    /// Correction of what near and far would count twice.
    pub correction: Vec<Vector3<f64>>,
    /// Potentials and normal fields of the faces; zero where a mesh has them in its boundary conditions.
    pub faces: Vec<Vector3<f64>>,
    /// The external field.
    pub external: Vec<Vector3<f64>>,
}

/// Field at the particles, in the order in which they were given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FieldValues {
    /// E [V/m] without the particle's own singular field, with its own images.
    pub e: Vec<Vector3<f64>>,
    /// Potential [V] without the particle's own singular term; empty unless asked for.
    pub potential: Vec<f64>,
    /// Parts of E; empty vectors unless asked for.
    pub components: Components,
}
