//! Settings of the electric field.

use crate::conductor::Conductor;
use crate::course::FieldCourse;
use crate::domain::FaceCourse;
use crate::permittivity::Permittivity;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Method by which the electric field at the particles is computed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Method {
    /// Plain sum over neighbours within the cut-off radius.
    Cutoff,
    /// Every pair and every image; periodic sums by Ewald. The truth for tests.
    Direct,
    /// The published hybrid: nearest-cell charge, cell-constant far field, pairwise correction.
    Kolehmainen,
    /// Particle–particle particle–mesh with smooth Gaussian splitting.
    #[default]
    P3m,
}

impl Method {
    /// All methods.
    pub const ALL: [Self; 4] = [Self::Cutoff, Self::Direct, Self::Kolehmainen, Self::P3m];

    /// The name used in scene files, on the command line and in results.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Cutoff => "cutoff",
            Self::Direct => "direct",
            Self::Kolehmainen => "kolehmainen",
            Self::P3m => "p3m",
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Method {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|method| method.name() == text)
            .ok_or_else(|| format!("unknown method '{text}'; give one of cutoff, direct, kolehmainen, p3m"))
    }
}

/// Way of choosing among candidates of parameters that meet the tolerance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Tuning {
    /// Candidates are timed once; the choice is recorded and reused on resume. Two fresh runs may choose
    /// differently, and then differ within the tolerance.
    Timed,
    /// The cost model decides alone: the same choice in every run and on every machine.
    #[default]
    Model,
}

/// Interval after which the field is evaluated anew.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CouplingInterval {
    /// Displacement, charge change and plasma limit decide.
    #[default]
    Auto,
    /// The field is evaluated after this number of steps.
    Steps(u32),
}

/// Upper bound on the electric force on one grain.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForceLimit {
    /// Dimensionless factor in [0, 1] on m·skin/Δt².
    pub factor: f64,
}

/// Settings of the electric field of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldSettings {
    /// Method.
    pub method: Method,
    /// Relative RMS error of E that is asked for (p3m).
    pub tolerance: f64,
    /// Near cut-off radius r_c [m], when the scene fixes it.
    pub cutoff_radius_m: Option<f64>,
    /// Permittivity of the medium.
    #[serde(rename = "relative_permittivity")]
    pub permittivity: Permittivity,
    /// Uniform external field [V/m], at t = 0 where it changes.
    pub external_field_v_m: Vector3<f64>,
    /// Uniform external field over time; `None` where it stays as it is.
    pub external_course: Option<FieldCourse>,
    /// Whether a net charge in an insulating or periodic box is balanced by a uniform background.
    pub neutralising_background: bool,
    /// Cells of the internal grid per axis, when the scene fixes them.
    pub grid_cells: Option<[usize; 3]>,
    /// Way of choosing parameters.
    pub tuning: Tuning,
    /// Interval after which the field is evaluated anew.
    pub coupling_interval: CouplingInterval,
    /// Whether a field solver of another process works beside the steps: its part of the field is then
    /// forecast from its last two answers.
    pub overlap: bool,
    /// Bound on the electric force, when asked for.
    pub force_limit: Option<ForceLimit>,
    /// Conductors inside the box that bound the field.
    #[serde(default)]
    pub conductors: Vec<Conductor>,
}

impl FieldSettings {
    /// Longest step of a run that shows the external field and potentials of faces [s]: a
    /// twentieth of the shortest period; infinite where none has one.
    #[must_use]
    pub fn longest_step_s(&self, faces: &[FaceCourse]) -> f64 {
        let external = self.external_course.iter().map(|course| course.longest_step_s());
        let faces = faces.iter().map(|face| face.course.longest_step_s());
        external.chain(faces).fold(f64::INFINITY, f64::min)
    }
}

impl Default for FieldSettings {
    fn default() -> Self {
        Self {
            method: Method::P3m,
            tolerance: 1e-2,
            cutoff_radius_m: None,
            permittivity: Permittivity::VACUUM,
            external_field_v_m: Vector3::zeros(),
            external_course: None,
            neutralising_background: false,
            grid_cells: None,
            tuning: Tuning::default(),
            coupling_interval: CouplingInterval::Auto,
            overlap: false,
            force_limit: None,
            conductors: Vec::new(),
        }
    }
}
