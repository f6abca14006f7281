//! Ranks of a host program: its own functions carry the numbers, so that no MPI is linked here.
//!
//! The library computes in threads of its own, and the host's functions are called in the thread that called
//! the library: the one that may use MPI. So whoever computes asks, and the caller serves.

use amberfield_field::{FieldError, Parcels, Ranks};
use std::cell::Cell;
use std::ffi::c_void;
use std::fmt;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

/// Sends `sent_counts[k]` numbers to every rank k and receives `received_counts[k]` from it; both lie side by
/// side in the order of the ranks. MPI_Alltoallv does this. Returns 0, or anything else on failure.
pub type AmberfieldExchange = Option<
    unsafe extern "C" fn(
        context: *mut c_void,
        sent: *const f64,
        sent_counts: *const u64,
        received: *mut f64,
        received_counts: *const u64,
    ) -> i32,
>;

/// Replaces `count` numbers by their sums over the ranks, to the same bits on all of them. MPI_Allreduce does
/// this. Returns 0, or anything else on failure.
pub type AmberfieldSum =
    Option<unsafe extern "C" fn(context: *mut c_void, values: *mut f64, count: u64) -> i32>;

/// Functions of a host program by which its ranks exchange numbers. Every rank opens the field with its own
/// table, and calls the same functions of the library in the same order. The functions are called in the
/// thread that calls the library.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct AmberfieldRanks {
    /// Number of this rank, from 0.
    pub rank: u64,
    /// Number of ranks.
    pub count: u64,
    /// First argument of the functions.
    pub context: *mut c_void,
    /// Exchange of numbers.
    pub exchange: AmberfieldExchange,
    /// Sums of numbers.
    pub sum: AmberfieldSum,
}

impl fmt::Debug for AmberfieldRanks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "rank {} of {}", self.rank, self.count)
    }
}

impl AmberfieldRanks {
    /// Refuses a table that cannot be used.
    fn check(&self) -> Result<(), String> {
        if self.rank >= self.count {
            return Err(format!("rank is {} of count {}; ranks are counted from 0", self.rank, self.count));
        }
        if self.exchange.is_none() || self.sum.is_none() {
            return Err("exchange or sum is NULL; give both functions".into());
        }
        Ok(())
    }

    fn exchange(&self, sent: &Parcels, received: &mut Parcels) -> i32 {
        let counts = |parcels: &Parcels| parcels.sizes().map(|size| size as u64).collect::<Vec<_>>();
        let (to, from) = (counts(sent), counts(received));
        let Some(exchange) = self.exchange else { return -1 };
        let (values, room) = (sent.values.as_ptr(), received.values.as_mut_ptr());
        // SAFETY: the arrays have these numbers of numbers; the host promised the rest.
        unsafe { exchange(self.context, values, to.as_ptr(), room, from.as_ptr()) }
    }

    fn sum(&self, values: &mut [f64]) -> i32 {
        let Some(sum) = self.sum else { return -1 };
        // SAFETY: the array has this number of numbers; the host promised the rest.
        unsafe { sum(self.context, values.as_mut_ptr(), values.len() as u64) }
    }
}

/// Wish of a thread that computes. The thread waits, so that what is pointed to lives and nobody else uses
/// it.
enum Wish {
    Exchange(*const Parcels, *mut Parcels),
    Sum(*mut [f64]),
    End,
}

// SAFETY: see above: one thread at a time uses what is pointed to.
unsafe impl Send for Wish {}

/// Ranks as the threads that compute see them.
struct HostRanks {
    rank: usize,
    count: usize,
    wishes: Mutex<Sender<Wish>>,
    outcomes: Mutex<Receiver<i32>>,
}

impl fmt::Debug for HostRanks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "rank {} of {} of a host program", self.rank, self.count)
    }
}

impl HostRanks {
    fn ask(&self, wish: Wish) -> Result<(), FieldError> {
        let failed = |text: String| FieldError::Settings(format!("exchange between ranks: {text}"));
        let gone = || failed("the thread that called the library has gone".into());
        self.wishes.lock().map_err(|_| gone())?.send(wish).map_err(|_| gone())?;
        match self.outcomes.lock().map_err(|_| gone())?.recv().map_err(|_| gone())? {
            0 => Ok(()),
            code => Err(failed(format!("the host program's function returned {code}"))),
        }
    }
}

impl Ranks for HostRanks {
    fn rank(&self) -> usize {
        self.rank
    }

    fn count(&self) -> usize {
        self.count
    }

    fn exchange(&self, sent: &Parcels, received: &mut Parcels) -> Result<(), FieldError> {
        self.ask(Wish::Exchange(sent, received))
    }

    fn sum(&self, values: &mut [f64]) -> Result<(), FieldError> {
        self.ask(Wish::Sum(values))
    }
}

/// The host's side: serves what threads ask for, in the thread that called the library.
pub(crate) struct RankServer {
    table: AmberfieldRanks,
    ranks: Arc<dyn Ranks>,
    end: Sender<Wish>,
    wishes: Receiver<Wish>,
    outcomes: Sender<i32>,
    /// Whether one of the host's functions has failed: ranks no longer agree on anything.
    is_broken: Cell<bool>,
}

impl fmt::Debug for RankServer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.table.fmt(f)
    }
}

impl RankServer {
    /// Takes a host's table.
    pub(crate) fn new(table: AmberfieldRanks) -> Result<Self, String> {
        table.check()?;
        let (asks, wishes) = channel();
        let (outcomes, answers) = channel();
        let ranks = Arc::new(HostRanks {
            rank: table.rank as usize,
            count: table.count as usize,
            wishes: Mutex::new(asks.clone()),
            outcomes: Mutex::new(answers),
        });
        Ok(Self { table, ranks, end: asks, wishes, outcomes, is_broken: Cell::new(false) })
    }

    /// Whether an exchange between ranks has failed.
    pub(crate) fn is_broken(&self) -> bool {
        self.is_broken.get()
    }

    /// Ranks for threads that compute.
    pub(crate) fn ranks(&self) -> &Arc<dyn Ranks> {
        &self.ranks
    }

    /// End of [`Self::serve`] when it is dropped; for the thread that computes.
    pub(crate) fn end(&self) -> End {
        End(self.end.clone())
    }

    /// Serves threads until one has ended.
    pub(crate) fn serve(&self) {
        for wish in &self.wishes {
            let outcome = match wish {
                // SAFETY: the thread that asks waits; see [`Wish`].
                Wish::Exchange(sent, received) => unsafe { self.table.exchange(&*sent, &mut *received) },
                // SAFETY: as above.
                Wish::Sum(values) => unsafe { self.table.sum(&mut *values) },
                Wish::End => return,
            };
            self.is_broken.set(self.is_broken.get() || outcome != 0);
            if self.outcomes.send(outcome).is_err() {
                return;
            }
        }
    }
}

/// Tells the server of the end of the work, however it ends.
pub(crate) struct End(Sender<Wish>);

impl Drop for End {
    fn drop(&mut self) {
        let _ = self.0.send(Wish::End);
    }
}
