//! Set-up of a simulation from the description of a scene.

use super::solver::read_input;
use super::solver_folder::SolverFolder;
use crate::failure::Failure;
use amberfield_core::{ChargeTransfer, Domain, Feeds, FieldSettings, Vector3};
use amberfield_dem::{FieldStageSetup, GasSetup, Setup};
use amberfield_field::far::Connect;
use amberfield_field::{Choice, ElectricField};
use amberfield_gas::ConnectFlow;
use amberfield_scene::{Purpose, Scene, SceneInput, SolverLoss};
use serde_json::{Map, Value, json};
use std::path::Path;

/// Reads a scene file. Where one of its walls is a patch of a mesh that is not made yet, the mesh is made
/// first, in the solver's folder.
pub(crate) fn read_scene(
    path: &Path,
    overrides: &[String],
    purpose: Purpose,
    folder: &SolverFolder,
) -> Result<Scene, Failure> {
    read_input(&SceneInput::File(path.to_path_buf()), overrides, purpose, folder)
}

/// Box of a scene.
pub(crate) fn domain_of(scene: &Scene) -> Result<&Domain, Failure> {
    scene.domain.as_ref().ok_or_else(|| Failure::bad_input("the scene has no [domain]; add it"))
}

/// Flags of the grains that make and feel the field: those at the start, then those of feeds.
pub(crate) fn members(scene: &Scene) -> Vec<bool> {
    let group = scene.electric_field.as_ref().map_or("all", |field| &field.particle_group);
    let index = scene.groups.iter().position(|name| name == group);
    let all = scene.particles.group.iter().chain(&scene.feeds.grains.group);
    all.map(|id| group == "all" || index == Some(usize::from(id.0))).collect()
}

/// Grains that make and feel the field.
pub(crate) struct Charges {
    /// Indices of the grains in the scene.
    pub(crate) index: Vec<usize>,
    /// Positions [m], wrapped into the domain where it is known.
    pub(crate) position: Vec<Vector3<f64>>,
    /// Charges [C].
    pub(crate) charge: Vec<f64>,
}

/// Selects the grains of a scene that make and feel the field.
pub(crate) fn charges_of(scene: &Scene) -> Charges {
    let member = members(scene);
    let index: Vec<usize> = (0..scene.particles.len()).filter(|&index| member[index]).collect();
    let wrapped = |&index: &usize| {
        let position = scene.particles.position[index];
        scene.domain.as_ref().map_or(position, |domain| domain.wrap(position))
    };
    Charges {
        position: index.iter().map(wrapped).collect(),
        charge: index.iter().map(|&index| scene.particles.charge[index]).collect(),
        index,
    }
}

/// Parameters of a choice as one flat JSON object, in which `built` names its kind.
#[must_use]
pub fn parameters(choice: &Choice) -> Value {
    match serde_json::to_value(choice) {
        Ok(Value::Object(kinds)) if kinds.len() == 1 => {
            let (built, inner) = kinds.into_iter().next().expect("there is one");
            let mut flat = match inner {
                Value::Object(flat) => flat,
                other => Map::from_iter([("value".to_owned(), other)]),
            };
            flat.insert("built".to_owned(), Value::String(built));
            Value::Object(flat)
        }
        Ok(built) => json!({ "built": built }),
        Err(_) => Value::Null,
    }
}

/// Contents of a solver's case.
#[cfg(feature = "coupling")]
pub(crate) use amberfield_coupling::CaseContents;

/// Contents of a solver's case, which a build without one does not have.
#[cfg(not(feature = "coupling"))]
#[derive(Clone, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) struct CaseContents(std::collections::BTreeMap<String, u64>);

#[cfg(not(feature = "coupling"))]
impl CaseContents {
    /// Changes since earlier contents: none.
    pub(crate) fn changes_since(&self, _: &Self) -> Vec<String> {
        Vec::new()
    }
}

/// Connections to the scene's solver; both are `None` without a solver.
#[derive(Clone, Debug, Default)]
pub(crate) struct SolverConnections {
    /// Connection for the electric field.
    pub(crate) field: Option<Connect>,
    /// Connection for the flow of the gas.
    pub(crate) flow: Option<ConnectFlow>,
    /// Warnings about the scene on the solver's mesh.
    pub(crate) warnings: Vec<String>,
}

/// Set-up of the simulation of a scene, with its solver; `choice` are field parameters that were chosen
/// earlier. The scene's particles are moved into it.
pub(crate) fn setup_of(
    scene: &mut Scene,
    choice: Option<Choice>,
    solver: SolverConnections,
) -> Result<Setup, Failure> {
    let time = scene.time.clone().ok_or_else(|| Failure::bad_input("the scene has no [time]; add it"))?;
    let field = scene.electric_field.as_ref().map(|field| FieldStageSetup {
        settings: field.field.clone(),
        member: members(scene),
        choice,
        solver: solver.field,
        transfer: transfer_of(scene),
        fallback: falls_back(scene),
    });
    Ok(Setup {
        domain: domain_of(scene)?.clone(),
        materials: scene.materials.clone(),
        rolling_model: scene.rolling_model,
        cohesion: scene.cohesion,
        pairs: scene.pairs.clone(),
        particles: std::mem::take(&mut scene.particles),
        walls: scene.walls.clone(),
        time,
        gas: scene.gas.map(|gas| GasSetup { gas, solver: solver.flow }),
        field,
        feeds: take_feeds(scene),
        outlets: scene.outlets.clone(),
    })
}

/// Feeds of a scene with their grains; the scene keeps the feeds alone.
fn take_feeds(scene: &mut Scene) -> Feeds {
    let feeds = std::mem::take(&mut scene.feeds);
    scene.feeds.list.clone_from(&feeds.list);
    feeds
}

/// Settings of charge transfer at contacts, if the scene asks for it.
fn transfer_of(scene: &Scene) -> Option<ChargeTransfer> {
    let field = scene.electric_field.as_ref().filter(|field| field.enable_collision_charge_transfer)?;
    let plain = ChargeTransfer::new(field.charge_transfer_cutoff_m);
    Some(scene.charge_transfer.as_ref().map_or(plain, |asked| ChargeTransfer {
        beyond_previous_maximum: asked.beyond_previous_maximum,
        breakdown_field_v_m: asked.breakdown_field_v_m,
        stiffness_correction: asked.stiffness_correction.then_some(asked.velocity_ratio),
        ..plain
    }))
}

/// Tells whether the run continues with the internal grid when the field solver is lost.
fn falls_back(scene: &Scene) -> bool {
    scene.solver.as_ref().is_some_and(|solver| solver.on_solver_loss == SolverLoss::Fallback)
}

/// Electric field of a scene's charges, on the internal grid or over the mesh of a field solver.
pub(crate) fn field_of(
    domain: &Domain,
    settings: &FieldSettings,
    solver: Option<Connect>,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Result<ElectricField, Failure> {
    // For one snapshot there is no other work that could be done beside the solver's.
    let settings = &FieldSettings { overlap: false, ..settings.clone() };
    let field = match solver {
        None => ElectricField::new(domain, settings, positions, charges),
        Some(solver) => {
            solver.connect().and_then(|solver| ElectricField::over_mesh(solver, settings, positions, charges))
        }
    };
    field.map_err(|error| Failure::of_field(&error))
}
