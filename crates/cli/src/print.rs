//! The only place that prints. A reader that went away (a closed pipe) is no error.

use std::fmt::Arguments;
use std::io::Write as _;

/// A line of the summary, to stdout.
pub(crate) fn line(text: Arguments<'_>) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// A line of progress, to stderr.
pub(crate) fn note(text: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// An error, to stderr.
pub(crate) fn error(text: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "error: {text}");
}
