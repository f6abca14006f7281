//! Description of a scene: its validated content.

use super::key_places::KeyPlaces;
use super::physics::Physics;
use amberfield_core::{
    Cohesion, Conductor, ContactRules, Domain, Feeds, FieldSettings, Gas, Material, MaterialPair, Outlet,
    Particles, RollingModel, TimeSettings, Wall,
};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// Purpose for which a scene is read; decides which sections are required.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Simulation: needs particles with materials and `[time]`.
    Run,
    /// Field of one snapshot: needs `[domain]`, `[particles]` and `[electric_field]`; a radius of 0 is
    /// allowed.
    Field,
    /// Explanation: [`Purpose::Run`] when the scene has `[time]`, else [`Purpose::Field`].
    Explain,
}

/// Validated scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Scene {
    /// Name of the scene: the name of its file without the ending.
    pub title: String,
    /// Box; absent only where the mesh of a `[solver]` gives it.
    pub domain: Option<Domain>,
    /// Materials, in the order of the file.
    pub materials: Vec<Material>,
    /// Model of rolling friction.
    pub rolling_model: RollingModel,
    /// Model of cohesion.
    pub cohesion: Cohesion,
    /// Values of pairs of materials, in the order of the file.
    pub pairs: Vec<MaterialPair>,
    /// Walls, in the order of the file.
    pub walls: Vec<Wall>,
    /// `OpenFOAM` patch with the same surface, for each wall.
    pub wall_patches: Vec<Option<String>>,
    /// Particles at the start.
    pub particles: Particles,
    /// Run from whose checkpoint the particles are; `None` where they are from a file or made.
    pub filled: Option<Filled>,
    /// Grains that come while the run goes on.
    pub feeds: Feeds,
    /// Places at which grains leave, sorted by name.
    pub outlets: Vec<Outlet>,
    /// Names of the groups; group 0 is `all`.
    pub groups: Vec<String>,
    /// Settings of the motion; absent only where no motion is asked for.
    pub time: Option<TimeSettings>,
    /// Settings of the electric field; absent where no field is computed.
    pub electric_field: Option<ElectricFieldSettings>,
    /// Refinements of charge transfer.
    pub charge_transfer: Option<ChargeTransferSettings>,
    /// Solver in another process, for the far field or the flow of the gas.
    pub solver: Option<OpenFoamSettings>,
    /// Gas around the grains; absent where there is none.
    pub gas: Option<Gas>,
    /// Settings of the outputs.
    pub output: OutputSettings,
    /// Warnings: facts that the user should know though nothing is wrong.
    pub warnings: Vec<String>,
    pub(super) resolved: String,
    pub(super) physics: Physics,
    pub(super) places: KeyPlaces,
}

/// Run from whose checkpoint a scene has its grains.
#[derive(Clone, Debug, PartialEq)]
pub struct Filled {
    /// Checkpoint.
    pub checkpoint: PathBuf,
    /// Rules of the contacts in that run.
    pub rules: ContactRules,
    /// Whether the scene is the same as that run's, but for where its grains come from.
    pub is_same: bool,
    /// Physics of that run.
    pub(super) physics: Physics,
    /// Fingerprint of the checkpoint.
    pub(super) print: u64,
}

impl Scene {
    /// Text of the scene as TOML, with overrides applied and files named by absolute paths.
    #[must_use]
    pub fn resolved(&self) -> &str {
        &self.resolved
    }

    /// Part of the scene that decides its physics.
    ///
    /// Outputs, the end of the run and how a solver is run are left out: they may change when a run is
    /// continued from a checkpoint. Data files count with their contents.
    #[must_use]
    pub fn physics(&self) -> &Physics {
        &self.physics
    }

    /// Radius of the smallest grain, fed ones included [m]; `None` where none has one.
    #[must_use]
    pub fn smallest_radius(&self) -> Option<f64> {
        let radii = [&self.particles.radius, &self.feeds.grains.radius].into_iter().flatten();
        radii.copied().filter(|radius| *radius > 0.0).min_by(f64::total_cmp)
    }

    /// Conductor that a wall is to the field; `None` where it does not bound it, or is a solver's patch.
    #[must_use]
    pub fn conductor(&self, wall: usize) -> Option<&Conductor> {
        let conductors = &self.electric_field.as_ref()?.field.conductors;
        let bounds = |wall: &Wall| wall.bounds_field;
        let before = self.walls[..wall].iter().filter(|wall| bounds(wall)).count();
        conductors.get(before).filter(|_| bounds(&self.walls[wall]))
    }

