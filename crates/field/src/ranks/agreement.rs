//! Agreement of ranks that one of them has failed, so that none waits for another that gave up.

use super::parcels::exchange_of_any_size;
use super::{Parcels, Ranks};
use crate::error::FieldError;

/// Returns the outcome where all ranks have a good one; else every rank has the error of the first rank that
/// failed.
pub(crate) fn agreed<T>(ranks: &dyn Ranks, outcome: Result<T, FieldError>) -> Result<T, FieldError> {
    let mut failed = [if outcome.is_err() { 1.0 } else { 0.0 }];
    ranks.sum(&mut failed)?;
    if failed[0] == 0.0 {
        return outcome;
    }
    let reason = outcome.as_ref().err().map(FieldError::to_string).unwrap_or_default();
    let (mut told, mut heard) = (Parcels::default(), Parcels::default());
    for _ in 0..ranks.count() {
        told.values.extend(reason.bytes().map(f64::from));
        told.end_parcel();
    }
    exchange_of_any_size(ranks, &told, &mut heard)?;
    let first = (0..ranks.count()).find(|&rank| !heard.of(rank).is_empty()).unwrap_or_default();
    if first == ranks.rank() {
        return outcome;
    }
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it was a byte")]
    let bytes: Vec<u8> = heard.of(first).iter().map(|&byte| byte as u8).collect();
    Err(FieldError::OfAnotherRank { rank: first, reason: String::from_utf8_lossy(&bytes).into_owned() })
}
