//! The scene's field solver: started before anything else, because its mesh may bring the box.

use crate::failure::Failure;
use amberfield_core::{Axis, Domain, Method};
use amberfield_coupling::{Announced, CouplingError, PatientSolver, RemoteSolver, SolverSettings};
use amberfield_field::far::{Connect, FarField};
use amberfield_scene::{Scene, SolverLoss};
use std::sync::Mutex;
use std::time::Duration;

/// Relative tolerance of the linear solver over the field's, unless the scene says it.
const FAR_TOLERANCE: f64 = 1e-4;

/// Reaches the scene's field solver, if it has one; the scene's box is the mesh's where it has none of its own.
pub(crate) fn connect_solver(scene: &mut Scene) -> Result<Option<Connect>, Failure> {
    let (Some(solver), Some(field)) = (&scene.solver, &scene.electric_field) else { return Ok(None) };
    refuse(field.field.method)?;
    if field.field.overlap && (field.field.method != Method::P3m || solver.on_solver_loss == SolverLoss::Wait)
    {
        return Err(Failure::bad_input(
            "electric_field.overlap = true needs method \"p3m\" and solver.on_solver_loss \"stop\" or \"fallback\"; change one of them",
        ));
    }
    if solver.on_solver_loss == SolverLoss::Fallback && scene.domain.is_none() {
        return Err(Failure::bad_input(
            "solver.on_solver_loss = \"fallback\" needs the box and the boundaries with which the internal grid goes on; add [domain] and [domain.boundary]",
        ));
    }
    // What it prints stays in its case's folder, as is usual.
    let program = solver.application.as_deref().unwrap_or("electricFieldFoam");
    let settings = SolverSettings {
        case: solver.openfoam_case.clone(),
        application: solver.application.clone(),
        start: solver.start,
        ranks: solver.ranks,
        timeout: Duration::from_secs_f64(solver.timeout_s),
        far_tolerance: field.far_tolerance.unwrap_or(FAR_TOLERANCE * field.field.tolerance),
        log: Some(solver.openfoam_case.join(format!("log.{program}"))),
    };
    let connected = connect(&settings).map_err(|error| Failure::of_field(&error.into()))?;
    let mesh = connected.mesh();
    tracing::info!("field solver: {} cells, {} boundary faces", mesh.cell_count(), mesh.boundary().len());
    match &scene.domain {
        None => scene.domain = Some(mesh.domain().clone()),
        Some(domain) => agree(domain, mesh.domain())?,
    }
    let waits = solver.on_solver_loss == SolverLoss::Wait;
    // The one that is there first, then new ones.
    let first = Mutex::new(Some(connected));
    Ok(Some(Connect::new(move || {
        let waiting = first.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).take();
        let solver = match waiting {
            Some(solver) => solver,
            None => connect(&settings)?,
        };
        Ok(if waits {
            Box::new(PatientSolver::new(settings.clone(), solver))
        } else {
            Box::new(solver) as Box<dyn FarField>
        })
    })))
}

fn connect(settings: &SolverSettings) -> Result<RemoteSolver, CouplingError> {
    Announced::new(settings.clone())?.connect()
}

/// Refuses what is not built over a solver's mesh.
fn refuse(method: Method) -> Result<(), Failure> {
    if !matches!(method, Method::P3m | Method::Kolehmainen) {
        return Err(Failure::bad_input(format!(
            "this version has no method {method} over a field solver's mesh; set electric_field.method = \"p3m\" or \"kolehmainen\", or remove [solver]"
        )));
    }
    Ok(())
}

/// Refuses a box that is not the mesh's.
fn agree(domain: &Domain, mesh: &Domain) -> Result<(), Failure> {
    const SAME: f64 = 1e-6;
    for axis in Axis::ALL {
        let ends = |box_of: &Domain| [box_of.min()[axis.index()], box_of.max()[axis.index()]];
        let ([low, high], [mesh_low, mesh_high]) = (ends(domain), ends(mesh));
        let periodic = domain.is_periodic(axis);
        let far = SAME * (mesh_high - mesh_low);
        if periodic != mesh.is_periodic(axis) {
            let [ours, theirs] = if periodic { ["", "not "] } else { ["not ", ""] };
            return Err(Failure::bad_input(format!(
                "[domain] is {ours}periodic along {axis}, the mesh of [solver] openfoam_case is {theirs}cyclic there; make them agree, or leave [domain] out"
            )));
        }
        if periodic && ((low - mesh_low).abs() > far || (high - mesh_high).abs() > far) {
            return Err(Failure::bad_input(format!(
                "[domain] reaches from {low} to {high} m along {axis}, the mesh of [solver] openfoam_case from {mesh_low} to {mesh_high} m; a periodic axis must be the same in both"
            )));
        }
    }
    Ok(())
}
