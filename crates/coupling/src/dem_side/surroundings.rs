//! Surroundings of a field solver: which OpenFOAM, MPI and libraries it meets, and what does not fit.

use crate::case::on_path;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Library of OpenFOAM's that every solver has, and the folder of its libraries where one is sourced.
const CORE: &str = "libOpenFOAM.so";
const SOURCED: &str = "FOAM_LIBBIN";
/// Library of MPI; version 40 is Open MPI's.
const MPI: &str = "libmpi.so.";
const OPEN_MPI: (&str, &str) = ("libmpi.so.40", "Open MPI");
/// Program that lists the libraries of another, and its words for one that is not there.
const LISTS: &str = "ldd";
const MISSING: &str = "not found";
/// Program of OpenFOAM's that cuts cases, and the one that starts several processes.
const TOOL: &str = "decomposePar";
const STARTER: &str = "mpirun";

/// Surroundings of a field solver.
#[derive(Debug, Default)]
pub struct Surroundings {
    /// Facts, one a line.
    pub found: Vec<String>,
    /// Facts that do not fit together, with advice.
    pub wrong: Vec<String>,
}

impl Surroundings {
    /// Surroundings of a solver's program.
    #[must_use]
    pub fn of(program: &Path) -> Self {
        let mut all = Self::default();
        let Some(program) = existing(program) else {
            all.wrong.push(format!(
                "there is no program {}; `cargo xtask openfoam` builds it, or ./Allwmake where OpenFOAM is \
                 sourced",
                program.display()
            ));
            return all;
        };
        let libraries = libraries_of(&program);
        all.look_at_openfoam(&program, &libraries);
        all.look_at_mpi(&libraries);
        all
    }

    fn look_at_openfoam(&mut self, program: &Path, libraries: &[Library]) {
        let missing: Vec<&str> =
            libraries.iter().filter(|library| library.path.is_none()).map(|library| &*library.name).collect();
        if !missing.is_empty() {
            self.wrong.push(format!(
                "{} does not find {}; source the OpenFOAM that it was built with, or build it anew",
                program.display(),
                missing.join(", ")
            ));
        }
        let core = path_of(libraries, CORE);
        if let Some(core) = core {
            self.found.push(format!("OpenFOAM's libraries: {}", core.display()));
        }
        match on_path(TOOL) {
            Some(tool) => self.found.push(format!("OpenFOAM's programs: {}", tool.display())),
            None => self.wrong.push(format!(
                "{TOOL} is not on the PATH; install OpenFOAM (Debian: openfoam), or source its etc/bashrc"
            )),
        }
        let sourced = std::env::var_os(SOURCED).map(PathBuf::from);
        if let (Some(core), Some(sourced)) = (core, sourced)
            && !core.starts_with(&sourced)
        {
            self.wrong.push(format!(
                "the OpenFOAM that is sourced has its libraries in {}, but {} takes {}; open a shell without \
                 it, or build the field solver for it with openfoam-solver/Allwmake",
                sourced.display(),
                program.display(),
                core.display()
            ));
        }
    }

    fn look_at_mpi(&mut self, libraries: &[Library]) {
        let Some(starter) = on_path(STARTER) else {
            self.wrong.push(format!("{STARTER} is not on the PATH; several ranks need it"));
            return;
        };
        let version = printed(STARTER, &["--version"]);
        let version = version.lines().next().unwrap_or_default().trim();
        self.found.push(format!("MPI's starter: {} ({version})", starter.display()));
        let Some(library) = libraries.iter().find(|library| library.name.starts_with(MPI)) else { return };
        if let Some(path) = &library.path {
            self.found.push(format!("MPI's library: {}", path.display()));
        }
        let wants_open_mpi = library.name.starts_with(OPEN_MPI.0);
        if wants_open_mpi != version.contains(OPEN_MPI.1) {
            self.wrong.push(format!(
                "{} is \"{version}\", but the field solver is linked to {}; put the mpirun of that MPI first \
                 on the PATH",
                starter.display(),
                library.name
            ));
        }
    }
}

/// Library of a program.
struct Library {
    name: String,
    /// `None` where it is not found.
    path: Option<PathBuf>,
}

/// Libraries of a program, those of its libraries too.
fn libraries_of(program: &Path) -> Vec<Library> {
    let said = printed(LISTS, &[program.as_os_str()]);
    let library = |line: &str| {
        let (name, rest) = line.trim().split_once(" => ")?;
        let path = rest.split(" (").next()?.trim();
        let path = (path != MISSING && !path.is_empty()).then(|| PathBuf::from(path));
        Some(Library { name: name.to_owned(), path })
    };
    said.lines().filter_map(library).collect()
}

fn path_of<'a>(libraries: &'a [Library], name: &str) -> Option<&'a Path> {
    libraries.iter().find(|library| library.name == name)?.path.as_deref()
}

/// Text that a program prints; empty where it cannot be run.
fn printed(program: &str, options: &[impl AsRef<std::ffi::OsStr>]) -> String {
    let output = Command::new(program).args(options).output();
    output.map(|output| String::from_utf8_lossy(&output.stdout).into_owned()).unwrap_or_default()
}

/// Path of a program: of a name alone, that on the PATH. `None` where there is none.
#[must_use]
pub fn existing(program: &Path) -> Option<PathBuf> {
    if program.components().count() == 1 { on_path(program.to_str()?) } else { program.canonicalize().ok() }
}
