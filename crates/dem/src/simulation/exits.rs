//! Grains that leave the box.

use super::Simulation;
use crate::error::DemError;
use crate::motion::verlet::Beyond;
use amberfield_core::{OnExit, Side};

/// Sums over the grains that have left since a run began or went on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Left {
    /// Number of grains.
    pub grains: usize,
    /// Charge that they took along [C].
    pub charge: f64,
    /// Energy −Σ m g·x where they left [J].
    pub gravity: f64,
}

impl Simulation {
    /// Sums over the grains that have left since the run began or went on.
    #[must_use]
    pub fn left(&self) -> Left {
        self.left
    }

    /// Ends the run or removes the grains outside the box, as the scene says; whether any was removed.
    pub(super) fn handle_exits(&mut self) -> Result<bool, DemError> {
        let outside: Vec<usize> = (0..self.grains.len())
            .filter(|&i| self.bounds.beyond(&self.grains.centre[i]).is_some())
            .collect();
        let id = |i: usize| self.particles.id[self.grains.original[i].index()];
        let time_s = self.progress.time_s();
        // The smallest id is named: which grain comes first in the sorted order means nothing to a reader.
        let first = |those: &dyn Fn(usize) -> bool| {
            outside.iter().copied().filter(|&i| those(i)).min_by_key(|&i| id(i))
        };
        if let Some(i) = first(&|i| !self.grains.is_finite(i)) {
            return Err(DemError::NotFinite { id: id(i), time_s });
        }
        if self.time.on_exit == OnExit::Stop
            && let Some(i) = first(&|_| true)
        {
            let Beyond { axis, side } =
                self.bounds.beyond(&self.grains.centre[i]).expect("listed as outside");
            let side = if side == Some(Side::Max) { "max" } else { "min" };
            let face = format!("{}_{side}", ["x", "y", "z"][axis]);
            return Err(DemError::Left { id: id(i), position_m: self.grains.position(i), face, time_s });
        }
        for &i in &outside {
            tracing::warn!(id = id(i), time_s, "grain left the domain and was removed");
        }
        self.remove(&outside);
        Ok(!outside.is_empty())
    }

    /// Removes grains (ascending sorted indices). The lists still have the old numbers: the rebuild that must
    /// follow needs the order from them.
    fn remove(&mut self, gone: &[usize]) {
        if gone.is_empty() {
            return;
        }
        self.trade_between_grains();
        for &i in gone {
            self.left.grains += 1;
            self.left.charge += self.particles.charge[self.grains.original[i].index()];
            self.left.gravity -=
                self.grains.position(i).dot(&self.time.gravity_m_s2) / self.grains.inverse_mass[i];
        }
        let mut keep: Vec<u32> = (0..self.grains.len() as u32).collect();
        keep.retain(|&i| gone.binary_search(&(i as usize)).is_err());
        self.list(&keep);
        self.resize_scratch();
    }
}
