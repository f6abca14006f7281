//! State of the field stage, for checkpoints.

use super::Limited;
use super::forecast::{EnergyForecast, Forecast};
use super::impacts::Impacts;
use super::interval::IntervalControl;
use amberfield_field::Choice;
use amberfield_field::far::FarState;
use serde::{Deserialize, Serialize};

/// State of the field stage.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct FieldState {
    pub(crate) choice: Choice,
    /// The internal grid's parameters, should the field solver be lost.
    pub(crate) fallback: Option<Choice>,
    /// Whether a field solver has a part in it, and is not lost yet.
    pub(crate) has_solver: bool,
    /// Iterations of its last solve for the motion.
    pub(crate) solver_iterations: u64,
    /// State of a field solver in another process.
    pub(crate) far: FarState,
    pub(crate) forecast: Forecast,
    pub(crate) energy: EnergyForecast,
    pub(crate) control: IntervalControl,
    pub(crate) impacts: Impacts,
    pub(crate) travel: f64,
    pub(crate) plasma_steps: u64,
    pub(crate) plasma_limit: f64,
    pub(crate) limited: Limited,
}

impl FieldState {
    /// Whether it is one of `count` grains.
    pub(crate) fn fits(&self, count: usize) -> bool {
        self.forecast.fits(count)
    }
}
