//! Grains of other ranks that lie, with their images, within the cut-off radius of a rank's own.

use crate::error::FieldError;
use crate::geometry::images::{BoundingBox, ImageLattice, without_images};
use crate::ranks::{Parcels, Ranks};
use amberfield_core::Domain;
use nalgebra::Vector3;

/// Numbers that travel for a grain: its place and its charge.
const NUMBERS: usize = 4;

/// Exchange of grains that are near other ranks' grains.
#[derive(Debug)]
pub(crate) struct Ghosts {
    domain: Domain,
    lattice: ImageLattice,
    /// Cut-off radius [m].
    radius: f64,
    sent: Parcels,
    received: Parcels,
}

impl Ghosts {
    pub(crate) fn new(domain: &Domain, radius: f64) -> Self {
        Self {
            domain: domain.clone(),
            lattice: ImageLattice::new(domain),
            radius,
            sent: Parcels::default(),
            received: Parcels::default(),
        }
    }

    pub(crate) fn memory_bytes(&self) -> usize {
        self.sent.memory_bytes() + self.received.memory_bytes()
    }

    /// Appends the charged grains of other ranks that are near. `boxes` are those around the grains of each
    /// rank; positions and radius in m.
    pub(crate) fn append(
        &mut self,
        ranks: &dyn Ranks,
        boxes: &[Option<BoundingBox>],
        positions: &mut Vec<Vector3<f64>>,
        charges: &mut Vec<f64>,
    ) -> Result<(), FieldError> {
        self.sent.clear();
        for (rank, target) in boxes.iter().enumerate() {
            if let (Some(target), Some(own)) = (target, &boxes[ranks.rank()])
                && rank != ranks.rank()
                && self.lattice.reaches(own, target, self.radius)
            {
                self.pack(target, positions, charges);
            }
            self.sent.end_parcel();
        }
        ranks.exchange_of_any_size(&self.sent, &mut self.received)?;
        for [x, y, z, charge] in self.received.values.as_chunks::<NUMBERS>().0 {
            positions.push(Vector3::new(*x, *y, *z));
            charges.push(*charge);
        }
        Ok(())
    }

    /// Packs the grains that are near a box.
    fn pack(&mut self, target: &BoundingBox, positions: &[Vector3<f64>], charges: &[f64]) {
        let deep = without_images(&self.domain, target, self.radius);
        for (position, &charge) in positions.iter().zip(charges).filter(|(_, charge)| **charge != 0.0) {
            let is_near = if deep.contains(position) {
                target.distance_squared(position) <= self.radius * self.radius
            } else {
                let mut is_near = false;
                self.lattice.for_each_near(position, target, self.radius, |_| is_near = true);
                is_near
            };
            if is_near {
                self.sent.values.extend([position.x, position.y, position.z, charge]);
            }
        }
    }
}
