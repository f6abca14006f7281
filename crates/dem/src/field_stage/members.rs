//! Grains that make and feel the field, and other charges and places in an evaluation.

use crate::motion::grains::Grains;
use amberfield_core::{Domain, Particles, Vector3};

/// Members of the field: sorted indices, positions inside the domain, charges. The last two go on with what
/// is beside the grains.
#[derive(Debug, Default)]
pub(crate) struct Members {
    pub(super) index: Vec<u32>,
    pub(super) position: Vec<Vector3<f64>>,
    pub(super) charge: Vec<f64>,
    /// Grains, members or not.
    pub(super) count: usize,
    /// Time of the last evaluation that the motion sees [s].
    pub(super) time_s: f64,
}

/// Moment of an evaluation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Moment {
    /// Time of the run [s].
    pub(crate) time_s: f64,
    /// Length of the step [s].
    pub(crate) step_s: f64,
}

/// Charges for which a field chooses its parameters.
#[derive(Clone, Copy, Debug)]
pub(super) struct Charges<'a> {
    /// Positions inside the domain [m].
    pub(super) position: &'a [Vector3<f64>],
    /// Charges [C].
    pub(super) charge: &'a [f64],
}

/// Charges of walls, and places without charge at which E is asked for: the part of an evaluation that is
/// beside the grains.
#[derive(Debug, Default)]
pub(crate) struct Extras {
    position: Vec<Vector3<f64>>,
    charge: Vec<f64>,
    /// Gain of E at grains near charges of walls, which are no points [V/m]; sorted indices, ascending.
    pub(crate) gained: Vec<(u32, Vector3<f64>)>,
}

impl Extras {
    pub(crate) fn clear(&mut self) {
        self.position.clear();
        self.charge.clear();
        self.gained.clear();
    }

    /// Adds what E gains at grains to E [V/m] of the members with these sorted indices.
    pub(super) fn add_gained(&self, members: &[u32], e: &mut [Vector3<f64>]) {
        for (grain, gained) in &self.gained {
            if let Ok(member) = members.binary_search(grain) {
                e[member] += gained;
            }
        }
    }

    /// A place inside the domain [m] and its charge [C].
    pub(crate) fn push(&mut self, position: Vector3<f64>, charge: f64) {
        self.position.push(position);
        self.charge.push(charge);
    }
}

impl Members {
    pub(super) fn collect(
        &mut self,
        member: &[bool],
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
        extras: &Extras,
    ) {
        self.index.clear();
        self.position.clear();
        self.charge.clear();
        self.count = grains.len();
        for (i, &original) in grains.original.iter().enumerate() {
            if member[original.index()] {
                self.index.push(i as u32);
                self.position.push(domain.wrap(grains.position(i)));
                self.charge.push(particles.charge[original.index()]);
            }
        }
        self.position.extend(&extras.position);
        self.charge.extend(&extras.charge);
    }
}
