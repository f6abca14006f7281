//! Threads of the computation, and how Python waits for them.

use crate::errors;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::collections::HashMap;
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// Time between two looks at Python's signals.
const LOOK: Duration = Duration::from_millis(50);
/// Pools by their number of threads; each stays, since to start one takes longer than a small field.
static POOLS: Mutex<Option<HashMap<usize, Arc<ThreadPool>>>> = Mutex::new(None);

/// Pool of this many threads; `None` means one for each core.
pub(crate) fn pool(py: Python<'_>, threads: Option<usize>) -> PyResult<Arc<ThreadPool>> {
    let count = match threads {
        Some(0) => {
            return Err(errors::bad_input(py, "threads: got 0; give at least 1, or None for all cores"));
        }
        Some(count) => count,
        None => 0,
    };
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let pools = pools.get_or_insert_default();
    if let Some(pool) = pools.get(&count) {
        return Ok(Arc::clone(pool));
    }
    let pool = ThreadPoolBuilder::new()
        .num_threads(count)
        .build()
        .map_err(|error| errors::bad_input(py, &format!("threads: {count}: {error}; give fewer")))?;
    let pool = Arc::new(pool);
    pools.insert(count, Arc::clone(&pool));
    Ok(pool)
}

/// Whether work that takes this long is over before signals are looked at.
pub(crate) fn is_short(time: Duration) -> bool {
    time < LOOK
}

/// Does short work on a pool while Python's other threads run; signals wait until it is done.
pub(crate) fn work_shortly<T: Send>(py: Python<'_>, pool: &ThreadPool, work: impl FnOnce() -> T + Send) -> T {
    py.detach(|| pool.install(work))
}

/// Does work on a pool while Python's other threads run. Between looks at signals `look` is called, with the
/// error of a signal (Ctrl-C) if there was one. A signal that comes while `look` runs Python is raised there:
/// it counts, while other failures of `look` do not. The work is always waited for.
pub(crate) fn work<T: Send>(
    py: Python<'_>,
    pool: &ThreadPool,
    work: impl FnOnce() -> T + Send,
    mut look: impl FnMut(Python<'_>, Option<&PyErr>) -> PyResult<()>,
) -> PyResult<T> {
    let (send, receive) = sync_channel(1);
    let receive = Mutex::new(receive);
    let (done, signal) = std::thread::scope(|scope| {
        let handle = scope.spawn(|| {
            let done = pool.install(work);
            // Nobody may wait any more; what was done is returned below in any case.
            let _ = send.send(());
            done
        });
        let (mut signal, mut raised) = (None, None::<PyErr>);
        loop {
            let waited =
                py.detach(|| receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(LOOK));
            if !matches!(waited, Err(RecvTimeoutError::Timeout)) || handle.is_finished() {
                break;
            }
            let new = raised.take().or_else(|| py.check_signals().err());
            let failure = look(py, new.as_ref()).err();
            raised = failure.filter(|failure| failure.is_instance_of::<PyKeyboardInterrupt>(py));
            signal = signal.or(new);
        }
        (py.detach(|| handle.join()), signal.or(raised))
    });
    match (done, signal) {
        (_, Some(signal)) => Err(signal),
        (Ok(done), None) => Ok(done),
        (Err(panic), None) => std::panic::resume_unwind(panic),
    }
}
