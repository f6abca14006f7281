//! Connection to the scene's solver, which is started first because its mesh may give the box.

use super::bare_patches::warning_of_bare_patches;
use super::face_potentials;
use super::setup::SolverConnections;
use super::solver_folder::SolverFolder;
use crate::failure::Failure;
use crate::interrupt;
use amberfield_core::{Axis, Domain, Method};
use amberfield_coupling::{
    Announced, CaseContents, CouplingError, PatientSolver, RemoteSolver, SolverSettings, Workplace,
    lacks_field,
};
use amberfield_field::far::{Connect, FarField};
use amberfield_gas::ConnectFlow;
use amberfield_scene::{
    ElectricFieldSettings, OpenFoamSettings, Purpose, Scene, SceneError, SceneInput, SolverLoss,
};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Ratio of the linear solver's relative tolerance to that of the field, unless the scene gives the
/// tolerance.
const FAR_TOLERANCE: f64 = 1e-4;

/// Reads a scene. Where one of its walls is a patch of a mesh that is not made yet, the mesh is made first,
/// in the solver's folder.
pub(crate) fn read_input(
    scene: &SceneInput,
    overrides: &[String],
    purpose: Purpose,
    folder: &SolverFolder,
) -> Result<Scene, Failure> {
    match scene.read(overrides, purpose, None) {
        Err(SceneError::NoMesh { case }) => {
            let place = Workplace::open(&case, folder.path()).map_err(of_coupling)?;
            place.provide_mesh(interrupt::asked).map_err(of_coupling)?;
            let mesh = Some(place.folder());
            Ok(scene.read(overrides, purpose, mesh)?)
        }
        result => Ok(result?),
    }
}

/// Contents of the case of a scene from which its solver's answers follow; `None` where it has no solver.
pub(crate) fn case_contents(scene: &Scene) -> Result<Option<CaseContents>, Failure> {
    let Some(solver) = scene.solver.as_ref().filter(|_| is_solved_for(scene)) else { return Ok(None) };
    match CaseContents::of_physics(&solver.openfoam_case) {
        // Who starts the solver elsewhere may have the case elsewhere, too.
        Err(_) if !solver.start => Ok(None),
        contents => contents.map(Some).map_err(of_coupling),
    }
}

/// Clears a solver's folder for a new run.
pub(crate) fn clear_solver_folder(folder: &SolverFolder) -> Result<(), Failure> {
    Workplace::clear(folder.path()).map_err(of_coupling)
}

/// Whether the scene's solver has something to solve for.
fn is_solved_for(scene: &Scene) -> bool {
    scene.electric_field.is_some() || scene.gas.is_some_and(|gas| gas.flow.is_some())
}

/// Failure of what this program and the solver do together.
fn of_coupling(error: CouplingError) -> Failure {
    match error {
        CouplingError::Stopped(what) => Failure::interrupted(what),
        error => Failure::of_field(&error.into()),
    }
}

