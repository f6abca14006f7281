//! Facts about exchanges that a run tells.

use crate::FlowValues;

/// Time of the exchanges by purpose [s].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExchangeSeconds {
    /// Finding cells and shares, taking grains to cells and the flow to grains.
    pub mapping: f64,
    /// Waiting while the solver works.
    pub solver: f64,
    /// The messages' way there and back.
    pub wire: f64,
}

/// Steps of the flow, and extremes of what grains did to it, over a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExchangeExtremes {
    /// Exchanges, and steps that the flow made for them.
    pub exchanges: u64,
    /// Steps of the flow in all exchanges.
    pub steps: u64,
    /// Most steps for one exchange.
    pub most_steps: u64,
    /// Largest Courant number of a step.
    pub courant: f64,
    /// Least void fraction of a cell.
    pub least_void: f64,
    /// Largest drag coefficient K of a cell [kg/(m³ s)].
    pub most_drag: f64,
}

impl ExchangeExtremes {
    /// Extremes before the first exchange.
    pub(super) const NONE: Self =
        Self { exchanges: 0, steps: 0, most_steps: 0, courant: 0.0, least_void: 1.0, most_drag: 0.0 };

    /// Notes the flow after an interval [s], with the void fractions and drag coefficients of the cells.
    pub(super) fn note(&mut self, interval_s: f64, flow: &FlowValues, void_fraction: &[f64], drag: &[f64]) {
        self.exchanges += u64::from(interval_s > 0.0);
        self.steps += flow.steps;
        self.most_steps = self.most_steps.max(flow.steps);
        self.courant = self.courant.max(flow.courant);
        self.least_void = void_fraction.iter().copied().fold(self.least_void, f64::min);
        self.most_drag = drag.iter().copied().fold(self.most_drag, f64::max);
    }
}
