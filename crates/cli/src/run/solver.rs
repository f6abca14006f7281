//! The scene's field solver: started before anything else, because its mesh may bring the box.

use super::setup::Solver;
use crate::failure::Failure;
use amberfield_core::{Axis, Domain, Method};
use amberfield_coupling::{
    Announced, CouplingError, PatientSolver, RemoteSolver, SolverSettings, program_name,
};
use amberfield_field::far::{Connect, FarField};
use amberfield_gas::ConnectFlow;
use amberfield_scene::{ElectricFieldSettings, Scene, SolverLoss, SolverSettings as Asked};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Relative tolerance of the linear solver over the field's, unless the scene says it.
const FAR_TOLERANCE: f64 = 1e-4;

/// Reaches the scene's field solver, if it has one; the scene's box is the mesh's where it has none of its own.
pub(crate) fn connect_solver(scene: &mut Scene) -> Result<Solver, Failure> {
    let flows = scene.gas.is_some_and(|gas| gas.flow.is_some());
    let Some(solver) = &scene.solver else { return Ok(Solver::default()) };
    if scene.electric_field.is_none() && !flows {
        return Ok(Solver::default());
    }
    if let Some(field) = &scene.electric_field {
        refuse(field, solver)?;
    }
    if flows {
        refuse_with_gas(solver)?;
    }
    if solver.on_solver_loss == SolverLoss::Fallback && scene.domain.is_none() {
        return Err(Failure::bad_input(
            "solver.on_solver_loss = \"fallback\" needs the box and the boundaries with which the internal grid goes on; add [domain] and [domain.boundary]",
        ));
    }
    // What it prints stays in its case's folder, as is usual.
    let program = solver.application.as_deref().unwrap_or(program_name(flows));
    let asked = scene.electric_field.as_ref();
    let far_tolerance =
        |field: &ElectricFieldSettings| field.far_tolerance.unwrap_or(FAR_TOLERANCE * field.field.tolerance);
    let settings = SolverSettings {
        case: solver.openfoam_case.clone(),
        application: solver.application.clone(),
        flow: flows,
        start: solver.start,
        ranks: solver.ranks,
        timeout: Duration::from_secs_f64(solver.timeout_s),
        far_tolerance: asked.map_or(FAR_TOLERANCE, far_tolerance),
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
    let flow = flows.then(|| ConnectFlow::once(connected.flow()));
    // The one that is there first, then new ones.
    let first = Mutex::new(Some(connected));
    let field = asked.is_some().then(|| {
        Connect::new(move || {
            let solver = match first.lock().unwrap_or_else(PoisonError::into_inner).take() {
                Some(solver) => solver,
                None => connect(&settings)?,
            };
            Ok(if waits {
                Box::new(PatientSolver::new(settings.clone(), solver))
            } else {
                Box::new(solver) as Box<dyn FarField>
            })
        })
    });
    Ok(Solver { field, flow })
}

fn connect(settings: &SolverSettings) -> Result<RemoteSolver, CouplingError> {
    Announced::new(settings.clone())?.connect()
}

/// Refuses what is not built over a solver's mesh.
fn refuse(field: &ElectricFieldSettings, solver: &Asked) -> Result<(), Failure> {
    let method = field.field.method;
    if !matches!(method, Method::P3m | Method::Kolehmainen) {
        return Err(Failure::bad_input(format!(
            "this version has no method {method} over a field solver's mesh; set electric_field.method = \"p3m\" or \"kolehmainen\", or remove [solver]"
        )));
    }
    if field.field.overlap && (method != Method::P3m || solver.on_solver_loss == SolverLoss::Wait) {
        return Err(Failure::bad_input(
            "electric_field.overlap = true needs method \"p3m\" and solver.on_solver_loss \"stop\" or \"fallback\"; change one of them",
        ));
    }
    Ok(())
}

/// Refuses what a solver with the flow of a gas cannot be.
fn refuse_with_gas(solver: &Asked) -> Result<(), Failure> {
    if solver.on_solver_loss != SolverLoss::Stop {
        return Err(Failure::bad_input(
            "gas.flow = \"solver\" needs solver.on_solver_loss = \"stop\": the state of the flow is lost with its solver; a checkpoint has it",
        ));
    }
    if let Some(application) = &solver.application {
        return Err(Failure::bad_input(format!(
            "solver.application = \"{application}\" cannot compute the flow between grains; leave it out with gas.flow = \"solver\""
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
