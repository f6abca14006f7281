//! Momentum that grains and gas give each other over an interval.
//!
//! At the interval's start the shares w of the grains in the cells ([`Mapping`]) and the drag coefficients
//! β at the slips of that moment make
//!
//! ```text
//! ε = 1 − Σ w V/V_c,   K = Σ w β/V_c,   S = Σ w (β v − L)/V_c + R
//! ```
//!
//! The solver answers with the flow at the interval's end, implicit in K u. Until the next interval every
//! grain feels
//!
//! ```text
//! F = Σ w β (u_c − v) + L  +  V (−∇p + ∇·τ) − ρ V g        (model A)
//! F = Σ w β (u_c − v)/ε + L − ρ V g                        (model B)
//! ```
//!
//! with its own v as it changes. The same shares gather u, ∇p and ∇·τ; L is lift.
//!
//! A grain thus exchanges with each cell's own gas, and in each cell the gas gives Δt V_c (K u − S), which is
//! what the grains get of it as long as v is that of the interval's start. What they get more or less because
//! v changed since, −Σ w ∫β (v − v₀) dt, is booked by cell and goes into the next R. So momentum given and
//! taken balance to round-off over a run, and no flow from cell to cell is without drag.
//!
//! Source of the equations: Zhou, Kuang, Chu & Yu, J. Fluid Mech. 661, 482 (2010), sets II (A) and III (B).
//! The booking is ours.

mod forces;
mod ledger;
mod measures;
mod state;

pub use measures::{ExchangeExtremes, ExchangeSeconds};
pub use state::ExchangeState;

use ledger::Gone;

use crate::flow_solver::{FlowRequest, FlowSolver, FlowValues};
use crate::mapping::{CHUNK, Placed, Places};
use crate::{GasError, Mapping};
use amberfield_core::{Domain, Gas, GasFlow, Vector3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;
use std::time::Instant;

/// Least void fraction ε of a cell. Ergun's drag grows without bound as ε goes to 0, and the shares of a
/// few grains may fill a small cell.
const LEAST_VOID: f64 = 0.2;
/// Number of a grain that was not there at the exchange.
const NEW: u32 = u32::MAX;

/// Grains as they are now, in the order of the forces asked for.
#[derive(Clone, Copy, Debug)]
pub struct GrainsView<'a> {
    /// Position and radius [m].
    pub centre: &'a [[f64; 4]],
    /// Velocity [m/s].
    pub velocity: &'a [Vector3<f64>],
    /// Angular velocity [rad/s]; empty where nothing spins.
    pub angular: &'a [Vector3<f64>],
    /// Inverse mass [1/kg]; 0 of a grain that never moves.
    pub inverse_mass: &'a [f64],
}

/// Force of the gas on a grain until the next exchange, in parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Held {
    /// Drag coefficient: β in model A, β/ε in model B [kg/s].
    drag: f64,
    /// Velocity u of the gas at the grain [m/s].
    flow: Vector3<f64>,
    /// Part that does not depend on the grain's velocity: β u + L [N].
    push: Vector3<f64>,
    /// Part that the gas does not give in exchange: pressure, viscous stress, buoyancy [N].
    still: Vector3<f64>,
    /// Impulse that the grain got since the exchange [N·s].
    impulse: Vector3<f64>,
    /// Number of the grain at the exchange.
    slot: u32,
}

/// A gas whose flow is computed, and the grains in it.
#[derive(Debug)]
pub struct Exchange {
    gas: Gas,
    flow: GasFlow,
    gravity: Vector3<f64>,
    solver: Box<dyn FlowSolver>,
    mapping: Mapping,
    held: Vec<Held>,
    /// Grains at the exchange, and their places among the nodes.
    placed: Vec<Placed>,
    shares: Places,
    /// Time for which the forces of the exchange have acted [s].
    elapsed_s: f64,
    /// Grains that are gone since.
    gone: Vec<Gone>,
    /// Momentum by cell that grains got of the gas, less what it gave [N·s].
    owed: Vec<Vector3<f64>>,
    /// Momentum that grains got of the gas up to the last exchange [N·s].
    booked: Vector3<f64>,
    void_fraction: Vec<f64>,
    drag: Vec<f64>,
    source: Vec<Vector3<f64>>,
    values: FlowValues,
    /// Velocity and pressure gradient at the nodes, smooth; empty where the flow is new.
    smooth: Vec<[f64; 6]>,
    /// Velocity by cell that the grains feel [m/s].
    felt: Vec<Vector3<f64>>,
    response_s: f64,
    warned: bool,
    /// Interval that the solver works on [s].
    asked_s: Option<f64>,
    /// Answer of the solver, if it had to be taken before its time.
    early: Option<FlowValues>,
    seconds: ExchangeSeconds,
    extremes: ExchangeExtremes,
}

