//! Numbers for every rank, or from every rank.

use super::Ranks;
use crate::error::FieldError;

/// Numbers in parcels, one for each rank, side by side in the order of the ranks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Parcels {
    /// All numbers.
    pub values: Vec<f64>,
    /// End of each rank's numbers.
    pub ends: Vec<usize>,
}

impl Parcels {
    /// Numbers for or from a rank.
    #[must_use]
    pub fn of(&self, rank: usize) -> &[f64] {
        &self.values[self.start(rank)..self.ends[rank]]
    }

    /// Number of numbers for or from each rank.
    pub fn sizes(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.ends.len()).map(|rank| self.ends[rank] - self.start(rank))
    }

    /// Makes room for parcels of the given sizes, one for each rank; the numbers are zero.
    pub fn resize(&mut self, sizes: impl IntoIterator<Item = usize>) {
        self.ends.clear();
        let mut end = 0;
        for size in sizes {
            end += size;
            self.ends.push(end);
        }
        self.values.clear();
        self.values.resize(end, 0.0);
    }

    /// Makes the same parcel for each of so many ranks.
    #[must_use]
    pub(crate) fn for_all(values: &[f64], ranks: usize) -> Self {
        Self { values: values.repeat(ranks), ends: (1..=ranks).map(|rank| rank * values.len()).collect() }
    }

    /// Removes all parcels; memory is kept.
    pub fn clear(&mut self) {
        self.values.clear();
        self.ends.clear();
    }

    /// Ends the next rank's parcel behind the numbers that are there.
    pub fn end_parcel(&mut self) {
        self.ends.push(self.values.len());
    }

    /// Place of the first of a rank's numbers.
    pub(crate) fn start(&self, rank: usize) -> usize {
        rank.checked_sub(1).map_or(0, |before| self.ends[before])
    }

    /// Memory held [bytes].
    pub(crate) fn memory_bytes(&self) -> usize {
        size_of::<f64>() * self.values.capacity() + size_of::<usize>() * self.ends.capacity()
    }
}

impl dyn Ranks + '_ {
    /// Exchanges parcels of which only those who send them know the sizes.
    ///
    /// # Errors
    /// The errors of [`Ranks::exchange`].
    pub fn exchange_of_any_size(&self, sent: &Parcels, received: &mut Parcels) -> Result<(), FieldError> {
        let values = sent.sizes().map(|size| size as f64).collect();
        let told = Parcels { values, ends: (1..=self.count()).collect() };
        let mut sizes = Parcels::default();
        sizes.resize((0..self.count()).map(|_| 1));
        self.exchange(&told, &mut sizes)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "a size, exact in a double"
        )]
        received.resize(sizes.values.iter().map(|&size| size as usize));
        self.exchange(sent, received)
    }
}
