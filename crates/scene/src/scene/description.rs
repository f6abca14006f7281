//! What a scene says, validated.

use amberfield_core::{Domain, FieldSettings, Gas, Material, Particles, TimeSettings, Wall};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What a scene is read for; decides which sections must be there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// A simulation: needs particles with materials and `[time]`.
    Run,
    /// The field of one snapshot: needs `[domain]`, `[particles]`, `[electric_field]`; radius 0 is allowed.
    Field,
    /// As [`Purpose::Run`] when the scene has `[time]`, else as [`Purpose::Field`].
    Explain,
}

/// A validated scene.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Scene {
    /// Name of the scene: its file's name without the ending.
    pub title: String,
    /// The box; absent only where a `[solver]` brings its own.
    pub domain: Option<Domain>,
    /// Materials, in the order of the file.
    pub materials: Vec<Material>,
    /// Walls, in the order of the file.
    pub walls: Vec<Wall>,
    /// Per wall, the `OpenFOAM` patch with the same surface.
    pub wall_patches: Vec<Option<String>>,
    /// Grains at the start.
    pub particles: Particles,
    /// Names of groups; 0 is `all`.
    pub groups: Vec<String>,
    /// Motion; absent only where no motion is asked for.
    pub time: Option<TimeSettings>,
    /// Electric field; absent: none is computed.
    pub electric_field: Option<ElectricFieldSettings>,
    /// Refinements of charge transfer.
    pub charge_transfer: Option<ChargeTransferSettings>,
    /// External field solver.
    pub solver: Option<SolverSettings>,
    /// Gas around the grains; absent: none.
    pub gas: Option<Gas>,
    /// Outputs.
    pub output: OutputSettings,
    /// What the user should know though nothing is wrong.
    pub warnings: Vec<String>,
    pub(super) resolved: String,
    pub(super) hash: u64,
}

impl Scene {
    /// The scene as TOML with overrides applied and files named by absolute paths.
    #[must_use]
    pub fn resolved(&self) -> &str {
        &self.resolved
    }

    /// Fingerprint of everything that decides the physics: all but `[output]` and `time.end_s`, so that a
    /// checkpoint can be continued to a later end. Data files count with their contents.
    #[must_use]
    pub fn hash(&self) -> u64 {
        self.hash
    }
}

/// `[electric_field]`, in either of its two forms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ElectricFieldSettings {
    /// What the field itself needs. `force_limit` is set only where `limit_field_force` is true.
    pub field: FieldSettings,
    /// Name of the field.
    pub id: String,
    /// Group whose members make and feel the field.
    pub particle_group: String,
    /// Whether the field is computed without a field solver.
    pub use_without_cfd_coupling: bool,
    /// Whether grains trade charge when they touch.
    pub enable_collision_charge_transfer: bool,
    /// Largest distance over which charge is traded [m].
    pub charge_transfer_cutoff_m: f64,
    /// Whether the electric force is bounded.
    pub limit_field_force: bool,
    /// Dimensionless factor of the bound, in [0, 1].
    pub field_force_limit_factor: f64,
    /// Relative tolerance of the linear solver; `None`: automatic.
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

/// `[charge_transfer]`: refinements, each off unless asked for.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ChargeTransferSettings {
    /// Transfer only beyond the contact's previous largest area.
    pub beyond_previous_maximum: bool,
    /// Breakdown field [V/m].
    pub breakdown_field_v_m: Option<f64>,
    /// Whether contact areas are scaled towards the real stiffness.
    pub stiffness_correction: bool,
    /// `v_real/v_soft` in the area factor.
    pub velocity_ratio: f64,
}

/// What happens when the solver is lost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolverLoss {
    /// The run stops.
    #[default]
    Stop,
    /// The internal grid takes over.
    Fallback,
    /// The run waits.
    Wait,
}

/// `[solver]`: an external field solver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolverSettings {
    /// Folder of the `OpenFOAM` case.
    pub openfoam_case: PathBuf,
    /// Another program than `electricFieldFoam`, with our function object in its `controlDict`.
    pub application: Option<String>,
    /// Whether the solver is started by the run.
    pub start: bool,
    /// MPI ranks.
    pub ranks: u32,
    /// Longest wait [s].
    pub timeout_s: f64,
    /// What happens when it is lost.
    pub on_solver_loss: SolverLoss,
}

/// `[output]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OutputSettings {
    /// Interval of particle files [s]; `None`: only the start and the end.
    pub every_s: Option<f64>,
    /// Interval of rows of `history.csv` [s]; `None`: a thousandth of the run, at least a step.
    pub history_every_s: Option<f64>,
    /// Whether `.vtu` files are written.
    pub vtk: bool,
    /// Whether particle CSV files are written.
    pub csv: bool,
    /// Whether a picture of the grains is written.
    pub png: bool,
    /// Interval of checkpoints [s]; `None`: only at the end and when interrupted.
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
