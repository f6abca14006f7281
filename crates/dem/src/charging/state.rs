//! State of charge transfer, for checkpoints.

use super::contact_field::AtWall;
use super::{ChargedSpot, Ledger};
use crate::contacts::memory::PairGrowth;
use serde::{Deserialize, Serialize};

/// State of charge transfer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct ChargingState {
    /// Charges now, and at the last evaluation of the field, by the set-up's order [C].
    pub(crate) charge: Vec<f64>,
    pub(crate) evaluated: Vec<f64>,
    pub(crate) pairs: Vec<PairGrowth>,
    pub(crate) spots: Vec<ChargedSpot>,
    pub(crate) ledger: Ledger,
    pub(crate) backwards: bool,
    pub(crate) lag: f64,
    pub(crate) evaluation: u64,
    pub(crate) age: u64,
    pub(crate) gathered: u64,
    pub(crate) at_walls: Vec<AtWall>,
}
