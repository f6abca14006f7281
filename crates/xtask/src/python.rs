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
/// Packages that build, check and test it; those that it needs itself are in its `pyproject.toml`.
const TOOLS: [&str; 3] = ["maturin>=1.9,<2", "pytest>=7", "ruff>=0.9,<1"];

/// Makes the package's environment, builds the wheel and runs its tests.
pub(crate) fn run(root: &Path, profile: Profile) -> Result<()> {
    provide(root)?;
    test(root, profile)
}

/// Makes the environment of the tests, with all that the package needs.
pub(crate) fn provide(root: &Path) -> Result<()> {
    let environment = root.join(ENVIRONMENT);
    if !works(Command::new(environment.join("bin/python")).args(["-m", "pip", "--version"])) {
        make_environment(&environment)?;
    }
    let needed = needed(&root.join(PACKAGE).join("pyproject.toml"))?;
    pip(&environment, &[], &[TOOLS.map(str::to_owned).as_slice(), &needed].concat())
}

/// Builds the wheel, installs it into the environment and runs the package's checks and tests there.
pub(crate) fn test(root: &Path, profile: Profile) -> Result<()> {
    let environment = root.join(ENVIRONMENT);
    for check in [&["format", "--check"][..], &["check"]] {
        let mut ruff = Command::new(environment.join("bin/ruff"));
        execute(ruff.args(check).arg("-q").current_dir(root.join(PACKAGE)))?;
    }
    let wheel = build(root, &environment, profile)?;
    // It has the version of the one before.
    pip(&environment, &["--force-reinstall", "--no-deps"], &[wheel.display().to_string()])?;
    let mut tests = Command::new(environment.join("bin/python"));
    execute(tests.args(["-m", "pytest"]).current_dir(root.join(PACKAGE)))
}

/// Makes an environment of Python's.
pub(crate) fn make_environment(environment: &Path) -> Result<()> {
    let make = || {
        let mut make = Command::new("python3");
        make.args(["-m", "venv", "--clear"]).arg(environment);
        make
    };
    if works(&mut make()) {
        return Ok(());
    }
    debian::provide(&["python3", "python3-venv"])?;
    execute(&mut make())
}

/// Packages that the package says it needs.
fn needed(manifest: &Path) -> Result<Vec<String>> {
    let text =
        std::fs::read_to_string(manifest).with_context(|| format!("cannot read {}", manifest.display()))?;
    let line = text.lines().find_map(|line| line.strip_prefix("dependencies = ["));
    let line = line.with_context(|| format!("{}: no line of dependencies", manifest.display()))?;
    Ok(line.split('"').skip(1).step_by(2).map(str::to_owned).collect())
}

/// Installs packages from Python's index.
pub(crate) fn pip(environment: &Path, options: &[&str], packages: &[String]) -> Result<()> {
    let mut install = Command::new(environment.join("bin/python"));
    install.args(["-m", "pip", "install", "-q", "--disable-pip-version-check"]).args(options).args(packages);
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
    match wheels
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.extension().is_some_and(|kind| kind == "whl"))
    {
        Some(wheel) => Ok(wheel),
        None => bail!("maturin has left no wheel in {}", out.display()),
    }
}
