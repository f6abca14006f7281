//! Replacement of `solver.rs` in a build without the feature `coupling`, which has no field solver.

use super::setup::SolverConnections;
use crate::failure::Failure;
use amberfield_scene::Scene;
pub(crate) use amberfield_scene::read_scene;

/// Refuses a scene with a field solver.
pub(crate) fn connect_solver(scene: &mut Scene) -> Result<SolverConnections, Failure> {
    match scene.solver {
        None => Ok(SolverConnections::default()),
        Some(_) => Err(Failure::bad_input(
            "this build has no coupling with OpenFOAM; build amberfield-cli with its feature `coupling`, \
             or remove [solver]",
        )),
    }
}