impl Exchange {
    /// Exchange with grains up to a diameter [m], under gravity [m/s²].
    ///
    /// # Errors
    /// A smoothing length that is impossible.
    pub fn new(
        gas: Gas,
        flow: GasFlow,
        gravity: Vector3<f64>,
        solver: Box<dyn FlowSolver>,
        largest_diameter: f64,
    ) -> Result<Self, GasError> {
        let length = flow.smoothing_length_m;
        let mapping = Mapping::new(solver.mesh(), solver.shapes(), length, largest_diameter)?;
        let cells = solver.mesh().cell_count();
        Ok(Self {
            gas,
            flow,
            gravity,
            mapping,
            held: Vec::new(),
            placed: Vec::new(),
            shares: Places::default(),
            elapsed_s: 0.0,
            gone: Vec::new(),
            owed: vec![Vector3::zeros(); cells],
            booked: Vector3::zeros(),
            void_fraction: vec![1.0; cells],
            drag: vec![0.0; cells],
            source: vec![Vector3::zeros(); cells],
            values: FlowValues::default(),
            smooth: Vec::new(),
            felt: Vec::new(),
            response_s: f64::INFINITY,
            warned: false,
            asked_s: None,
            early: None,
            seconds: ExchangeSeconds::default(),
            extremes: ExchangeExtremes::NONE,
            solver,
        })
    }

    /// Exchanges momentum: takes the grains as they are, lets the gas flow on by an interval [s] from a
    /// time [s], and holds the forces that follow.
    ///
    /// # Errors
    /// A solver that is lost.
    pub fn exchange(
        &mut self,
        domain: &Domain,
        grains: &GrainsView<'_>,
        interval_s: f64,
        time_s: f64,
    ) -> Result<(), GasError> {
        let (begun, before) = (Instant::now(), self.seconds);
        let got = self.got_at_nodes();
        self.take()?;
        self.place(domain, grains);
        self.fill_cells(grains);
        if self.values.velocity.is_empty() {
            // The flow as it is at the start.
            self.ask(0.0, time_s)?;
            self.take()?;
        }
        self.resist(grains, interval_s, &got);
        self.ask(interval_s, time_s)?;
        if !self.flow.overlap {
            self.take()?;
        }
        self.hold(grains);
        let beyond = self.seconds.solver + self.seconds.wire - before.solver - before.wire;
        self.seconds.mapping += begun.elapsed().as_secs_f64() - beyond;
        Ok(())
    }

    /// Adds the forces on the grains at their present velocities [N], and books a step's [s] impulse.
    pub fn add_forces(&mut self, velocity: &[Vector3<f64>], step_s: f64, total: &mut [Vector3<f64>]) {
        self.elapsed_s += step_s;
        let one = |((held, total), velocity): ((&mut Held, &mut Vector3<f64>), &Vector3<f64>)| {
            let given = held.push - velocity * held.drag;
            held.impulse += given * step_s;
            *total += given + held.still;
        };
        let grains = self.held.par_iter_mut().zip(total.par_iter_mut()).zip(velocity.par_iter());
        grains.with_min_len(CHUNK).for_each(one);
    }

    /// Takes in grains that have come since the exchange; the gas acts on them from the next one on.
    pub fn admit(&mut self, count: usize) {
        let held = self.held.len() + count;
        self.held.resize(held, Held { slot: NEW, ..Held::default() });
    }

    /// Takes in a new order of the grains: the i-th is the one that was the `order[i]`-th.
    ///
    /// What grains got that are gone stays booked.
    pub fn reorder(&mut self, order: &[u32]) {
        if self.held.is_empty() {
            return;
        }
        if order.len() < self.held.len() {
            let mut stays = vec![false; self.held.len()];
            order.iter().for_each(|&i| stays[i as usize] = true);
            let gone = stays.iter().enumerate().filter(|(_, stays)| !**stays);
            for (i, _) in gone.filter(|(i, _)| self.held[*i].slot != NEW) {
                let got = self.got(i);
                let Held { slot, impulse, .. } = self.held[i];
                self.booked += impulse;
                self.gone.push(Gone { slot, got, impulse });
            }
        }
        self.held = order.iter().map(|&i| self.held[i as usize]).collect();
    }

    /// Shortest time in which a grain's slip decays [s].
    #[must_use]
    pub fn response_s(&self) -> f64 {
        self.response_s
    }

    /// Void fraction ε by cell at the last exchange.
    #[must_use]
    pub fn void_fraction(&self) -> &[f64] {
        &self.void_fraction
    }

    /// Volume of each cell [m³].
    #[must_use]
    pub fn volumes(&self) -> &[f64] {
        self.solver.mesh().volumes()
    }

