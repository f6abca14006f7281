//! Speed and memory, by the program `bench` of `crates/study`.

use crate::shell::{cargo, run as execute};
use anyhow::Result;
use std::path::Path;

/// Builds and runs the measuring program with the given arguments.
pub(crate) fn run(root: &Path, arguments: &[&str]) -> Result<()> {
    execute(
        cargo(root, &["run", "--release", "-p", "amberfield-study", "--bin", "bench", "--"]).args(arguments),
    )
}
