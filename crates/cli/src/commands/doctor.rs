//! Command `amberfield doctor`.

use crate::arguments::DoctorOptions;
use crate::failure::Failure;
use crate::machine;
use crate::print::line;
use crate::run::{is_stale, remove_leftovers};
use std::path::{Path, PathBuf};

/// Prints what the machine offers, and which runs ended without cleaning up.
pub(crate) fn doctor(options: &DoctorOptions) -> Result<(), Failure> {
    line(format_args!("amberfield {}", env!("CARGO_PKG_VERSION")));
    let features = machine::cpu_features();
    let features = if features.is_empty() { "none known".to_owned() } else { features.join(" ") };
    line(format_args!("processor: {}", machine::cpu_name().unwrap_or_else(|| "not named".to_owned())));
    line(format_args!("vector extensions: {features}"));
    line(format_args!("threads: {}", rayon::current_num_threads()));
    match machine::memory() {
        Some((total, available)) => {
            line(format_args!("memory: {}, {} available", machine::bytes(total), machine::bytes(available)))
        }
        None => line(format_args!("memory: not known on this system")),
    }
    match machine::shared_memory() {
        Some((total, free)) => line(format_args!(
            "shared memory: /dev/shm {}, {} free (a run with a field solver needs about 100 bytes \
             for each grain and each cell)",
            machine::bytes(total),
            machine::bytes(free)
        )),
        None => line(format_args!("shared memory: no /dev/shm; a run cannot have a field solver")),
    }
    match openfoam() {
        Some(path) => line(format_args!("OpenFOAM: {}", path.display())),
        None => line(format_args!("OpenFOAM: not found; without [solver] the internal grid is used")),
    }
    solver(options.clean);
    stale_runs(options.clean)
}

/// Path of `OpenFOAM`, from its environment or from one of its applications on the search path.
fn openfoam() -> Option<PathBuf> {
    let project = std::env::var_os("WM_PROJECT_DIR").map(PathBuf::from);
    let application = || {
        let path = std::env::var_os("PATH")?;
        std::env::split_paths(&path).map(|folder| folder.join("foamDictionary")).find(|file| file.is_file())
    };
    project.filter(|folder| folder.is_dir()).or_else(application)
}

/// Prints the programs of the solvers, and the runs in shared memory whose DEM process is gone.
#[cfg(feature = "coupling")]
fn solver(clean: bool) {
    let [field, gas] = [false, true].map(amberfield_coupling::solver_program);
    for (what, program) in [("field solver", &field), ("gas solver", &gas)] {
        match amberfield_coupling::existing(program) {
            Some(path) => line(format_args!("{what}: {}", path.display())),
            None => line(format_args!(
                "{what}: {} not found (only runs with [solver] need it; docs/openfoam.md has the way to it)",
                program.display()
            )),
        }
    }
    if let Some(field) = amberfield_coupling::existing(&field) {
        let surroundings = amberfield_coupling::Surroundings::of(&field);
        for fact in &surroundings.found {
            line(format_args!("{fact}"));
        }
        for problem in &surroundings.wrong {
            line(format_args!("warning: {problem}"));
        }
    }
    let stale = amberfield_coupling::stale_runs(clean);
    if stale.is_empty() {
        line(format_args!("stale shared memory: none"));
    }
    for name in stale {
        let what = if clean { "removed" } else { "doctor --clean removes it" };
        line(format_args!("stale shared memory: {name} ({what})"));
    }
}

/// Prints that this build has no field solver.
#[cfg(not(feature = "coupling"))]
fn solver(_: bool) {
    line(format_args!("field solver: not part of this build"));
}

/// Prints the run folders here and one level below whose process is gone.
fn stale_runs(clean: bool) -> Result<(), Failure> {
    let mut folders = vec![PathBuf::from(".")];
    let entries = std::fs::read_dir(".").into_iter().flatten().flatten();
    folders.extend(entries.map(|entry| Path::new(".").join(entry.file_name())).filter(|path| path.is_dir()));
    folders.retain(|folder| is_stale(folder));
    folders.sort();
    if folders.is_empty() {
        line(format_args!("stale runs: none in the current folder"));
    }
    for folder in &folders {
        if clean {
            let removed = remove_leftovers(folder)
                .map_err(|error| Failure::bad_input(format!("{}: {error}", folder.display())))?;
            line(format_args!(
                "stale run: {} ({removed} leftover files removed; results stay)",
                folder.display()
            ));
        } else {
            line(format_args!(
                "stale run: {} (its process is gone; doctor --clean removes the mark, results stay)",
                folder.display()
            ));
        }
    }
    Ok(())
}