/// Connects to the scene's solver, if it has one.
///
/// A scene without a box takes the box of the solver's mesh.
pub(crate) fn connect_solver(scene: &mut Scene, folder: &SolverFolder) -> Result<SolverConnections, Failure> {
    let flows = scene.gas.is_some_and(|gas| gas.flow.is_some());
    let Some(solver) = scene.solver.as_ref().filter(|_| is_solved_for(scene)) else {
        return Ok(SolverConnections::default());
    };
    if let Some(field) = &scene.electric_field {
        refuse(field, solver)?;
        refuse_without_potential(scene, solver)?;
    }
    if flows {
        refuse_with_gas(solver)?;
    }
    if solver.on_solver_loss == SolverLoss::Fallback && scene.domain.is_none() {
        return Err(Failure::bad_input(
            "solver.on_solver_loss = \"fallback\" needs the box and the boundaries with which the internal \
             grid continues; add [domain] and [domain.boundary]",
        ));
    }

    let settings = settings_of(solver, scene.electric_field.as_ref(), flows, folder);
    let has_field = scene.electric_field.is_some();
    let waits = solver.on_solver_loss == SolverLoss::Wait;
    let connected = connect(&settings).map_err(of_coupling)?;
    let mesh = connected.mesh();
    tracing::info!("field solver: {} cells, {} boundary faces", mesh.cell_count(), mesh.boundary().len());
    let mut warnings: Vec<String> = warning_of_bare_patches(scene, mesh).into_iter().collect();
    match &scene.domain {
        None => scene.domain = Some(mesh.domain().clone()),
        Some(domain) => {
            agree(domain, mesh.domain())?;
            warnings.extend(beyond(domain, mesh.domain()));
            if has_field {
                warnings.extend(face_potentials::compare(domain, mesh, solver.on_solver_loss)?);
            }
        }
    }

    let flow = flows.then(|| ConnectFlow::once(connected.flow()));
    // The first call takes the connection that exists; later calls, after a loss, make new ones.
    let first = Mutex::new(Some(connected));
    let field = has_field.then(|| {
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
    Ok(SolverConnections { field, flow, warnings })
}

/// Settings of the connection to a solver; `flows` says that it computes the flow of a gas.
fn settings_of(
    solver: &OpenFoamSettings,
    field: Option<&ElectricFieldSettings>,
    flows: bool,
    folder: &SolverFolder,
) -> SolverSettings {
    let far_tolerance =
        |field: &ElectricFieldSettings| field.far_tolerance.unwrap_or(FAR_TOLERANCE * field.field.tolerance);
    SolverSettings {
        case: solver.openfoam_case.clone(),
        workplace: solver.start.then(|| folder.path().to_path_buf()),
        application: solver.application.clone(),
        flow: flows,
        ranks: solver.ranks,
        hosts: solver.hosts.clone(),
        timeout: Duration::from_secs_f64(solver.timeout_s),
        wait: solver.wait_s.map(Duration::from_secs_f64),
        far_tolerance: field.map_or(FAR_TOLERANCE, far_tolerance),
        stop: interrupt::asked,
    }
}

/// Announces the run and waits for the solver.
fn connect(settings: &SolverSettings) -> Result<RemoteSolver, CouplingError> {
    Announced::new(settings.clone())?.connect()
}

/// Refuses settings that do not work with a solver's mesh.
fn refuse(field: &ElectricFieldSettings, solver: &OpenFoamSettings) -> Result<(), Failure> {
    let method = field.field.method;
    if !matches!(method, Method::P3m | Method::Kolehmainen) {
        return Err(Failure::bad_input(format!(
            "this version has no method {method} over a field solver's mesh; \
             set electric_field.method = \"p3m\" or \"kolehmainen\", or remove [solver]"
        )));
    }
    if field.field.overlap && (method != Method::P3m || solver.on_solver_loss == SolverLoss::Wait) {
        return Err(Failure::bad_input(
            "electric_field.overlap = true needs method \"p3m\" and solver.on_solver_loss \"stop\" or \
             \"fallback\"; change one of them",
        ));
    }
    Ok(())
}

/// Refuses a case without the potential that the field's solver begins with. Who starts the solver elsewhere
/// may have the case elsewhere, too.
fn refuse_without_potential(scene: &Scene, solver: &OpenFoamSettings) -> Result<(), Failure> {
    const POTENTIAL: &str = "phiE";
    let case = &solver.openfoam_case;
    if !(solver.start && lacks_field(case, POTENTIAL)) {
        return Ok(());
    }
    let place =
        scene.cite("solver", 0, &["openfoam_case"]).map_or_else(String::new, |place| format!("{place}: "));
    Err(Failure::bad_input(format!(
        "{place}the case has no potential 0/{POTENTIAL}, a volScalarField, at or before the time from which \
         it starts, and the scene has an electric field; add it, with the conditions of the field at each \
         patch"
    )))
}

/// Refuses settings that do not work with a solver that computes the flow of a gas.
fn refuse_with_gas(solver: &OpenFoamSettings) -> Result<(), Failure> {
    if solver.on_solver_loss != SolverLoss::Stop {
        return Err(Failure::bad_input(
            "gas.flow = \"solver\" needs solver.on_solver_loss = \"stop\": the state of the flow is lost \
             with its \
             solver; only a checkpoint has it",
        ));
    }
    if let Some(application) = &solver.application {
        return Err(Failure::bad_input(format!(
            "solver.application = \"{application}\" cannot compute the flow between grains; \
             leave it out with gas.flow = \"solver\""
        )));
    }
    Ok(())
}

/// Warning about a box that reaches beyond the mesh.
fn beyond(domain: &Domain, mesh: &Domain) -> Option<String> {
    /// Share of the length by which it may.
    const SLACK: f64 = 1e-3;
    Axis::ALL.into_iter().find_map(|axis| {
        let k = axis.index();
        let slack = SLACK * mesh.extent()[k];
        let is_beyond = domain.min()[k] < mesh.min()[k] - slack || domain.max()[k] > mesh.max()[k] + slack;
        is_beyond.then(|| {
            format!(
                "[domain] reaches from {} to {} m along {axis}, the mesh of [solver] only from {} to {} m: a \
                 grain that leaves the mesh ends the run; make them agree, or leave [domain] out",
                domain.min()[k],
                domain.max()[k],
                mesh.min()[k],
                mesh.max()[k]
            )
        })
    })
}

/// Refuses a box that differs from that of the mesh.
///
/// The ends are compared along periodic axes only.
fn agree(domain: &Domain, mesh: &Domain) -> Result<(), Failure> {
    /// Share of the length by which the ends may differ.
    const SAME: f64 = 1e-6;
    for axis in Axis::ALL {
        let ends = |box_of: &Domain| [box_of.min()[axis.index()], box_of.max()[axis.index()]];
        let ([low, high], [mesh_low, mesh_high]) = (ends(domain), ends(mesh));
        let periodic = domain.is_periodic(axis);
        let far = SAME * (mesh_high - mesh_low);
        if periodic != mesh.is_periodic(axis) {
            let [ours, theirs] = if periodic { ["", "not "] } else { ["not ", ""] };
            return Err(Failure::bad_input(format!(
                "[domain] is {ours}periodic along {axis}, the mesh of [solver] openfoam_case is \
                 {theirs}cyclic \
                 there; make them agree, or leave [domain] out"
            )));
        }
        if periodic && ((low - mesh_low).abs() > far || (high - mesh_high).abs() > far) {
            return Err(Failure::bad_input(format!(
                "[domain] reaches from {low} to {high} m along {axis}, the mesh of [solver] openfoam_case \
                 from {mesh_low} to {mesh_high} m; a periodic axis must be the same in both"
            )));
        }
    }
    Ok(())
}
