//! A gas whose flow is computed by a solver of another process.

use crate::error::DemError;
use crate::motion::grains::Grains;
use amberfield_core::{Domain, Gas, GasFlow, Particles, Vector3};
use amberfield_gas::{ConnectFlow, Exchange, ExchangeState, GrainsView};

/// Limits that exchanges with a gas set to the time step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FlowLimits {
    /// Steps between exchanges.
    pub(crate) steps: u64,
    /// Shortest time in which a grain's slip decays [s].
    pub(crate) response_s: f64,
}

/// Drag, buoyancy, pressure and viscous stress, lift; and what the grains do to the gas.
#[derive(Debug)]
pub(crate) struct FlowingGas {
    exchange: Exchange,
    gas: Gas,
    flow: GasFlow,
    /// Steps between exchanges, once the step is known.
    steps: u64,
}

impl FlowingGas {
    pub(crate) fn new(
        gas: Gas,
        flow: GasFlow,
        solver: &ConnectFlow,
        gravity: Vector3<f64>,
        particles: &Particles,
        saved: Option<&ExchangeState>,
    ) -> Result<Self, DemError> {
        let largest = 2.0 * particles.radius.iter().copied().fold(0.0, f64::max);
        let mut exchange = Exchange::new(gas, flow, gravity, solver.connect()?, largest)?;
        if let Some(saved) = saved {
            exchange.restore(saved)?;
        }
        Ok(Self { exchange, gas, flow, steps: 1 })
    }

    /// Fixes the number of steps between exchanges.
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a positive count of steps")]
    pub(crate) fn set_step(&mut self, step_s: f64) {
        self.steps = (self.flow.interval_s / step_s).round().max(1.0) as u64;
    }

    pub(crate) fn about(&self) -> String {
        format!(
            "flow of another process, model {:?}; drag ({}), grains smoothed over {:.3e} m",
            self.flow.model,
            self.gas.drag.name(),
            self.exchange.smoothing_length_m()
        )
    }

    /// Limits that the exchange sets to the time step.
    pub(crate) fn limits(&self) -> FlowLimits {
        FlowLimits { steps: self.steps, response_s: self.exchange.response_s() }
    }

    /// Whether step `number` ends an interval.
    pub(crate) fn is_due(&self, number: u64) -> bool {
        number.is_multiple_of(self.steps)
    }

    /// Exchanges with the gas what is due after step `number`, which is `step_s` [s] long.
    pub(crate) fn exchange(
        &mut self,
        domain: &Domain,
        grains: &Grains,
        number: u64,
        step_s: f64,
    ) -> Result<(), DemError> {
        let view = GrainsView {
            centre: &grains.centre,
            velocity: &grains.forecast,
            angular: &grains.angular,
            inverse_mass: &grains.inverse_mass,
        };
        let interval_s = self.steps as f64 * step_s;
        Ok(self.exchange.exchange(domain, &view, interval_s, number as f64 * step_s)?)
    }

    /// Adds the forces on the grains at the velocities forecast for the end of the step [N], and books a
    /// step's [s] impulse.
    pub(crate) fn add_forces(&mut self, grains: &Grains, step: f64, total: &mut [Vector3<f64>]) {
        self.exchange.add_forces(&grains.forecast, step, total);
    }

    /// Takes in grains that have come.
    pub(crate) fn admit(&mut self, count: usize) {
        self.exchange.admit(count);
    }

    /// Takes in a new order of the grains.
    pub(crate) fn reorder(&mut self, order: &[u32]) {
        self.exchange.reorder(order);
    }

    /// State for a checkpoint.
    pub(crate) fn state(&mut self) -> Result<ExchangeState, DemError> {
        Ok(self.exchange.state()?)
    }

    /// The exchange, to look at.
    pub(crate) fn known(&self) -> &Exchange {
        &self.exchange
    }
}
