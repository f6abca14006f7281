//! Helpers that run the binary on a copy of a case and read what it writes.

use amberfield_core::Vector3;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// Coulomb's constant 1/(4πε₀) [V·m/C], CODATA 2018; not taken from the code under test.
pub(crate) const COULOMB: f64 = 8.987_551_792_3e9;

/// Tells whether cases run at full size (`AMBERFIELD_CASES=full`) or at smoke size.
pub(crate) fn full_size() -> bool {
    std::env::var("AMBERFIELD_CASES").is_ok_and(|size| size == "full")
}

/// Curve in the plot of a case.
pub(crate) use amberfield_draw::Series as Curve;

/// Draws curves: at full size into the case's folder, at smoke size into the folder of build results.
pub(crate) fn plot(case: &str, name: &str, [x, y]: [&str; 2], logarithmic: bool, curves: Vec<Curve>) {
    use amberfield_draw::{Plot, Scale, write_plot};
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let folder = if full_size() { root.join("cases") } else { root.join("target/case-plots") }.join(case);
    fs::create_dir_all(&folder).expect("a folder");
    let scales = [if logarithmic { Scale::Logarithmic } else { Scale::Linear }; 2];
    let title = format!("{case}: {name}");
    let plot = Plot { title: &title, x, y, scales, series: &curves, ringed: &[] };
    write_plot(&folder.join(format!("{name}.svg")), &plot).expect("a plot");
}

/// Copy of a case's folder that may be changed and run.
pub(crate) struct Case {
    folder: TempDir,
}

impl Case {
    /// Copies the files of `cases/<name>`.
    pub(crate) fn new(name: &str) -> Self {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../cases").join(name);
        let folder = tempfile::tempdir().expect("a temporary folder");
        for entry in fs::read_dir(&source).unwrap_or_else(|error| panic!("{}: {error}", source.display())) {
            let path = entry.expect("an entry").path();
            if path.is_file() {
                fs::copy(&path, folder.path().join(path.file_name().expect("a file has a name")))
                    .expect("a copy");
            }
        }
        let case = Self { folder };
        for part in ["0", "constant", "system"] {
            let entries = fs::read_dir(source.join("foam").join(part));
            let paths = entries.into_iter().flatten().map(|entry| entry.expect("an entry").path());
            for path in paths.filter(|path| path.is_file()) {
                let copy = case.path("foam").join(part);
                fs::create_dir_all(&copy).expect("a folder");
                fs::copy(&path, copy.join(path.file_name().expect("a file has a name"))).expect("a copy");
            }
        }
        case
    }

    /// Path of a file in the copy.
    pub(crate) fn path(&self, file: &str) -> PathBuf {
        self.folder.path().join(file)
    }

    /// Writes a file into the copy.
    pub(crate) fn write(&self, file: &str, text: &str) {
        fs::write(self.path(file), text).expect("a file is written");
    }

    /// Replaces a text in a file of the copy; the text must be there.
    pub(crate) fn replace(&self, file: &str, from: &str, to: &str) {
        let text = fs::read_to_string(self.path(file)).expect("a file");
        assert!(text.contains(from), "{file} does not contain {from:?}");
        self.write(file, &text.replace(from, to));
    }

    /// Table from a CSV file of the copy.
    pub(crate) fn table(&self, file: &str) -> NumberTable {
        NumberTable::read(&self.path(file))
    }

    /// Runs `amberfield field scene.toml` with more arguments; returns the table of the field.
    pub(crate) fn field(&self, arguments: &[&str]) -> NumberTable {
        let out = self.path("field.csv");
        let out = out.to_str().expect("a readable path");
        self.execute(&[&["field", "scene.toml", "--out", out], arguments].concat());
        NumberTable::read(Path::new(out))
    }

    /// Runs `amberfield study` on a file; returns the page with the given name.
    pub(crate) fn study(&self, file: &str, name: &str) -> String {
        self.execute(&["study", file, "--out", "study"]);
        fs::read_to_string(self.path("study").join(format!("{name}.md"))).expect("a page")
    }

