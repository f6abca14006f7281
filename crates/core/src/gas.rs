//! Settings of the gas around the grains.

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

/// Model of how grains and a flow act on each other (Zhou, Kuang, Chu & Yu, J. Fluid Mech. 661, 482 (2010)).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum GasModel {
    /// The pressure acts on gas and grains, each by its share of the volume (set II).
    #[default]
    A,
    /// The pressure acts on the gas alone, and drag is larger (set III).
    B,
}

/// Flow that a solver in another process computes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct GasFlow {
    /// Model.
    pub model: GasModel,
    /// Time between exchanges [s].
    pub interval_s: f64,
    /// Radius over which grains are smoothed [m]; `None`: one that suits cells and grains.
    pub smoothing_length_m: Option<f64>,
    /// Whether the gas's viscous stress acts on grains (model A).
    pub viscous_force: bool,
    /// Whether grains in a shear flow are lifted.
    pub saffman_lift: bool,
    /// Whether the gas flows on while the grains move, who then feel the flow of an interval earlier.
    pub overlap: bool,
}

/// The gas around the grains.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gas {
    /// Drag.
    pub drag: DragLaw,
    /// Density [kg/m³].
    pub density_kg_m3: f64,
    /// Viscosity [Pa·s].
    pub viscosity_pa_s: f64,
    /// Velocity where no flow is computed [m/s].
    pub velocity_m_s: Vector3<f64>,
    /// Whether spinning grains are lifted.
    pub magnus_lift: bool,
    /// The flow; `None`: the gas is the same everywhere, and the grains do not disturb it.
    pub flow: Option<GasFlow>,
}
