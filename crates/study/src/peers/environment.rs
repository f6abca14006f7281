//! The Python environment with the other programs, and the scripts that drive them.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A script: a program and what it is asked for. Its first argument names a file of numbers, see
/// [`write_numbers`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Script {
    /// Steps of LAMMPS' granular package.
    LammpsDem,
    /// Beds that settle by LAMMPS' granular package. Every line has mean height [m], kinetic energy [J].
    LammpsRest,
    /// Steps of a bed in LAMMPS without charges, with `pppm`, or with our fix. Every line has skin
    /// [diameters], rank, seconds a step by the clock and by the processor, evaluations per step, stated
    /// error.
    LammpsBed,
    /// E by LAMMPS' `pppm` or `msm`. Every line has cut-off [m], order, share of the tolerance asked for, 1
    /// for analytic differentiation, error, seconds with the neighbour list kept, seconds with it built
    /// anew.
    LammpsField,
    /// E by FMM3D. Every line has precision, error, seconds.
    Fmm3d,
}

impl Script {
    fn text(self) -> &'static str {
        match self {
            Self::LammpsDem => include_str!("../../peers/lammps_dem.py"),
            Self::LammpsRest => include_str!("../../peers/lammps_rest.py"),
            Self::LammpsBed => include_str!("../../peers/lammps_bed.py"),
            Self::LammpsField => include_str!("../../peers/lammps_field.py"),
            Self::Fmm3d => include_str!("../../peers/fmm3d.py"),
        }
    }

    /// The Python module that it needs.
    #[must_use]
    pub fn module(self) -> &'static str {
        match self {
            Self::LammpsDem | Self::LammpsRest | Self::LammpsBed | Self::LammpsField => "lammps",
            Self::Fmm3d => "fmm3dpy",
        }
    }
}

/// An environment with the programs.
#[derive(Clone, Debug)]
pub struct Environment(PathBuf);

impl Environment {
    /// The environment in a folder; `None` where there is none.
    #[must_use]
    pub fn at(folder: &Path) -> Option<Self> {
        folder.join("bin/python").exists().then(|| Self(folder.to_path_buf()))
    }

    /// Runs a script on so many ranks: its lines of numbers.
    ///
    /// # Errors
    /// A program that is not there or fails, with the last line that it said.
    pub fn run(&self, script: Script, ranks: usize, arguments: &[&str]) -> Result<Vec<Vec<f64>>, String> {
        let bin = self.0.join("bin");
        let mut command = if ranks > 1 {
            let mut mpi = Command::new(bin.join("mpirun"));
            mpi.arg("-n").arg(ranks.to_string()).arg(bin.join("python"));
            mpi
        } else {
            Command::new(bin.join("python"))
        };
        command.args(["-c", script.text()]).args(arguments);
        command.env("LD_LIBRARY_PATH", self.0.join("lib")).env("OMP_NUM_THREADS", "1").stdin(Stdio::null());
        let module = script.module();
        let output = command.output().map_err(|error| format!("cannot start {module}: {error}"))?;
        if !output.status.success() {
            let said = String::from_utf8_lossy(&output.stderr);
            return Err(format!("{module} failed: {}", said.lines().last().unwrap_or("without a word")));
        }
        let numbers = |line: &str| line.split(',').map(str::parse).collect::<Result<Vec<f64>, _>>().ok();
        Ok(String::from_utf8_lossy(&output.stdout).lines().filter_map(numbers).collect())
    }
}

/// Writes numbers as scripts read them: eight bytes each, little endian.
///
/// # Errors
/// What the system says.
pub fn write_numbers(path: &Path, numbers: impl IntoIterator<Item = f64>) -> std::io::Result<()> {
    let mut writer = std::io::BufWriter::new(std::fs::File::create(path)?);
    for number in numbers {
        writer.write_all(&number.to_le_bytes())?;
    }
    writer.flush()
}

/// Reads numbers that a script wrote in the same form.
///
/// # Errors
/// What the system says.
pub fn read_numbers(path: &Path) -> std::io::Result<Vec<f64>> {
    let bytes = std::fs::read(path)?;
    let number = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().expect("chunks of eight"));
    Ok(bytes.chunks_exact(8).map(number).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn environment_is_there_or_not() {
        assert!(Environment::at(Path::new("/nowhere")).is_none());
    }

    #[test]
    fn numbers_that_are_written_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("numbers.bin");
        write_numbers(&path, [1.5, -2e-300]).unwrap();
        assert_eq!(read_numbers(&path).unwrap(), [1.5, -2e-300]);
    }
}
