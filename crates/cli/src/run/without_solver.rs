//! A build without the feature `coupling`: no field solver, and no shared memory.

use super::setup::Solver;
use crate::failure::Failure;
use amberfield_scene::Scene;

/// Refuses a scene with a field solver.
pub(crate) fn connect_solver(scene: &mut Scene) -> Result<Solver, Failure> {
    match scene.solver {
        None => Ok(Solver::default()),
        Some(_) => Err(Failure::bad_input(
            "this build has no coupling with OpenFOAM; build amberfield-cli with its feature `coupling`, or remove [solver]",
        )),
    }
}
