//! Ranks that are threads of one process.

use super::{Parcels, Ranks};
use crate::error::FieldError;
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, Sender, channel};

/// One of several threads that share a field, each with grains of its own: for tests, and to see how a field
/// is shared without MPI.
#[derive(Debug)]
pub struct ThreadRank {
    rank: usize,
    to: Vec<Sender<Vec<f64>>>,
    from: Vec<Mutex<Receiver<Vec<f64>>>>,
}

impl ThreadRank {
    /// Makes so many ranks, each for a thread of its own.
    #[must_use]
    pub fn all(count: usize) -> Vec<Self> {
        let mut to: Vec<Vec<_>> = (0..count).map(|_| Vec::with_capacity(count)).collect();
        let from: Vec<Vec<_>> = (0..count)
            .map(|_| {
                let ways = to.iter_mut().map(|to| {
                    let (sender, receiver) = channel();
                    to.push(sender);
                    Mutex::new(receiver)
                });
                ways.collect()
            })
            .collect();
        let ends = to.into_iter().zip(from);
        ends.enumerate().map(|(rank, (to, from))| Self { rank, to, from }).collect()
    }
}

impl Ranks for ThreadRank {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.to.len()
    }

    fn exchange(&self, sent: &Parcels, received: &mut Parcels) -> Result<(), FieldError> {
        let gone = |rank: usize| FieldError::Settings(format!("rank {rank} of the field has ended"));
        for (rank, to) in self.to.iter().enumerate() {
            to.send(sent.of(rank).to_vec()).map_err(|_| gone(rank))?;
        }
        for (rank, from) in self.from.iter().enumerate() {
            let from = from.lock().map_err(|_| gone(rank))?;
            let values = from.recv().map_err(|_| gone(rank))?;
            let place = received.start(rank)..received.ends[rank];
            received.values[place].copy_from_slice(&values);
        }
        Ok(())
    }

    fn sum(&self, values: &mut [f64]) -> Result<(), FieldError> {
        let sent = Parcels::for_all(values, self.count());
        let mut received = sent.clone();
        self.exchange(&sent, &mut received)?;
        values.fill(0.0);
        for rank in 0..self.count() {
            for (sum, value) in values.iter_mut().zip(received.of(rank)) {
                *sum += value;
            }
        }
        Ok(())
    }
}
