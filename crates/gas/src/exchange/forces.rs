//! Forces of the flow on each grain, and of all grains of a cell on the flow.

use super::{Exchange, GrainsView, Held, sphere};
use crate::mapping::CHUNK;
use amberfield_core::{Gas, GasModel, Vector3};
use amberfield_laws::particle_reynolds::Slip;
use amberfield_laws::{drag, magnus_lift, saffman_lift};
use rayon::prelude::*;

/// Flow at a grain.
#[derive(Clone, Copy, Debug)]
struct AtGrain {
    void_fraction: f64,
    /// Velocity of the gas [m/s].
    velocity: Vector3<f64>,
    /// Vorticity of the gas [1/s]; zero unless lift in a shear flow is wanted.
    vorticity: Vector3<f64>,
}

impl Exchange {
    /// Sets drag and lift of every grain in the flow known so far, and their sums by cell.
    pub(super) fn resist(&mut self, grains: &GrainsView<'_>, interval_s: f64) {
        let velocity = self.gathered(&self.values.velocity);
        let vorticity =
            if self.flow.saffman_lift { self.gathered(&self.values.vorticity) } else { Vec::new() };
        let voids: Vec<[f64; 1]> = self.void_fraction.iter().map(|&void| [void]).collect();
        let voids = self.mapping.gather_near(&self.shares, &voids);
        let one = |i: usize| {
            let flow = AtGrain {
                void_fraction: voids[i][0],
                velocity: velocity[i],
                vorticity: vorticity.get(i).copied().unwrap_or_default(),
            };
            self.resistance(grains, i, &flow)
        };
        self.held = (0..grains.centre.len()).into_par_iter().with_min_len(CHUNK).map(one).collect();
        let slowest = |(held, inverse_mass): (&Held, &f64)| 1.0 / (held.drag * inverse_mass);
        self.response_s =
            self.held.iter().zip(grains.inverse_mass).map(slowest).fold(f64::INFINITY, f64::min);
        let gives = |(held, velocity): (&Held, &Vector3<f64>)| {
            let source = velocity * held.drag - held.push;
            [held.drag, source.x, source.y, source.z]
        };
        let given: Vec<[f64; 4]> = self.held.iter().zip(grains.velocity).map(gives).collect();
        let volumes = self.solver.mesh().volumes();
        for (cell, [drag, x, y, z]) in self.mapping.spread(&self.shares, &given).into_iter().enumerate() {
            self.drag[cell] = drag;
            self.source[cell] = Vector3::new(x, y, z) - self.owed[cell] / (interval_s * volumes[cell]);
        }
    }

    /// Drag coefficient β of a grain, and its lift L in `push`.
    fn resistance(&self, grains: &GrainsView<'_>, i: usize, flow: &AtGrain) -> Held {
        let Gas { density_kg_m3: density, viscosity_pa_s: viscosity, .. } = self.gas;
        let AtGrain { void_fraction, vorticity, .. } = *flow;
        let diameter = 2.0 * grains.centre[i][3];
        let slip = flow.velocity - grains.velocity[i];
        let known = Slip { speed: slip.norm(), void_fraction, diameter, density, viscosity };
        let over = match self.flow.model {
            GasModel::A => 1.0,
            GasModel::B => 1.0 / void_fraction,
        };
        let mut lift = Vector3::zeros();
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
        let acts = self.flow.model == GasModel::A;
        let velocity = self.gathered(&self.values.velocity);
        let slope = if acts { self.gathered(&self.values.pressure_gradient) } else { Vec::new() };
        let is_viscous = acts && self.flow.viscous_force;
        let viscous = if is_viscous { self.gathered(&self.values.viscous_force) } else { Vec::new() };
        let weight = self.gravity * self.gas.density_kg_m3;
        self.held.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(i, held)| {
            let none = Vector3::zeros();
            let density = viscous.get(i).unwrap_or(&none) - slope.get(i).unwrap_or(&none) - weight;
            held.flow = velocity[i];
            held.push += velocity[i] * held.drag;
            held.still = density * sphere(2.0 * grains.centre[i][3]);
        });
        self.elapsed_s = 0.0;
    }

    /// Means of the cells' vectors at the grains, weighted by their shares.
    fn gathered(&self, values: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let values: Vec<[f64; 3]> = values.iter().map(|&value| value.into()).collect();
        self.mapping.gather(&self.shares, &values).into_iter().map(Vector3::from).collect()
    }
}
