//! Interrupts by Ctrl-C: the first stops the run after its step, the second at once.

use crate::failure::{EXIT_INTERRUPTED, Failure};
use crate::print;
use std::sync::atomic::{AtomicBool, Ordering};

/// Flag that the user asked to stop.
static ASKED: AtomicBool = AtomicBool::new(false);

/// Catches interrupts from now on.
pub(crate) fn watch() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
            print::note(format_args!("stopped at once; the last checkpoint remains"));
            std::process::exit(i32::from(EXIT_INTERRUPTED));
        }
        print::note(format_args!(
            "stopping after this step with a checkpoint; press Ctrl-C again to stop at once"
        ));
    })
    .map_err(|error| Failure::bad_input(format!("cannot watch for Ctrl-C: {error}")))
}

/// Asks the run of this process to stop after its step, with a checkpoint.
pub fn ask() {
    ASKED.store(true, Ordering::SeqCst);
}

/// Forgets that anybody asked, before another run of this process.
pub fn forget() {
    ASKED.store(false, Ordering::SeqCst);
}

/// Tells whether the user asked to stop.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