    /// Place and value of a key, as a message begins with them: `scene.toml:31: feeds[0].region = { … }`.
    ///
    /// The key is the first of `names` that is there. `number` counts the items of a section that is a list,
    /// in the order of this scene. `None` where the text has no such section.
    #[must_use]
    pub fn cite(&self, section: &str, number: usize, names: &[&str]) -> Option<String> {
        self.places.cite(section, number, names)
    }
}

/// Settings of `[electric_field]`, in either of its two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElectricFieldSettings {
    /// Settings of the field computation; `force_limit` is set only where `limit_field_force` is true.
    pub field: FieldSettings,
    /// Name of the field.
    pub id: String,
    /// Group of the grains that make and feel the field.
    pub particle_group: String,
    /// Switch for a field that is computed without a field solver.
    pub use_without_cfd_coupling: bool,
    /// Switch for charge transfer between touching grains.
    pub enable_collision_charge_transfer: bool,
    /// Cut-off distance of the charge transfer [m].
    pub charge_transfer_cutoff_m: f64,
    /// Switch for the bound on the electric force.
    pub limit_field_force: bool,
    /// Factor of the bound on the electric force, dimensionless, in [0, 1].
    pub field_force_limit_factor: f64,
    /// Relative tolerance of the field solver's linear solver; `None` for an automatic one.
    pub far_tolerance: Option<f64>,
}

/// Default of `charge_transfer_cutoff` [m].
pub(super) const CHARGE_TRANSFER_CUTOFF_M: f64 = 5e-7;
/// Default of `field_force_limit_factor`.
pub(super) const FIELD_FORCE_LIMIT_FACTOR: f64 = 1e-3;
/// Default of `id`.
pub(super) const FIELD_ID: &str = "efield";

impl Default for ElectricFieldSettings {
    fn default() -> Self {
        Self {
            field: FieldSettings::default(),
            id: FIELD_ID.to_owned(),
            particle_group: "all".to_owned(),
            use_without_cfd_coupling: true,
            enable_collision_charge_transfer: false,
            charge_transfer_cutoff_m: CHARGE_TRANSFER_CUTOFF_M,
            limit_field_force: false,
            field_force_limit_factor: FIELD_FORCE_LIMIT_FACTOR,
            far_tolerance: None,
        }
    }
}

/// Settings of `[charge_transfer]`: refinements, each off unless asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChargeTransferSettings {
    /// Switch for transfer only beyond the previous largest area of a contact.
    pub beyond_previous_maximum: bool,
    /// Breakdown field [V/m]; `None` for no limit.
    pub breakdown_field_v_m: Option<f64>,
    /// Switch for contact areas that are corrected to the real stiffness.
    pub stiffness_correction: bool,
    /// Ratio `v_real/v_soft` of impact velocities in the area correction.
    pub velocity_ratio: f64,
}

/// Behaviour of a run that loses its solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolverLoss {
    /// Stop the run.
    #[default]
    Stop,
    /// Continue with the internal grid.
    Fallback,
    /// Wait for the solver.
    Wait,
}

/// Settings of `[solver]`, the `OpenFOAM` process that computes the far field or the flow of a gas.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OpenFoamSettings {
    /// Folder of the `OpenFOAM` case.
    pub openfoam_case: PathBuf,
    /// Program other than `electricFieldFoam`, with the function object of this project in its `controlDict`.
    pub application: Option<String>,
    /// Switch for a solver that the run starts itself.
    pub start: bool,
    /// Number of MPI ranks.
    pub ranks: u32,
    /// File with the machines of the ranks; `None`: this one.
    pub hosts: Option<PathBuf>,
    /// Longest silence of a solver that lives [s].
    pub timeout_s: f64,
    /// Longest wait for a solver that somebody else starts [s]; `None`: for ever.
    pub wait_s: Option<f64>,
    /// Behaviour when the solver is lost.
    pub on_solver_loss: SolverLoss,
}

/// Settings of `[output]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputSettings {
    /// Interval of particle files [s]; `None` for the start and the end only.
    pub every_s: Option<f64>,
    /// Interval of rows of `history.csv` [s]; `None` for a thousandth of the run, at least a step.
    pub history_every_s: Option<f64>,
    /// Switch for `.vtu` files.
    pub vtk: bool,
    /// Switch for particle CSV files.
    pub csv: bool,
    /// Switch for a picture of the grains.
    pub png: bool,
    /// Interval of checkpoints [s]; `None` for the end and interruptions only.
    pub checkpoint_every_s: Option<f64>,
}

impl Default for OutputSettings {
    fn default() -> Self {
        Self {
            every_s: None,
            history_every_s: None,
            vtk: true,
            csv: false,
            png: false,
            checkpoint_every_s: None,
        }
    }
}
