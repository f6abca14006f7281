//! Processes that share a field, each with grains of its own: what they can do together, and how one that
//! fails tells the others.
//!
//! Nothing here knows what carries the numbers. A host program has MPI; tests have [`ThreadRank`].

mod agreement;
mod parcels;
mod shares;
mod threads;

use crate::error::FieldError;
use std::fmt;

pub use parcels::Parcels;
pub(crate) use shares::share;
pub use threads::ThreadRank;

/// Ranks that share a field, seen from one of them. Every rank calls the same functions in the same order.
pub trait Ranks: fmt::Debug + Send + Sync {
    /// Number of this rank, from 0.
    fn rank(&self) -> usize;

    /// Number of ranks.
    fn count(&self) -> usize;

    /// Sends a parcel of numbers to every rank, this one included, and receives one from each. The sizes of
    /// what comes stand in `received` already.
    ///
    /// # Errors
    /// Another rank that is gone, or what carries the numbers fails.
    fn exchange(&self, sent: &Parcels, received: &mut Parcels) -> Result<(), FieldError>;

    /// Replaces every number by its sum over the ranks, to the same bits on all of them.
    ///
    /// # Errors
    /// As [`Self::exchange`].
    fn sum(&self, values: &mut [f64]) -> Result<(), FieldError>;
}
