//! The Python package: built as a wheel, installed into an environment of its own, and tested there.

use crate::debian;
use crate::profile::Profile;
use crate::shell::{run as execute, works};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder of the package in the repository.
const PACKAGE: &str = "crates/python";
/// Environment in which it is tested, below the root.
const ENVIRONMENT: &str = "target/python";
/// What builds and tests it; what it needs itself is in its `pyproject.toml`.
const TOOLS: [&str; 2] = ["maturin>=1.9,<2", "pytest>=7"];

/// Builds the wheel, installs it and runs its tests. With the profile of tests, since it is compiled from
/// the crates that they have compiled.
pub(crate) fn run(root: &Path, profile: Profile) -> Result<()> {
    let environment = provide(root, ENVIRONMENT)?;
    let python = environment.join("bin/python");
    pip(&python, &TOOLS.map(str::to_owned))?;
    let wheel = build(root, &environment, profile)?;
    // Its dependencies are fetched once; the package itself is another after each build.
    pip(&python, &[wheel.display().to_string()])?;
    execute(Command::new(&python).args(["-m", "pip", "install", "-q", "--force-reinstall", "--no-deps"]).arg(&wheel))?;
    execute(Command::new(&python).args(["-m", "pytest"]).current_dir(root.join(PACKAGE)))
}

/// Makes an environment of Python's, if it is not there.
pub(crate) fn provide(root: &Path, name: &str) -> Result<PathBuf> {
    let environment = root.join(name);
    if works(Command::new(environment.join("bin/python")).args(["-m", "pip", "--version"])) {
        return Ok(environment);
    }
    let make = || {
        let mut make = Command::new("python3");
        make.args(["-m", "venv", "--clear"]).arg(&environment);
        make
    };
    if !works(&mut make()) {
        debian::provide(&["python3", "python3-venv"])?;
        execute(&mut make())?;
    }
    Ok(environment)
}

/// Installs packages from Python's index.
fn pip(python: &Path, packages: &[String]) -> Result<()> {
    let mut install = Command::new(python);
    install.args(["-m", "pip", "install", "-q", "--disable-pip-version-check"]).args(packages);
    execute(&mut install).with_context(|| format!("cannot install {}", packages.join(", ")))
}

/// Builds the wheel and returns its path.
fn build(root: &Path, environment: &Path, profile: Profile) -> Result<PathBuf> {
    let out = root.join("target/wheels");
    // Older wheels would be taken for the new one.
    let _ = std::fs::remove_dir_all(&out);
    let mut maturin = Command::new(environment.join("bin/maturin"));
    maturin.args(["build", "-q"]).args((profile == Profile::Release).then_some("--release"));
    maturin.arg("--interpreter").arg(environment.join("bin/python")).arg("--out").arg(&out);
    maturin.current_dir(root.join(PACKAGE));
    execute(&mut maturin)?;
    let wheels = std::fs::read_dir(&out).with_context(|| format!("cannot read {}", out.display()))?;
    match wheels.flatten().map(|entry| entry.path()).find(|path| path.extension().is_some_and(|kind| kind == "whl")) {
        Some(wheel) => Ok(wheel),
        None => bail!("maturin has left no wheel in {}", out.display()),
    }
}
