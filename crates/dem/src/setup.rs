//! Parts of a simulation.

use amberfield_core::{
    ChargeTransfer, Cohesion, Domain, Feeds, FieldSettings, Gas, Material, MaterialPair, Outlet, Particles,
    RollingModel, TimeSettings, Wall,
};
use amberfield_field::Choice;
use amberfield_field::far::Connect;
use amberfield_gas::ConnectFlow;

/// The electric field of a scene.
#[derive(Clone, Debug)]
pub struct FieldStageSetup {
    /// Settings of the field.
    pub settings: FieldSettings,
    /// Whether each grain, in the order of `Setup::particles` and then of `Setup::feeds`, makes and feels the
    /// field.
    pub member: Vec<bool>,
    /// Parameters chosen earlier; `None` lets the field choose.
    pub choice: Option<Choice>,
    /// A field solver of another process; `None`: the internal grid.
    pub solver: Option<Connect>,
    /// Charge transfer on contact; `None`: charges stay as they are.
    pub transfer: Option<ChargeTransfer>,
    /// Whether the internal grid goes on when the field solver is lost; its boundaries are the domain's.
    pub fallback: bool,
}

impl FieldStageSetup {
    /// Asks for a field on the internal grid, with parameters of its own choice.
    #[must_use]
    pub fn new(settings: FieldSettings, member: Vec<bool>) -> Self {
        Self { settings, member, choice: None, solver: None, transfer: None, fallback: false }
    }
}

/// The gas of a scene.
#[derive(Clone, Debug)]
pub struct GasSetup {
    /// Properties of the gas, and its drag law.
    pub gas: Gas,
    /// Solver of its flow; `None`: the gas is the same everywhere.
    pub solver: Option<ConnectFlow>,
}

impl From<Gas> for GasSetup {
    /// Takes a gas that is the same everywhere.
    fn from(gas: Gas) -> Self {
        Self { gas, solver: None }
    }
}

/// A scene, validated by `Simulation::new`.
#[derive(Clone, Debug)]
pub struct Setup {
    /// The box; its periodic faces join the motion too.
    pub domain: Domain,
    /// Materials that grains and walls refer to.
    pub materials: Vec<Material>,
    /// Model of rolling friction.
    pub rolling_model: RollingModel,
    /// Model of cohesion.
    pub cohesion: Cohesion,
    /// Values of pairs of materials, instead of mixed ones.
    pub pairs: Vec<MaterialPair>,
    /// Grains at the start.
    pub particles: Particles,
    /// Contact walls.
    pub walls: Vec<Wall>,
    /// Step, gravity, skin and rules of the run.
    pub time: TimeSettings,
    /// Gas around the grains; `None`: none.
    pub gas: Option<GasSetup>,
    /// Electric field; `None`: plain DEM.
    pub field: Option<FieldStageSetup>,
    /// Grains that come while the run goes on.
    pub feeds: Feeds,
    /// Places at which grains leave.
    pub outlets: Vec<Outlet>,
}
