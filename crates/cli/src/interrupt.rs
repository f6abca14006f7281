//! Ctrl-C: once to stop after the step, twice to stop now.

use crate::failure::Failure;
use crate::print;
use std::sync::atomic::{AtomicBool, Ordering};

/// Whether the user asked to stop.
static ASKED: AtomicBool = AtomicBool::new(false);
/// Exit code of a program that an interrupt ended, as shells have it.
const EXIT_INTERRUPTED: i32 = 130;

/// Catches interrupts from now on.
pub(crate) fn watch() -> Result<(), Failure> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::SeqCst) {
            print::note(format_args!("stopped at once; the last checkpoint stands"));
            std::process::exit(EXIT_INTERRUPTED);
        }
        print::note(format_args!("stopping after this step with a checkpoint; once more to stop at once"));
    })
    .map_err(|error| Failure::bad_input(format!("cannot watch for Ctrl-C: {error}")))
}

/// Whether the user asked to stop.
pub(crate) fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
