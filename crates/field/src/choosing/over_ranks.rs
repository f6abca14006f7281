//! The choice of parameters where ranks share the grains.
//!
//! Every rank runs the same tuner; what it asks of the grains is summed over the ranks, and parameters are
//! those that rank 0 finds. Candidates are not timed: parameters are those of the cost model, the same for
//! any number of ranks.

use crate::choosing::charge_statistics::{Bins, ChargeStatistics};
use crate::choosing::splittings::sample_step;
use crate::choosing::trials::{Trials, difference, squares};
use crate::error::FieldError;
use crate::methods::p3m_over_ranks::P3mOverRanks;
use crate::methods::p3m_parameters::P3mParameters;
use crate::ranks::{Parcels, Ranks};
use amberfield_core::{Domain, FieldSettings};
use nalgebra::Vector3;
use std::sync::Arc;

/// Numbers that make p3m's parameters, and whether there are any.
const TOLD: usize = 7;

/// Grains that ranks share, seen from one of them.
pub(crate) struct OverRanks<'a> {
    pub(crate) ranks: &'a Arc<dyn Ranks>,
    pub(crate) domain: &'a Domain,
    pub(crate) settings: &'a FieldSettings,
    pub(crate) positions: &'a [Vector3<f64>],
    pub(crate) charges: &'a [f64],
}

impl OverRanks<'_> {
    /// Statistics of all grains.
    pub(crate) fn statistics(&self) -> Result<ChargeStatistics, FieldError> {
        let mut sums = [self.positions.len() as f64, self.charges.iter().map(|q| q * q).sum()];
        self.ranks.sum(&mut sums)?;
        let [count, squares] = sums;
        let bins = Bins::new(self.domain, count);
        let of_bins = self.sum_of_squared_bins(&bins)?;
        Ok(ChargeStatistics::from_sums(self.domain, self.settings.permittivity, count, squares, |total| {
            bins.density(of_bins, total, count)
        }))
    }

    /// Sum over all bins of the squares of their sums of q². Every rank adds up the bins that are its own.
    fn sum_of_squared_bins(&self, bins: &Bins) -> Result<f64, FieldError> {
        let count = self.ranks.count();
        let mut own: Vec<(usize, f64)> = self
            .positions
            .iter()
            .zip(self.charges)
            .map(|(position, charge)| (bins.of(self.domain, position), charge * charge))
            .collect();
        own.sort_unstable_by_key(|(bin, _)| *bin);
        let owner = |bin: usize| bin * count / bins.count();
        let (mut sent, mut received) = (Parcels::default(), Parcels::default());
        let mut start = 0;
        for rank in 0..count {
            // Bins ascend, and so do those who have them.
            let end = own.partition_point(|(bin, _)| owner(*bin) <= rank);
            for together in own[start..end].chunk_by(|a, b| a.0 == b.0) {
                sent.values.push(together[0].0 as f64);
                sent.values.push(together.iter().map(|(_, square)| square).sum());
            }
            sent.end_parcel();
            start = end;
        }
        self.ranks.exchange_of_any_size(&sent, &mut received)?;
        let mut pairs = received.values.as_chunks::<2>().0.to_vec();
        pairs.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let of_bin = |together: &[[f64; 2]]| together.iter().map(|[_, sum]| sum).sum::<f64>().powi(2);
        let mut sum = [pairs.chunk_by(|a, b| a[0] == b[0]).map(of_bin).sum()];
        self.ranks.sum(&mut sum)?;
        Ok(sum[0])
    }

    fn p3m(&self, parameters: P3mParameters) -> P3mOverRanks {
        P3mOverRanks::new(self.ranks, self.domain, self.settings, parameters)
    }
}

impl Trials for OverRanks<'_> {
    fn squares(&self, parameters: P3mParameters) -> Result<[f64; 2], FieldError> {
        let mut sums = squares(&mut self.p3m(parameters), self.positions, self.charges)?;
        self.ranks.sum(&mut sums)?;
        Ok(sums)
    }

    fn difference(&self, first: P3mParameters, second: P3mParameters) -> Result<(f64, usize), FieldError> {
        let mut all = [self.positions.len() as f64];
        self.ranks.sum(&mut all)?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of grains")]
        let step = sample_step(all[0] as usize);
        let sample: Vec<usize> = (0..self.positions.len()).step_by(step).collect();
        let field = |parameters| self.p3m(parameters).sample(self.positions, self.charges, &sample);
        let mut sums = [difference(&field(first)?, &field(second)?), sample.len() as f64];
        self.ranks.sum(&mut sums)?;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of grains")]
        Ok((sums[0], sums[1] as usize))
    }

    fn seconds(&self, _parameters: P3mParameters) -> Result<f64, FieldError> {
        Err(FieldError::Settings(
            "candidates are not timed where ranks share a field; choose electric_field.tuning = \"model\""
                .into(),
        ))
    }

    fn shared(&self, parameters: Option<P3mParameters>) -> Result<Option<P3mParameters>, FieldError> {
        let ranks = self.ranks.as_ref();
        let own = match parameters {
            Some(P3mParameters {
                cutoff_m,
                cloud_shape,
                spacing_m,
                order,
                window_shape,
                kernel_accuracy,
                far: _,
            }) => [1.0, cutoff_m, cloud_shape, spacing_m, order as f64, window_shape, kernel_accuracy],
            None => [0.0; TOLD],
        };
        let mut told = if ranks.rank() == 0 { own } else { [0.0; TOLD] };
        ranks.sum(&mut told)?;
        let [there, cutoff_m, cloud_shape, spacing_m, order, window_shape, kernel_accuracy] = told;
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "an order")]
        let order = order as usize;
        Ok((there > 0.0).then_some(P3mParameters {
            cutoff_m,
            cloud_shape,
            spacing_m,
            order,
            window_shape,
            kernel_accuracy,
            far: None,
        }))
    }
}
