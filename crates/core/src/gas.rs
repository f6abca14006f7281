//! What a scene says of the gas around the grains, where no flow is computed: it is the same everywhere.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// Drag of a gas on a grain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DragLaw {
    /// Creeping flow.
    Stokes,
    /// A sphere alone, up to high Reynolds numbers.
    #[default]
    SchillerNaumann,
    /// Di Felice's suspension.
    DiFelice,
    /// Ergun's bed, Wen and Yu's suspension.
    Gidaspow,
    /// Beds of lattice-Boltzmann simulations.
    Beetstra,
}

impl DragLaw {
    /// All laws.
    pub const ALL: [Self; 5] =
        [Self::Stokes, Self::SchillerNaumann, Self::DiFelice, Self::Gidaspow, Self::Beetstra];

    /// The name used in scene files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Stokes => "stokes",
            Self::SchillerNaumann => "schiller_naumann",
            Self::DiFelice => "di_felice",
            Self::Gidaspow => "gidaspow",
            Self::Beetstra => "beetstra",
        }
    }
}

/// A gas that the grains do not disturb.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gas {
    /// Drag.
    pub drag: DragLaw,
    /// Density [kg/m³].
    pub density_kg_m3: f64,
    /// Viscosity [Pa·s].
    pub viscosity_pa_s: f64,
    /// Velocity [m/s].
    pub velocity_m_s: Vector3<f64>,
    /// Whether spinning grains are lifted.
    pub magnus_lift: bool,
}
