//! Replacement of `solver.rs` in a build without the feature `coupling`, which has no field solver.

use super::setup::{CaseContents, SolverConnections};
use super::solver_folder::SolverFolder;
use crate::failure::Failure;
use amberfield_scene::{Purpose, Scene, SceneInput};

/// Reads a scene.
pub(crate) fn read_input(
    scene: &SceneInput,
    overrides: &[String],
    purpose: Purpose,
    _: &SolverFolder,
) -> Result<Scene, Failure> {
    Ok(scene.read(overrides, purpose, None)?)
}

/// Refuses a scene with a field solver.
pub(crate) fn connect_solver(scene: &mut Scene, _: &SolverFolder) -> Result<SolverConnections, Failure> {
    match scene.solver {
        None => Ok(SolverConnections::default()),
        Some(_) => Err(Failure::bad_input(
            "this build has no coupling with OpenFOAM; build amberfield-cli with its feature `coupling`, \
             or remove [solver]",
        )),
    }
}

/// Contents of the case of a scene: none.
pub(crate) fn case_contents(_: &Scene) -> Result<Option<CaseContents>, Failure> {
    Ok(None)
}

/// Clears nothing.
pub(crate) fn clear_solver_folder(_: &SolverFolder) -> Result<(), Failure> {
    Ok(())
}
