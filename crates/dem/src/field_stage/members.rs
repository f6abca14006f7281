//! Who makes and feels the field.

use crate::grains::Grains;
use amberfield_core::{Domain, Particles, Vector3};

/// Members of the field: sorted indices, positions inside the domain, charges.
#[derive(Debug, Default)]
pub(crate) struct Members {
    pub(super) index: Vec<u32>,
    pub(super) position: Vec<Vector3<f64>>,
    pub(super) charge: Vec<f64>,
    /// Grains, members or not.
    pub(super) count: usize,
}

impl Members {
    pub(super) fn collect(
        &mut self,
        member: &[bool],
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
    ) {
        self.index.clear();
        self.position.clear();
        self.charge.clear();
        self.count = grains.len();
        for (i, &original) in grains.original.iter().enumerate() {
            if member[original as usize] {
                self.index.push(i as u32);
                self.position.push(domain.wrap(grains.position(i)));
                self.charge.push(particles.charge[original as usize]);
            }
        }
    }
}
