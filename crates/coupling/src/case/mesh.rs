//! The mesh of a case that has only a recipe for it.

use super::contents::{CaseContents, MESH, RECIPE, has_mesh};
use super::tools::{Stop, run_tool};
use super::unusable;
use super::workplace::{Workplace, write_mark};
use crate::CouplingError;
use std::path::Path;
use std::time::SystemTime;

/// Fingerprint of the recipe from which a run's own mesh was made.
const MARK: &str = "mesh.fingerprint";

/// Makes the mesh of a case that has only a recipe, `system/blockMeshDict`, where that is due.
pub(super) fn provide_mesh(place: &Workplace, stop: Stop) -> Result<(), CouplingError> {
    let case = place.case();
    if has_mesh(case) {
        warn_of_newer_recipe(case);
        return Ok(());
    }
    if !case.join(RECIPE).is_file() {
        return Err(unusable(case, format!("has neither {MESH} nor {RECIPE}; {}", advice(case))));
    }
    let print = CaseContents::of_file(case, RECIPE)?.fingerprint();
    if place.has_mark(MARK, print) && has_mesh(place.folder()) {
        return Ok(());
    }
    place.remove_mark(MARK);
    let _ = std::fs::remove_dir_all(place.folder().join(MESH));
    tracing::info!("making the mesh of {} with blockMesh", case.display());
    run_tool("blockMesh", place.path(), &place.log("blockMesh"), &[], stop)?;
    write_mark(place, MARK, print)
}

/// Advice to who has no mesh where one is looked for.
fn advice(case: &Path) -> String {
    let regions = std::fs::read_dir(case.join("constant")).into_iter().flatten().flatten();
    let regions: Vec<String> = regions
        .filter(|entry| entry.path().join("polyMesh").is_dir())
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    if regions.is_empty() {
        return "make the mesh".to_owned();
    }
    format!(
        "it is a case of several regions ({}), and only cases of one are possible: make a case of the region \
         in which the grains are",
        regions.join(", ")
    )
}

/// Warns where a recipe was changed after the mesh was made: the mesh counts.
fn warn_of_newer_recipe(case: &Path) {
    let time_of = |path: &str| -> Option<SystemTime> {
        case.join(path).metadata().and_then(|data| data.modified()).ok()
    };
    let mesh = time_of("constant/polyMesh/points").or_else(|| time_of("constant/polyMesh/points.gz"));
    if let (Some(mesh), Some(recipe)) = (mesh, time_of(RECIPE))
        && recipe > mesh
    {
        tracing::warn!(
            "{RECIPE} of {} is newer than its mesh, which counts; run blockMesh if it is to be made anew",
            case.display()
        );
    }
}
