//! Booking of what grains got of the gas, by the cells whose gas they got it of.

use super::{Exchange, Held, NEW};
use crate::mapping::CHUNK;
use amberfield_core::Vector3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Grain that is no longer there, and what it got since the exchange.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Gone {
    /// Number of the grain at the exchange.
    pub(super) slot: u32,
    /// Numbers to book: see [`Exchange::got`].
    pub(super) got: [f64; 4],
    /// Impulse [N·s].
    pub(super) impulse: Vector3<f64>,
}

impl Exchange {
    /// Takes what the grains got since the last exchange, as sums at the nodes: see [`Self::got`].
    ///
    /// Empty where there was none.
    pub(super) fn got_at_nodes(&mut self) -> Vec<[f64; 4]> {
        if self.held.is_empty() && self.gone.is_empty() {
            return Vec::new();
        }
        let all: Vec<[f64; 4]> =
            (0..self.held.len()).into_par_iter().with_min_len(CHUNK).map(|i| self.got(i)).collect();
        let mut got = vec![[0.0; 4]; self.placed.len()];
        let known = self.held.iter().zip(all).filter(|(held, _)| held.slot != NEW);
        known.for_each(|(held, of_grain)| got[held.slot as usize] = of_grain);
        for gone in self.gone.drain(..) {
            got[gone.slot as usize] = gone.got;
        }
        for held in &mut self.held {
            self.booked += std::mem::take(&mut held.impulse);
        }
        self.mapping.at_nodes(&self.shares, &got)
    }

    /// Books what grains got of a cell's gas, per volume: β t, and the impulse beside that of its velocity.
    pub(super) fn book(&mut self, cell: usize, drag: f64, beside: Vector3<f64>) {
        let impulse = self.felt[cell] * drag + beside;
        self.owed[cell] += impulse * self.solver.mesh().volumes()[cell];
    }

    /// Gives what a grain got since the exchange: β t, times which each cell's own velocity u_c counts, and
    /// the impulse beside that of its mean u, ∫(β (u − v) + L) dt − β t u.
    pub(super) fn got(&self, i: usize) -> [f64; 4] {
        let Held { drag, flow, impulse, .. } = self.held[i];
        let drag = drag * self.elapsed_s;
        let beside = impulse - flow * drag;
        [drag, beside.x, beside.y, beside.z]
    }
}
