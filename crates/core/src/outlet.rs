//! Outlets: places at which grains leave a run and are counted.

use crate::domain::{Axis, Side};
use crate::volume::Volume;
use serde::{Deserialize, Serialize};

/// Place at which grains leave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum OutletRegion {
    /// Volume: a grain leaves in the step in which its centre is in it.
    Volume(Volume),
    /// Face of the box: a grain leaves where it would leave through that face.
    Face(Axis, Side),
}

/// Outlet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outlet {
    /// Name, which no other outlet has.
    pub name: String,
    /// Place.
    pub region: OutletRegion,
    /// Whether each grain that leaves here gets a row of its own.
    pub each: bool,
}
