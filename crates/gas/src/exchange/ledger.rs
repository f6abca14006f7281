//! Booking of what grains got of the gas, by the cells whose gas they got it of.

use super::{Exchange, Held};
use amberfield_core::Vector3;
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
    /// Books what the grains got since the last exchange in the cells whose gas they got it of.
    pub(super) fn book(&mut self) {
        if self.held.is_empty() && self.gone.is_empty() {
            return;
        }
        let mut got = vec![[0.0; 4]; self.places.len()];
        for (i, held) in self.held.iter().enumerate() {
            got[held.slot as usize] = self.got(i);
        }
        for gone in self.gone.drain(..) {
            got[gone.slot as usize] = gone.got;
        }
        for held in &mut self.held {
            self.booked += std::mem::take(&mut held.impulse);
        }
        let by_cell = self.mapping.spread(&self.shares, &got);
        let volumes = self.solver.mesh().volumes();
        for (cell, [drag, x, y, z]) in by_cell.into_iter().enumerate() {
            let impulse = self.values.velocity[cell] * drag + Vector3::new(x, y, z);
            self.owed[cell] += impulse * volumes[cell];
        }
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
