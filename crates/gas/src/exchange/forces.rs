//! Forces of the flow on each grain, and of all grains of a cell on the flow.

use super::{Exchange, GrainsView, Held, sphere};
use crate::mapping::CHUNK;
use amberfield_core::{Gas, GasModel, Vector3};
use amberfield_laws::particle_reynolds::Slip;
use amberfield_laws::{drag, magnus_lift, saffman_lift, self_disturbance};
use nalgebra::Matrix3;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Rounds in which drag and the wind that a grain makes for itself are brought together.
const ROUNDS: u32 = 3;
/// Change of their quotient at which they are together.
const SETTLED: f64 = 1e-5;
/// Most of its slip that a grain's own wind may take.
const MOST_WIND: f64 = 0.6;

/// Part of a grain in what it finds around it.
#[derive(Clone, Copy, Debug)]
struct Itself {
    /// Share of the volume that hinders it: that of the others where it is alone, and of all in a bed, whose
    /// laws count every grain.
    others: f64,
    /// Degree to which it is alone: 1 far from others, 0 in a bed.
    alone: f64,
}

impl Itself {
    /// Part of a grain of a volume [m³] in a share of the volume, over which it is spread by a Gaussian of a
    /// variance [m²].
    fn new(solid: f64, volume: f64, variance: &Matrix3<f64>) -> Self {
        let own = volume / ((2.0 * PI).powi(3) * variance.determinant()).sqrt();
        let share = if solid > 0.0 { (own / solid).min(1.0) } else { 1.0 };
        // Slope 1 where it is alone, so that an error of its own share counts once; of third order in a bed.
        let alone = share * share * share * (3.0 - 2.0 * share);
        Self { others: solid * (1.0 - alone), alone }
    }
}

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
    /// Sets drag and lift of every grain in the flow known so far, and their sums by cell; books what grains
    /// got, by its sums at the nodes.
    pub(super) fn resist(&mut self, grains: &GrainsView<'_>, interval_s: f64, got: &[[f64; 4]]) {
        self.smooth_flow();
        let vorticity =
            if self.flow.saffman_lift { self.gathered(&self.values.vorticity) } else { Vec::new() };
        let flow = self.mapping.of_grains(&self.shares, &self.flow_and_void());
        let one = |i: usize| {
            let [x, y, z, void_fraction] = flow[i];
            let flow = AtGrain {
                void_fraction,
                velocity: Vector3::new(x, y, z),
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
        let held = self.held.par_iter().zip(grains.velocity).with_min_len(CHUNK);
        let given: Vec<[f64; 4]> = held.map(gives).collect();
        let given = self.mapping.at_nodes(&self.shares, &given);
        // Both in one go: smoothing takes much of the time.
        let none = [0.0; 4];
        let both = given.iter().enumerate().map(|(node, &[a, b, c, d])| {
            let [e, f, g, h] = *got.get(node).unwrap_or(&none);
            [a, b, c, d, e, f, g, h]
        });
        let both = self.mapping.to_cells(&both.collect::<Vec<_>>());
        for (cell, [drag, x, y, z, got_drag, got_x, got_y, got_z]) in both.into_iter().enumerate() {
            if !got.is_empty() {
                self.book(cell, got_drag, Vector3::new(got_x, got_y, got_z));
            }
            self.drag[cell] = drag;
            self.source[cell] = Vector3::new(x, y, z) - self.owed[cell] / (interval_s * self.volumes()[cell]);
        }
    }

    /// Smooth velocity of the gas [m/s] and void fraction at the nodes.
    fn flow_and_void(&self) -> Vec<[f64; 4]> {
        let voids: Vec<[f64; 1]> = self.void_fraction.iter().map(|&void| [void]).collect();
        let voids = self.mapping.near(&voids);
        self.smooth.iter().zip(voids).map(|(&[x, y, z, ..], [void])| [x, y, z, void]).collect()
    }

    /// Drag coefficient β of a grain, and its lift L in `push`.
    fn resistance(&self, grains: &GrainsView<'_>, i: usize, flow: &AtGrain) -> Held {
        let Gas { density_kg_m3: density, viscosity_pa_s: viscosity, .. } = self.gas;
        let AtGrain { void_fraction, vorticity, .. } = *flow;
        let diameter = 2.0 * grains.centre[i][3];
        let slip = flow.velocity - grains.velocity[i];
        let [of_void, of_flow] = self.mapping.variances_of_one(self.placed[i].cell, diameter);
        let itself = Itself::new(1.0 - void_fraction, sphere(diameter), &of_void);
        let spread = spread_of_wind(&of_flow, &slip);
        let void_fraction = 1.0 - itself.others;
        let beta = |speed: f64| {
            let known = Slip { speed, void_fraction, diameter, density, viscosity };
            drag::coefficient(self.gas.drag, &known)
        };
        // Drag in the gas that the grain does not disturb, over the slip in the gas as it is.
        let (mut larger, mut speed) = (1.0, slip.norm());
        let mut drag = beta(speed);
        for _ in 0..ROUNDS {
            let wind = self_disturbance::per_force(speed, spread, density, viscosity);
            let before = larger;
            larger = 1.0 / (1.0 - (itself.alone * wind * drag).min(MOST_WIND));
            if (larger - before).abs() < SETTLED {
                break;
            }
            speed = larger * slip.norm();
            drag = beta(speed);
        }
        let over = match self.flow.model {
            GasModel::A => larger,
            GasModel::B => larger / void_fraction,
        };
        let mut lift = Vector3::zeros();
        if self.flow.saffman_lift {
            lift += saffman_lift::force(slip, vorticity, diameter, density, viscosity);
        }
        if self.gas.magnus_lift && !grains.angular.is_empty() {
            lift += magnus_lift::force(-slip, grains.angular[i], vorticity, diameter, density);
        }
        Held { drag: over * drag, push: lift, slot: i as u32, ..Held::default() }
    }

    /// Sets the force of the flow on every grain until the next exchange.
    pub(super) fn hold(&mut self, grains: &GrainsView<'_>) {
        let acts = self.flow.model == GasModel::A;
        self.smooth_flow();
        let flow = self.mapping.of_grains(&self.shares, &self.smooth);
        let is_viscous = acts && self.flow.viscous_force;
        let viscous = if is_viscous { self.gathered(&self.values.viscous_force) } else { Vec::new() };
        let weight = self.gravity * self.gas.density_kg_m3;
        self.held.par_iter_mut().with_min_len(CHUNK).enumerate().for_each(|(i, held)| {
            let none = Vector3::zeros();
            let [x, y, z, slope_x, slope_y, slope_z] = flow[i];
            let slope = if acts { Vector3::new(slope_x, slope_y, slope_z) } else { none };
            let density = viscous.get(i).unwrap_or(&none) - slope - weight;
            held.flow = Vector3::new(x, y, z);
            held.push += held.flow * held.drag;
            held.still = density * sphere(2.0 * grains.centre[i][3]);
        });
        self.felt.clone_from(&self.values.velocity);
        self.elapsed_s = 0.0;
    }

    /// Makes the flow smooth at the nodes, if it is new.
    fn smooth_flow(&mut self) {
        if self.smooth.is_empty() {
            let cells = self.values.velocity.iter().zip(&self.values.pressure_gradient);
            let both: Vec<[f64; 6]> = cells.map(|(u, p)| [u.x, u.y, u.z, p.x, p.y, p.z]).collect();
            self.smooth = self.mapping.smooth(&both);
        }
    }

    /// Means of the cells' vectors at the grains, weighted by their shares.
    fn gathered(&self, values: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
        let values: Vec<[f64; 3]> = values.iter().map(|&value| value.into()).collect();
        self.mapping
            .of_grains(&self.shares, &self.mapping.smooth(&values))
            .into_iter()
            .map(Vector3::from)
            .collect()
    }
}

/// Spread [m] of a force across a slip, from its variance [m²]: how far it reaches along the slip does not
/// matter for a wake.
fn spread_of_wind(variance: &Matrix3<f64>, slip: &Vector3<f64>) -> f64 {
    let direction = slip.try_normalize(0.0).unwrap_or_else(Vector3::z);
    let along = direction.dot(&(variance * direction));
    (0.5 * (variance.trace() - along)).sqrt()
}
