//! OpenFOAM's own programs, run on a case.

use super::launcher::hide_launcher;
use crate::CouplingError;
use std::ffi::{OsStr, OsString};
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

/// Variable that OpenFOAM's libraries need before they start, and its value for Debian's package.
const PROJECT: (&str, &str) = ("WM_PROJECT_DIR", "/usr/share/openfoam");
/// Program that lets the system end another when this one dies.
const UNTIL_DEATH: (&str, [&str; 3]) = ("setpriv", ["--pdeathsig", "KILL", "--"]);
/// Time between two looks at a program that works.
const SLICE: Duration = Duration::from_millis(5);
/// Last lines of a log that has no error of OpenFOAM's.
const LAST_LINES: usize = 3;

/// Question whether the user asked to stop.
pub type Stop = fn() -> bool;

/// A program linked to OpenFOAM, with what its libraries want to know, and nothing of a launcher that started
/// this program.
#[must_use]
pub fn foam_command(program: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(program);
    hide_launcher(&mut command);
    if std::env::var_os(PROJECT.0).is_none() {
        command.env(PROJECT.0, PROJECT.1);
    }
    command
}

/// Runs one of OpenFOAM's own programs in a folder, with a log there named after it.
pub(super) fn run_tool(
    name: &str,
    folder: &Path,
    log: &Path,
    options: &[OsString],
    stop: Stop,
) -> Result<(), CouplingError> {
    let begun = Instant::now();
    let file = File::create(log).and_then(|file| Ok([file.try_clone()?, file]));
    let [out, err] = file.map_err(|error| super::unusable(log, format!("cannot be written: {error}")))?;
    let mut command = command_of(name, folder)?;
    command.args(options).arg("-case").arg(folder).stdout(out).stderr(err);
    let child = command.spawn().map_err(|error| CouplingError::Case(format!("{name}: {error}")))?;
    let status = wait(child, name, stop)?;
    if status.success() {
        tracing::debug!("{name} took {:.1} s; its log is {}", begun.elapsed().as_secs_f64(), log.display());
        return Ok(());
    }
    let said = std::fs::read(log).unwrap_or_default();
    let words = last_words(&String::from_utf8_lossy(&said));
    Err(CouplingError::Case(format!("{name} failed ({status}): {words}; its log is {}", log.display())))
}

/// Text that one of OpenFOAM's own programs prints; `None` where it fails.
pub(super) fn tool_output(name: &str, folder: &Path, options: &[&OsStr]) -> Option<String> {
    let output = command_of(name, folder).ok()?.args(options).output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}

/// One of OpenFOAM's programs in a folder; it ends when this program dies.
fn command_of(name: &str, folder: &Path) -> Result<Command, CouplingError> {
    let Some(program) = on_path(name) else {
        return Err(CouplingError::Case(format!(
            "{name} is not on the PATH; install OpenFOAM (Debian: openfoam), or source its etc/bashrc first"
        )));
    };
    let (guard, options) = UNTIL_DEATH;
    let mut command = match on_path(guard) {
        Some(guard) => {
            let mut command = foam_command(guard);
            command.args(options).arg(program);
            command
        }
        None => foam_command(program),
    };
    // OpenFOAM asks PWD for the folder's name.
    command.current_dir(folder).env("PWD", folder).stdin(Stdio::null());
    Ok(command)
}

/// Path of a program on the PATH.
pub(crate) fn on_path(name: &str) -> Option<PathBuf> {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&folders).map(|folder| folder.join(name)).find(|path| path.is_file())
}

/// Waits for a program, or ends it when the user asks to stop.
fn wait(mut child: Child, name: &str, stop: Stop) -> Result<ExitStatus, CouplingError> {
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(status),
            Ok(None) if stop() => {
                let _ = child.kill();
                let _ = child.wait();
                return Err(CouplingError::Stopped(format!("{name} was ended")));
            }
            Ok(None) => std::thread::sleep(SLICE),
            Err(error) => return Err(CouplingError::Case(format!("{name}: {error}"))),
        }
    }
}

/// Text of OpenFOAM's fatal error, the lines before those that say where; without one a log's last lines.
pub(crate) fn last_words(log: &str) -> String {
    let lines = log.lines().map(str::trim).skip_while(|line| !line.contains("FOAM FATAL")).skip(1);
    let lines = lines
        .map(|line| line.trim_start_matches(|c: char| c == '[' || c == ']' || c.is_ascii_digit()).trim());
    let words: Vec<&str> =
        lines.skip_while(|line| line.is_empty()).take_while(|line| !line.is_empty()).collect();
    if !words.is_empty() {
        return words.join(" ");
    }
    let says_something = |line: &&str| line.contains(|c: char| c != '-');
    let lines: Vec<&str> = log.lines().map(str::trim).filter(says_something).collect();
    lines[lines.len().saturating_sub(LAST_LINES)..].join(" ")
}
