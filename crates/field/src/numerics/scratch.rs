//! Working memory of every thread, kept between evaluations.

use std::sync::{Mutex, MutexGuard};

/// One value for each thread of the pool.
#[derive(Debug)]
pub(crate) struct PerThread<T>(Vec<Mutex<T>>);

impl<T> PerThread<T> {
    pub(crate) fn new(value: impl Fn() -> T) -> Self {
        Self((0..rayon::current_num_threads()).map(|_| Mutex::new(value())).collect())
    }

    /// Runs `work` with the calling thread's own value.
    pub(crate) fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        let thread = rayon::current_thread_index().unwrap_or(0) % self.0.len();
        let mut guard: MutexGuard<'_, T> =
            self.0[thread].lock().expect("no work panics while it holds its memory");
        work(&mut guard)
    }
}
