//! Particles of all ranks on rank 0, where a field solver answers.

use amberfield_core::Vector3;
use amberfield_field::{FieldError, FieldValues, Parcels, Ranks};

/// Numbers that travel for a particle: its place and its charge.
const NUMBERS: usize = 4;
/// Error that stands for none.
const NONE: f64 = -1.0;

/// Particles at which a field is computed.
pub(crate) struct Own<'a> {
    /// Places [m].
    pub(crate) positions: &'a mut [Vector3<f64>],
    /// Charges [C].
    pub(crate) charges: &'a [f64],
}

/// Particles of all ranks and their field, on rank 0; empty on others.
#[derive(Debug, Default)]
pub(crate) struct Gathered {
    positions: Vec<Vector3<f64>>,
    charges: Vec<f64>,
    values: FieldValues,
    sent: Parcels,
    received: Parcels,
}

impl Gathered {
    /// Gathers the particles, computes on rank 0, and brings every rank the values of its own ones, and the
    /// error that `at` returns. What fails on rank 0 fails on all.
    pub(crate) fn compute(
        &mut self,
        ranks: &dyn Ranks,
        own: &Own<'_>,
        values: &mut FieldValues,
        at: impl FnOnce(Own<'_>, &mut FieldValues) -> Result<Option<f64>, String>,
    ) -> Result<Option<f64>, String> {
        self.gather(ranks, own).map_err(|error| error.to_string())?;
        let outcome = if ranks.rank() == 0 {
            let all = Own { positions: &mut self.positions, charges: &self.charges };
            at(all, &mut self.values).map_err(FieldError::Settings)
        } else {
            Ok(None)
        };
        let scatter = |measured| self.scatter(ranks, measured, own.positions.len(), values);
        ranks.agreed(outcome).and_then(scatter).map_err(|error| error.to_string())
    }

    fn gather(&mut self, ranks: &dyn Ranks, own: &Own<'_>) -> Result<(), FieldError> {
        self.sent.clear();
        for (place, charge) in own.positions.iter().zip(own.charges) {
            self.sent.values.extend([place.x, place.y, place.z, *charge]);
        }
        // All for rank 0, the first.
        (0..ranks.count()).for_each(|_| self.sent.end_parcel());
        ranks.exchange_of_any_size(&self.sent, &mut self.received)?;
        self.positions.clear();
        self.charges.clear();
        for [x, y, z, charge] in self.received.values.as_chunks::<NUMBERS>().0 {
            self.positions.push(Vector3::new(*x, *y, *z));
            self.charges.push(*charge);
        }
        Ok(())
    }

    /// Sends each rank the error and what there is at its particles: E, then potentials.
    fn scatter(
        &mut self,
        ranks: &dyn Ranks,
        measured: Option<f64>,
        own: usize,
        values: &mut FieldValues,
    ) -> Result<Option<f64>, FieldError> {
        let Self { sent, received, values: all, .. } = self;
        sent.clear();
        let mut start = 0;
        for size in received.sizes() {
            if ranks.rank() == 0 {
                let particles = start..start + size / NUMBERS;
                start = particles.end;
                sent.values.push(measured.unwrap_or(NONE));
                sent.values.extend(all.e.get(particles.clone()).into_iter().flatten().flat_map(|e| e.iter()));
                sent.values.extend(all.potential.get(particles).into_iter().flatten());
            }
            sent.end_parcel();
        }
        ranks.exchange_of_any_size(sent, received)?;
        let (measured, values_of_own) = received
            .of(0)
            .split_first()
            .ok_or_else(|| FieldError::Settings("rank 0 has sent nothing".into()))?;
        let (e, potential) = values_of_own.split_at(values_of_own.len().min(3 * own));
        values.e.clear();
        values.e.extend(e.as_chunks::<3>().0.iter().map(|&e| Vector3::from(e)));
        values.potential.clear();
        values.potential.extend(potential);
        Ok((*measured != NONE).then_some(*measured))
    }
}