    /// Runs `amberfield run scene.toml` with more arguments; returns the run folder.
    pub(crate) fn run(&self, arguments: &[&str]) -> Run<'_> {
        self.execute(&[&["run", "scene.toml", "--out", "run"], arguments].concat());
        Run { case: self }
    }

    fn execute(&self, arguments: &[&str]) {
        let output = Command::new(env!("CARGO_BIN_EXE_amberfield"))
            .args(arguments)
            .args(["--no-progress", "--threads", "2"])
            .current_dir(self.folder.path())
            .output()
            .expect("the binary starts");
        let messages = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "amberfield {}: {}\n{messages}", arguments.join(" "), output.status);
    }
}

/// Run folder.
pub(crate) struct Run<'a> {
    case: &'a Case,
}

impl Run<'_> {
    /// Path of a file in the run folder.
    pub(crate) fn path(&self, file: &str) -> PathBuf {
        self.case.path("run").join(file)
    }

    /// Table from `history.csv`.
    pub(crate) fn history(&self) -> NumberTable {
        NumberTable::read(&self.path("history.csv"))
    }

    /// Table from the last particles CSV.
    pub(crate) fn last_particles(&self) -> NumberTable {
        NumberTable::read(self.particle_files().last().expect("a particles CSV"))
    }

    /// Tables from all particles CSVs, with their times.
    pub(crate) fn frames(&self) -> Vec<Frame> {
        let summary = fs::read_to_string(self.path("summary.json")).expect("a summary");
        let (_, step) = summary.split_once("\"step_s\": ").expect("a step");
        let step: f64 = step.split([',', '\n']).next().expect("a number").trim().parse().expect("a number");
        let number = |path: &Path| {
            let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
            name.rsplit('_').next().expect("a step").parse::<f64>().expect("a step")
        };
        self.particle_files()
            .iter()
            .map(|path| Frame { time_s: step * number(path), grains: NumberTable::read(path) })
            .collect()
    }

    fn particle_files(&self) -> Vec<PathBuf> {
        let folder = self.path("particles");
        let files = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        let paths = files.map(|entry| entry.expect("an entry").path());
        let mut paths: Vec<PathBuf> =
            paths.filter(|path| path.extension().is_some_and(|ending| ending == "csv")).collect();
        paths.sort();
        paths
    }
}

/// Grains at one moment of a run.
pub(crate) struct Frame {
    pub(crate) time_s: f64,
    pub(crate) grains: NumberTable,
}

/// Table of the numbers in a CSV file; cells that are no numbers are NaN.
pub(crate) struct NumberTable {
    path: PathBuf,
    columns: Vec<Column>,
}

/// Column of a table.
struct Column {
    name: String,
    numbers: Vec<f64>,
}

impl NumberTable {
    fn read(path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let mut lines = text.lines();
        let header = lines.next().expect("a header");
        let mut columns: Vec<Column> = header
            .split(',')
            .map(|name| Column { name: name.trim().to_owned(), numbers: Vec::new() })
            .collect();
        for line in lines {
            for (column, cell) in columns.iter_mut().zip(line.split(',')) {
                column.numbers.push(cell.trim().parse().unwrap_or(f64::NAN));
            }
        }
        Self { path: path.to_owned(), columns }
    }

    /// Numbers of the column with a name.
    pub(crate) fn column(&self, name: &str) -> &[f64] {
        let column = self.columns.iter().find(|column| column.name == name);
        &column.unwrap_or_else(|| panic!("{} has no column {name}", self.path.display())).numbers
    }

    fn vectors(&self, names: [&str; 3]) -> Vec<Vector3<f64>> {
        let [x, y, z] = names.map(|name| self.column(name));
        (0..x.len()).map(|row| Vector3::new(x[row], y[row], z[row])).collect()
    }

    /// Positions [m].
    pub(crate) fn positions(&self) -> Vec<Vector3<f64>> {
        self.vectors(["x_m", "y_m", "z_m"])
    }

    /// Fields [V/m].
    pub(crate) fn field(&self) -> Vec<Vector3<f64>> {
        self.vectors(["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"])
    }
}
