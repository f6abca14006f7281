//! Grains that come and leave between two evaluations: until the next one the others feel that as point
//! charges do. Of images there is only that of a grain which leaves at a face that mirrors it.

use super::FieldStage;
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Particles, Vector3};
use amberfield_laws::point_charge;

/// Grain that leaves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Leaver {
    /// Index in sorted order.
    pub(crate) index: usize,
    /// Image at a face that mirrors it: its place [m] and its charge over that of the grain.
    pub(crate) image: Option<(Vector3<f64>, f64)>,
}

/// Charge of a grain that makes and feels the field [C]; `None` for others.
fn charge_of(member: &[bool], grains: &Grains, particles: &Particles, i: usize) -> Option<f64> {
    let original = grains.original[i].index();
    member[original].then(|| particles.charge[original])
}

impl FieldStage {
    /// Energy of a charge [C] at a place [m] in the external field and in that of the faces, whose potential
    /// counts by half, as far as they stay as they are [J]; what changes and is the same everywhere is not
    /// part of the forecasts' energy.
    fn energy_of_given(&self, charge: f64, place: &Vector3<f64>) -> f64 {
        let field = &self.source.field;
        let (given, changing) = (field.given(place), field.changing_uniform(place));
        charge
            * (given.external.potential - changing.external.potential
                + 0.5 * (given.faces.potential - changing.faces.potential))
    }

    /// Takes the field of grains that leave off the others' E, before the grains are reordered.
    pub(crate) fn retire(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
        leavers: &[Leaver],
    ) {
        let k = self.settings.permittivity.coulomb();
        // Their indices increase.
        let mut gone = Vec::with_capacity(leavers.len());
        for Leaver { index, image } in leavers {
            gone.push(*index);
            let charge = charge_of(&self.member, grains, particles, *index);
            let Some(q) = charge.filter(|q| *q != 0.0) else { continue };
            let place = grains.position(*index);
            let mut energy = self.energy_of_given(q, &domain.wrap(place));
            for other in (0..grains.len()).filter(|other| gone.binary_search(other).is_err()) {
                let Some(of_other) = charge_of(&self.member, grains, particles, other) else { continue };
                let at = grains.position(other);
                let mut feel = |share: f64, from: Vector3<f64>| {
                    let away = domain.shortest(at - from);
                    self.forecast.add(other, -point_charge::field(k, share * q, away));
                    energy += k * share * q * of_other / away.norm();
                };
                feel(1.0, place);
                if let Some((mirrored, share)) = image {
                    feel(*share, *mirrored);
                }
            }
            self.energy.shift(-energy);
        }
    }

    /// Electric force on a grain in the present step, as it is forecast [N].
    pub(crate) fn force_on(&self, grain: usize) -> Vector3<f64> {
        self.forecast.force(grain, self.control.age as f64)
    }

    /// Takes in the last `count` grains, which have just come; returns the energy that they brought [J].
    pub(crate) fn admit(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        particles: &Particles,
        count: usize,
    ) -> f64 {
        let k = self.settings.permittivity.coulomb();
        let mut brought = 0.0;
        for newcomer in grains.len() - count..grains.len() {
            let Some(q) = charge_of(&self.member, grains, particles, newcomer) else {
                self.forecast.admit(Vector3::zeros(), 0.0);
                continue;
            };
            let place = grains.position(newcomer);
            let mut own = self.source.field.without_charges(&place);
            let mut energy = self.energy_of_given(q, &place);
            for other in 0..newcomer {
                let Some(of_other) = charge_of(&self.member, grains, particles, other) else { continue };
                let from = domain.shortest(place - grains.position(other));
                own += point_charge::field(k, of_other, from);
                self.forecast.add(other, point_charge::field(k, q, -from));
                energy += k * q * of_other / from.norm();
            }
            self.energy.shift(energy);
            brought += energy;
            self.forecast.admit(own, q);
        }
        brought
    }
}
