//! Printing, which happens only here. A closed pipe is no error.

use std::fmt::Arguments;
use std::io::Write as _;

/// Prints a line of the summary to stdout.
pub(crate) fn line(text: Arguments<'_>) {
    let _ = writeln!(std::io::stdout(), "{text}");
}

/// Prints a line of progress to stderr.
pub(crate) fn note(text: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Prints an error to stderr.
pub(crate) fn error(text: Arguments<'_>) {
    let _ = writeln!(std::io::stderr(), "error: {text}");
}
