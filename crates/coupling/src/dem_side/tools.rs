//! OpenFOAM's own programs, run on a case.

use std::ffi::OsStr;
use std::path::Path;
use std::process::{Command, Stdio};

/// Variable that OpenFOAM's libraries need before they start, and its value for Debian's package.
const PROJECT: (&str, &str) = ("WM_PROJECT_DIR", "/usr/share/openfoam");

/// A program linked to OpenFOAM, with what its libraries want to know.
#[must_use]
pub fn foam_command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    if std::env::var_os(PROJECT.0).is_none() {
        command.env(PROJECT.0, PROJECT.1);
    }
    command
}

/// Runs one of OpenFOAM's own programs on a case.
pub(super) fn run_tool(name: &str, case: &Path, options: &[&str]) -> Result<(), String> {
    tool_output(name, case, options).map(drop)
}

/// Text that one of OpenFOAM's own programs prints about a case; its last words where it fails.
pub(super) fn tool_output(name: &str, case: &Path, options: &[&str]) -> Result<String, String> {
    let case =
        case.canonicalize().map_err(|error| format!("{} cannot be opened: {error}", case.display()))?;
    let mut command = foam_command(name);
    command.args(options).arg("-case").arg(&case).stdin(Stdio::null());
    // decomposePar removes old parts from the folder in which it runs; PWD is asked for the folder's name.
    command.current_dir(&case).env("PWD", &case);
    let output = command.output().map_err(|error| format!("{name}: {error}"))?;
    let [printed, error] =
        [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned());
    if output.status.success() {
        return Ok(printed);
    }
    Err(format!("{name} failed ({}): {}", output.status, last_words(&error)))
}

/// Text of OpenFOAM's fatal error: the lines before those that say where.
pub(super) fn last_words(log: &str) -> String {
    let lines = log.lines().map(str::trim).skip_while(|line| !line.contains("FOAM FATAL")).skip(1);
    let lines = lines
        .map(|line| line.trim_start_matches(|c: char| c == '[' || c == ']' || c.is_ascii_digit()).trim());
    let words: Vec<&str> =
        lines.skip_while(|line| line.is_empty()).take_while(|line| !line.is_empty()).collect();
    words.join(" ")
}
