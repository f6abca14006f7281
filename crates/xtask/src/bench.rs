//! Speed and memory, by the program `bench` of `crates/study`.

use crate::lammps;
use crate::shell::{cargo, run as execute};
use anyhow::Result;
use std::path::Path;

/// Builds and runs the measuring program with the given arguments; beside peers, with our plugin for LAMMPS.
pub(crate) fn run(root: &Path, arguments: &[&str]) -> Result<()> {
    let mut bench = cargo(root, &["run", "--release", "-p", "amberfield-study", "--bin", "bench", "--"]);
    bench.args(arguments);
    let sections = arguments.iter().any(|argument| !argument.starts_with("--"));
    if arguments.contains(&"--peers") && (!sections || arguments.contains(&"lammps")) {
        bench.env("AMBERFIELD_PLUGIN", lammps::for_users(root)?);
    }
    execute(&mut bench)
}
