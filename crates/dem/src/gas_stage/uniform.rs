//! A gas that the grains do not disturb: each one is alone in it.

use crate::motion::chunks::{CHUNK, is_parallel};
use crate::motion::grains::Grains;
use amberfield_core::{Gas, Particles, Vector3};
use amberfield_laws::particle_reynolds::Slip;
use amberfield_laws::{drag, magnus_lift};
use rayon::prelude::*;
use std::f64::consts::PI;

/// Drag, buoyancy, lift of spinning grains.
#[derive(Clone, Copy, Debug)]
pub(crate) struct UniformGas {
    gas: Gas,
    gravity: Vector3<f64>,
    /// Smallest diameter of the grains that move [m].
    least_diameter: f64,
    /// Lowest density of the grains that move [kg/m³].
    least_density: f64,
}

impl UniformGas {
    pub(crate) fn new(gas: Gas, gravity: Vector3<f64>, particles: &Particles) -> Self {
        let least = |values: &[f64]| particles.moving().map(|i| values[i]).fold(f64::INFINITY, f64::min);
        Self {
            gas,
            gravity,
            least_diameter: 2.0 * least(&particles.radius),
            least_density: least(&particles.density),
        }
    }

    /// Name of the drag law.
    pub(crate) fn drag(&self) -> &'static str {
        self.gas.drag.name()
    }

    /// Adds the forces on the grains at the velocities forecast for the end of the step [N].
    pub(crate) fn add_forces(&self, grains: &Grains, total: &mut [Vector3<f64>]) {
        let Gas { density_kg_m3: density, velocity_m_s: velocity, .. } = self.gas;
        let spins = self.gas.magnus_lift && !grains.angular.is_empty();
        let add = |(i, total): (usize, &mut Vector3<f64>)| {
            let diameter = 2.0 * grains.centre[i][3];
            let slip = velocity - grains.forecast[i];
            let displaced = density * PI / 6.0 * diameter.powi(3);
            *total += slip * self.coefficient(diameter, slip.norm()) - self.gravity * displaced;
            if spins {
                *total += magnus_lift::force(-slip, grains.angular[i], Vector3::zeros(), diameter, density);
            }
        };
        if is_parallel(grains.len()) {
            let chunks = total.par_chunks_mut(CHUNK).enumerate();
            chunks.for_each(|(k, chunk)| (k * CHUNK..).zip(chunk).for_each(add));
        } else {
            total.iter_mut().enumerate().for_each(add);
        }
    }

    /// Shortest time in which any grain's slip decays [s], at grains' speeds up to `speed` [m/s]; exact for
    /// grains of one density.
    pub(crate) fn limit(&self, speed: f64) -> f64 {
        let (diameter, density) = (self.least_diameter, self.least_density);
        if diameter.is_infinite() {
            return f64::INFINITY;
        }
        let slip = speed + self.gas.velocity_m_s.norm();
        density * PI / 6.0 * diameter.powi(3) / self.coefficient(diameter, slip)
    }

    /// β of F = β (u − v) [kg/s].
    fn coefficient(&self, diameter: f64, speed: f64) -> f64 {
        let Gas { density_kg_m3: density, viscosity_pa_s: viscosity, .. } = self.gas;
        let slip = Slip { speed, void_fraction: 1.0, diameter, density, viscosity };
        drag::coefficient(self.gas.drag, &slip)
    }
}
