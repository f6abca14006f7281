//! Agreement of ranks that one of them has failed, so that none waits for another that gave up.

use super::{Parcels, Ranks};
use crate::error::FieldError;

impl dyn Ranks + '_ {
    /// Returns the outcome where all ranks have a good one; else every rank has the error of the first rank
    /// that failed, with the number of that rank.
    ///
    /// # Errors
    /// That error.
    pub fn agreed<T>(&self, outcome: Result<T, FieldError>) -> Result<T, FieldError> {
        let mut failed = [if outcome.is_err() { 1.0 } else { 0.0 }];
        self.sum(&mut failed)?;
        if failed[0] == 0.0 { outcome } else { self.first_of(outcome) }
    }

    /// The error of the first rank that has one.
    fn first_of<T>(&self, outcome: Result<T, FieldError>) -> Result<T, FieldError> {
        let reason = outcome.as_ref().err().map(FieldError::to_string).unwrap_or_default();
        let bytes: Vec<f64> = reason.bytes().map(f64::from).collect();
        let (told, mut heard) = (Parcels::for_all(&bytes, self.count()), Parcels::default());
        self.exchange_of_any_size(&told, &mut heard)?;
        let first = (0..self.count()).find(|&rank| !heard.of(rank).is_empty()).unwrap_or_default();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it was a byte")]
        let bytes: Vec<u8> = heard.of(first).iter().map(|&byte| byte as u8).collect();
        Err(FieldError::OfRank { rank: first, reason: String::from_utf8_lossy(&bytes).into_owned() })
    }
}
