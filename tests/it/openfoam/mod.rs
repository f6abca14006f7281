//! Tests of runs whose far field OpenFOAM computes; `cargo xtask openfoam` builds the solver.

mod case_of_user;
mod cells;
mod charging;
mod dictionaries;
mod failures;
mod fields;
mod function_object;
mod gas;
mod gas_alone;
mod gas_meshes;
mod gas_packed;
mod gas_runs;
mod meshes;
mod misfits;
mod parts;
mod patches;
mod potentials;
mod sharing;
mod stated_error;
mod surroundings;
mod thin_walls;
mod tutorials;

use amberfield_tests::{Answer, Workbench};
use std::path::Path;

/// Folder of the examples, of the package `openfoam-examples`.
const EXAMPLES: &str = "/usr/share/doc/openfoam-examples/examples";

/// Relative difference of two fields with tolerances of 1e-2, whose squares add.
pub(crate) const AGREEMENT: f64 = 1.4e-2;

/// A run that went well. What `field` wrote counts also where it says that the mesh does not give the
/// tolerance: these tests know the truth.
fn good(answer: &Answer) {
    let is_written = answer.code == Some(4) && answer.stderr.contains("the results are written");
    assert!(answer.code == Some(0) || is_written, "{}{}", answer.stdout, answer.stderr);
}

/// RMS difference over the RMS of `b`.
pub(crate) fn difference(a: &[f64], b: &[f64]) -> f64 {
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|v| v * v).sum::<f64>();
    (square(&mut a.iter().zip(b).map(|(a, b)| a - b)) / square(&mut b.iter().copied())).sqrt()
}

/// Copies one of OpenFOAM's examples to the folder `foam`.
fn copy_example(bench: &Workbench, folder: &str) {
    copy(&Path::new(EXAMPLES).join(folder), &bench.path("foam"));
}

fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from)
        .expect("openfoam-examples is installed; `cargo xtask openfoam` does it")
        .flatten()
    {
        let target = to.join(entry.file_name());
        if entry.path().is_dir() {
            copy(&entry.path(), &target);
        } else {
            std::fs::copy(entry.path(), target).unwrap();
        }
    }
}
