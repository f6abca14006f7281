//! Every test of the repository; installs what they need and says so.

use crate::openfoam::PROGRAM;
use crate::profile::Profile;
use crate::shell::{cargo, run as execute, works};
use crate::{images, lammps, openfoam, python};
use anyhow::Result;
use std::path::Path;

/// Builds the field solver and its container images, then runs the tests of the Python package, of the LAMMPS
/// plugin, documentation examples, unit tests, command tests and cases at smoke size.
///
/// Everything is compiled once, as the tests are; what `cargo xtask openfoam` and `cargo xtask images` make
/// for users is left as it is, but for the images, which have the same names.
/// The documentation examples come before the tests so that the last line counts the tests proper.
pub(crate) fn run(root: &Path) -> Result<()> {
    provide_and_compile(root)?;
    let profile = Profile::Dev;
    let solver = openfoam::build(root, profile, profile.solver_folder(), &[])?.join(PROGRAM);
    images::build(root, profile)?;
    python::test(root, profile)?;
    lammps::test(root, profile, Some(&solver))?;
    execute(&mut cargo(root, &["test", "--workspace", "--doc"]))?;

    let mut tests = if works(&mut cargo(root, &["nextest", "--version"])) {
        cargo(root, &["nextest", "run", "--workspace", "--no-fail-fast"])
    } else {
        println!("cargo-nextest is not installed and not needed: cargo test runs the same tests");
        cargo(root, &["test", "--workspace", "--lib", "--bins", "--tests", "--no-fail-fast"])
    };
    execute(tests.env("AMBERFIELD_SOLVER", solver))
}

/// Installs packages, starts an engine and makes the images' base while the workspace is compiled: the one
/// waits for disks and servers, the other for processors.
fn provide_and_compile(root: &Path) -> Result<()> {
    std::thread::scope(|scope| {
        let provided = scope.spawn(|| {
            openfoam::provide(root)?;
            python::provide(root)?;
            lammps::provide(root)?;
            images::provide(root)
        });
        let compiled = execute(&mut cargo(root, &["build", "--workspace", "--all-targets"]));
        provided.join().expect("what provides does not panic")?;
        compiled
    })
}
