//! Forces of the flow on each grain, and of all grains of a cell on the flow.

use super::{Exchange, GrainsView, Held, sphere};
use crate::mapping::{CHUNK, Share};
use amberfield_core::{Gas, GasModel, Vector3};
use amberfield_laws::particle_reynolds::Slip;
use amberfield_laws::{drag, magnus_lift, saffman_lift};
use rayon::prelude::*;

impl Exchange {
    /// Sets drag and lift of every grain in the flow known so far, and their sums by cell.
    pub(super) fn resist(&mut self, grains: &GrainsView<'_>, interval_s: f64) {
        let held: Vec<Held> =
            (0..grains.centre.len()).into_par_iter().map(|i| self.resistance(grains, i)).collect();
        self.held = held;
        let slowest = |(held, inverse_mass): (&Held, &f64)| 1.0 / (held.drag * inverse_mass);
        self.response_s =
            self.held.iter().zip(grains.inverse_mass).map(slowest).fold(f64::INFINITY, f64::min);
        self.drag.fill(0.0);
        self.source.fill(Vector3::zeros());
        let volumes = self.solver.mesh().volumes();
        for (i, held) in self.held.iter().enumerate() {
            let source = grains.velocity[i] * held.drag - held.push;
            for share in self.shares.of(i) {
                let per_volume = share.weight / volumes[share.cell as usize];
                self.drag[share.cell as usize] += held.drag * per_volume;
                self.source[share.cell as usize] += source * per_volume;
            }
        }
        for (cell, (source, owed)) in self.source.iter_mut().zip(&self.owed).enumerate() {
            *source -= owed / (interval_s * volumes[cell]);
        }
    }

    /// Drag coefficient β of a grain, and its lift L in `push`.
    fn resistance(&self, grains: &GrainsView<'_>, i: usize) -> Held {
        let Gas { density_kg_m3: density, viscosity_pa_s: viscosity, .. } = self.gas;
        let shares = self.shares.of(i);
        let diameter = 2.0 * grains.centre[i][3];
        let void_fraction = shares.iter().map(|s| s.weight * self.void_fraction[s.cell as usize]).sum();
        let slip = gathered(shares, &self.values.velocity) - grains.velocity[i];
        let known = Slip { speed: slip.norm(), void_fraction, diameter, density, viscosity };
        let over = match self.flow.model {
            GasModel::A => 1.0,
            GasModel::B => 1.0 / void_fraction,
        };
        let mut lift = Vector3::zeros();
        let vorticity =
            if self.flow.saffman_lift { gathered(shares, &self.values.vorticity) } else { Vector3::zeros() };
        if self.flow.saffman_lift {
            lift += saffman_lift::force(slip, vorticity, diameter, density, viscosity);
        }
        if self.gas.magnus_lift && !grains.angular.is_empty() {
            lift += magnus_lift::force(-slip, grains.angular[i], vorticity, diameter, density);
        }
        Held {
            drag: over * drag::coefficient(self.gas.drag, &known),
            push: lift,
            slot: i as u32,
            ..Held::default()
        }
    }

    /// Sets the force of the flow on every grain until the next exchange.
    pub(super) fn hold(&mut self, grains: &GrainsView<'_>) {
        let (shares, values, flow) = (&self.shares, &self.values, self.flow);
        let weight = self.gravity * self.gas.density_kg_m3;
        self.held.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(i, held)| {
            let shares = shares.of(i);
            held.push += gathered(shares, &values.velocity) * held.drag;
            let mut density = -weight;
            if flow.model == GasModel::A {
                density -= gathered(shares, &values.pressure_gradient);
                if flow.viscous_force {
                    density += gathered(shares, &values.viscous_force);
                }
            }
            held.still = density * sphere(2.0 * grains.centre[i][3]);
        });
    }
}

/// Mean of the cells' values at a grain, weighted by its shares.
fn gathered(shares: &[Share], values: &[Vector3<f64>]) -> Vector3<f64> {
    shares.iter().map(|share| values[share.cell as usize] * share.weight).sum()
}