    /// The flow by cell.
    #[must_use]
    pub fn values(&self) -> &FlowValues {
        &self.values
    }

    /// Momentum that grains got and the gas has not given yet [N·s].
    ///
    /// It closes the balance between two exchanges.
    #[must_use]
    pub fn owed(&self) -> Vector3<f64> {
        self.owed.iter().sum::<Vector3<f64>>()
            + self.held.iter().map(|held| held.impulse).sum::<Vector3<f64>>()
            + self.gone.iter().map(|gone| gone.impulse).sum::<Vector3<f64>>()
    }

    /// Momentum that grains got in exchange from the start [N·s]: what the gas gave and what it owes.
    #[must_use]
    pub fn booked(&self) -> Vector3<f64> {
        self.booked + self.held.iter().map(|held| held.impulse).sum::<Vector3<f64>>()
    }

    /// Time of the exchanges by purpose.
    #[must_use]
    pub fn seconds(&self) -> ExchangeSeconds {
        self.seconds
    }

    /// Steps of the flow and extremes, since this process began.
    #[must_use]
    pub fn extremes(&self) -> ExchangeExtremes {
        self.extremes
    }

    /// Length over which grains are smoothed where cells are small [m].
    #[must_use]
    pub fn smoothing_length_m(&self) -> f64 {
        self.mapping.length()
    }

    /// Finds every grain's cell and shares.
    fn place(&mut self, domain: &Domain, grains: &GrainsView<'_>) {
        let mesh = self.solver.mesh();
        let (held, placed) = (&self.held, &self.placed);
        let one = |(i, &[x, y, z, radius]): (usize, &[f64; 4])| {
            let centre = domain.wrap(Vector3::new(x, y, z));
            let known = held.get(i).filter(|held| held.slot != NEW);
            let last = known.map(|held| placed[held.slot as usize].cell);
            Placed { centre, diameter: 2.0 * radius, cell: mesh.locate(&centre, last).0 }
        };
        self.placed = grains.centre.par_iter().with_min_len(CHUNK).enumerate().map(one).collect();
        self.held.resize(grains.centre.len(), Held::default());
        self.mapping.place(mesh, &self.placed, &mut self.shares);
    }

    /// Fills in the void fraction ε of every cell.
    fn fill_cells(&mut self, grains: &GrainsView<'_>) {
        let solids: Vec<[f64; 1]> = grains.centre.iter().map(|c| [sphere(2.0 * c[3])]).collect();
        let solids = self.mapping.spread(&self.shares, &solids);
        self.void_fraction.iter_mut().zip(solids).for_each(|(void, [solid])| *void = 1.0 - solid);
        let mut clipped = 0;
        for void in self.void_fraction.iter_mut().filter(|void| **void < LEAST_VOID) {
            *void = LEAST_VOID;
            clipped += 1;
        }
        if clipped > 0 && !self.warned {
            tracing::warn!(
                "grains fill more than {} of {clipped} cells, which count as that full; \
                 make gas.smoothing_length_m larger",
                1.0 - LEAST_VOID
            );
            self.warned = true;
        }
    }

    fn ask(&mut self, interval_s: f64, time_s: f64) -> Result<(), GasError> {
        let request = FlowRequest {
            interval_s,
            time_s,
            gas: &self.gas,
            flow: &self.flow,
            void_fraction: &self.void_fraction,
            drag: &self.drag,
            source: &self.source,
        };
        let begun = Instant::now();
        self.solver.ask(&request)?;
        self.seconds.wire += begun.elapsed().as_secs_f64();
        self.asked_s = Some(interval_s);
        Ok(())
    }

    /// Takes the flow that was asked for, if any, and books what the gas gave meanwhile.
    fn take(&mut self) -> Result<(), GasError> {
        let Some(interval_s) = self.asked_s.take() else { return Ok(()) };
        self.smooth.clear();
        match self.early.take() {
            Some(values) => self.values = values,
            None => {
                let begun = Instant::now();
                self.solver.take(&mut self.values)?;
                // What the solver did while grains moved on was not waited for.
                let waited = begun.elapsed().as_secs_f64();
                let solving = self.values.seconds.min(waited);
                self.seconds.solver += solving;
                self.seconds.wire += waited - solving;
            }
        }
        self.extremes.note(interval_s, &self.values, &self.void_fraction, &self.drag);
        let volumes = self.solver.mesh().volumes();
        for (cell, owed) in self.owed.iter_mut().enumerate() {
            let given = self.values.velocity[cell] * self.drag[cell] - self.source[cell];
            *owed -= given * (interval_s * volumes[cell]);
        }
        Ok(())
    }
}

/// Volume of a sphere [m³].
fn sphere(diameter: f64) -> f64 {
    PI / 6.0 * diameter.powi(3)
}
