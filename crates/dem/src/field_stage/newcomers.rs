//! Grains that come between two evaluations: until the next one they and the others feel each other as point
//! charges, without images.

use super::FieldStage;
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Particles, Vector3};
use amberfield_laws::point_charge;

impl FieldStage {
    /// Takes in the last `count` grains, which have just come.
    pub(crate) fn admit(&mut self, domain: &Domain, grains: &Grains, particles: &Particles, count: usize) {
        let first = grains.len() - count;
        let (k, external) = (self.settings.permittivity.coulomb(), self.of_newcomer());
        let charge = |i: usize| {
            let original = grains.original[i].index();
            if self.member[original] { particles.charge[original] } else { 0.0 }
        };
        for newcomer in first..grains.len() {
            let is_member = self.member[grains.original[newcomer].index()];
            let mut own = Vector3::zeros();
            if is_member {
                own = external;
                let q = charge(newcomer);
                for other in 0..newcomer {
                    let from = domain.shortest(grains.position(newcomer) - grains.position(other));
                    let of_other = charge(other);
                    if of_other != 0.0 {
                        own += point_charge::field(k, of_other, from);
                    }
                    if q != 0.0 && self.member[grains.original[other].index()] {
                        self.forecast.add(other, point_charge::field(k, q, -from));
                    }
                }
            }
            self.forecast.admit(own, charge(newcomer));
        }
    }
}
