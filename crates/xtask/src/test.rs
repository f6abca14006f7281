//! Every test of the repository; installs what they need and says so.

use crate::shell::{cargo, run as execute, works};
use crate::{images, openfoam};
use anyhow::Result;
use std::path::Path;

/// Builds the field solver and its container images, then runs documentation examples, unit tests, command
/// tests and cases at smoke size.
///
/// The documentation examples come first so that the last line counts the tests proper.
pub(crate) fn run(root: &Path) -> Result<()> {
    openfoam::run(root)?;
    images::build(root)?;
    execute(&mut cargo(root, &["test", "--workspace", "--doc"]))?;
    if works(&mut cargo(root, &["nextest", "--version"])) {
        execute(&mut cargo(root, &["nextest", "run", "--workspace", "--no-fail-fast"]))
    } else {
        println!("cargo-nextest is not installed and not needed: cargo test runs the same tests");
        execute(&mut cargo(root, &["test", "--workspace", "--lib", "--bins", "--tests", "--no-fail-fast"]))
    }
}
