//! Folder with a scene, and the binary to run in it.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::OnceLock;

/// Path of the `amberfield` binary of this build.
///
/// # Panics
/// When it cannot be built.
fn binary() -> &'static Path {
    static BINARY: OnceLock<PathBuf> = OnceLock::new();
    BINARY.get_or_init(|| {
        // `cargo test` builds the binaries of its own package only; this one belongs to another.
        let mut folder = std::env::current_exe().expect("a test has a path");
        folder.pop();
        if folder.ends_with("deps") {
            folder.pop();
        }
        let mut build = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        // The whole workspace is named, as where the tests were built: for a part of it, crates would be
        // compiled once more, with other features.
        build.args(["build", "--quiet", "--workspace", "--all-targets"]);
        if folder.ends_with("release") {
            build.arg("--release");
        }
        if let Some(target) = folder.parent() {
            build.env("CARGO_TARGET_DIR", target);
        }
        build.current_dir(env!("CARGO_MANIFEST_DIR"));
        assert!(build.status().expect("cargo runs").success(), "the binary must build");
        folder.join(format!("amberfield{}", std::env::consts::EXE_SUFFIX))
    })
}

/// Answer of a command.
#[derive(Clone, Debug)]
pub struct Answer {
    /// Exit code; `None` when a signal ended it.
    pub code: Option<i32>,
    /// Text of stdout: the summary.
    pub stdout: String,
    /// Text of stderr: progress, log, errors.
    pub stderr: String,
}

/// Folder that is removed at the end, and the binary to run in it.
#[derive(Debug)]
pub struct Workbench(tempfile::TempDir);

impl Workbench {
    /// Folder with a file `scene.toml`.
    ///
    /// # Panics
    /// When the folder cannot be made.
    #[must_use]
    pub fn new(scene: &str) -> Self {
        let bench = Self(tempfile::tempdir().expect("a folder for the test"));
        bench.write("scene.toml", scene);
        bench
    }

    /// Writes a file of the folder.
    ///
    /// # Panics
    /// When it cannot be written.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("a file for the test");
    }

    /// Reads a file of the folder.
    ///
    /// # Panics
    /// When it cannot be read.
    #[must_use]
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Path of a file of the folder.
    #[must_use]
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Names of the files in a subfolder, sorted.
    #[must_use]
    pub fn names(&self, folder: &str) -> Vec<String> {
        let entries = std::fs::read_dir(self.path(folder)).into_iter().flatten().flatten();
        let mut names: Vec<_> =
            entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    /// Command that is ready to start in the folder.
    #[must_use]
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(binary());
        command.args(arguments).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    /// Runs a command to its end.
    ///
    /// # Panics
    /// When it cannot be started.
    #[must_use]
    pub fn run(&self, arguments: &[&str]) -> Answer {
        let output = self.command(arguments).output().expect("the binary starts");
        Answer {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

/// Table of texts from a CSV file.
#[derive(Clone, Debug, PartialEq)]
pub struct CsvTable {
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows.
    pub rows: Vec<Vec<String>>,
}

impl CsvTable {
    /// Splits a CSV text that has no quotes.
    #[must_use]
    pub fn parse(text: &str) -> Self {
        let mut rows = text.lines().map(|line| line.split(',').map(ToOwned::to_owned).collect::<Vec<_>>());
        Self { columns: rows.next().unwrap_or_default(), rows: rows.collect() }
    }

    /// Copy of the table without the columns of clock readings, which differ from run to run.
    #[must_use]
    pub fn without_clocks(&self) -> Self {
        let kept: Vec<usize> =
            (0..self.columns.len()).filter(|k| !self.columns[*k].starts_with("wall_s")).collect();
        let pick = |row: &Vec<String>| kept.iter().map(|k| row[*k].clone()).collect();
        Self { columns: pick(&self.columns), rows: self.rows.iter().map(pick).collect() }
    }

    /// Numbers of a column.
    ///
    /// # Panics
    /// When the column is absent or holds something other than numbers.
    #[must_use]
    pub fn numbers(&self, column: &str) -> Vec<f64> {
        let index = self.columns.iter().position(|name| name == column).expect("the column is there");
        self.rows.iter().map(|row| row[index].parse().expect("a number")).collect()
    }
}
