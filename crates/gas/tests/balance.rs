//! Balance of momentum: the gas gives what grains get, to round-off, whatever the flow does.

mod common;

use amberfield_core::{Boundary, Domain, DragLaw, Gas, GasFlow, GasModel, Vector3};
use amberfield_field::far::FarMesh;
use amberfield_gas::{CellShapes, Exchange, FlowRequest, FlowSolver, FlowValues, GasError, GrainsView};
use common::{ByRule, air, mesh, scattered};
use proptest::prelude::*;
use std::sync::{Arc, Mutex};

/// A flow with random values, which counts the momentum that it gave.
#[derive(Debug)]
struct Whimsical {
    mesh: FarMesh,
    shapes: CellShapes,
    given: Arc<Mutex<Vector3<f64>>>,
    void: Arc<Mutex<f64>>,
    calls: u32,
    answer: FlowValues,
    gives: Vector3<f64>,
}

impl Whimsical {
    fn new(domain: &Domain, cells: [usize; 3]) -> Self {
        let (mesh, shapes) = mesh(domain, cells);
        let (given, void, answer) = Default::default();
        Self { mesh, shapes, given, void, calls: 0, answer, gives: Vector3::zeros() }
    }
}

impl FlowSolver for Whimsical {
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn shapes(&self) -> &CellShapes {
        &self.shapes
    }

    fn ask(&mut self, request: &FlowRequest<'_>) -> Result<(), GasError> {
        self.calls += 1;
        let values = &mut self.answer;
        let wave = |cell: usize, shift: f64| (f64::from(self.calls) + 1.7 * cell as f64 + shift).sin();
        let vector = |cell: usize| Vector3::new(wave(cell, 0.0), wave(cell, 2.0), 1.0 + wave(cell, 4.0));
        values.velocity = (0..self.mesh.cell_count()).map(vector).collect();
        values.pressure_gradient = values.velocity.iter().map(|u| u * -30.0).collect();
        self.gives = Vector3::zeros();
        for (cell, volume) in self.mesh.volumes().iter().enumerate() {
            let force = values.velocity[cell] * request.drag[cell] - request.source[cell];
            self.gives += force * (volume * request.interval_s);
        }
        *self.void.lock().expect("no panic") =
            request.void_fraction.iter().zip(self.mesh.volumes()).map(|(void, volume)| void * volume).sum();
        Ok(())
    }

    fn take(&mut self, values: &mut FlowValues) -> Result<(), GasError> {
        values.clone_from(&self.answer);
        *self.given.lock().expect("no panic") += self.gives;
        Ok(())
    }

    fn state(&mut self) -> Result<Vec<Vec<f64>>, GasError> {
        Ok(vec![vec![f64::from(self.calls)]])
    }

    fn restore(&mut self, state: &[Vec<f64>]) -> Result<(), GasError> {
        self.calls = state[0][0] as u32;
        Ok(())
    }
}

proptest! {
    #[test]
    fn momentum_and_volume_are_kept_to_round_off(
        law in 0..5_usize, model_b in any::<bool>(), spin in any::<bool>(), cells in 2..5_usize,
        leave in any::<bool>(), overlap in any::<bool>(),
        places in prop::collection::vec((0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64), 3..40),
    ) {
        let faces = [[Boundary::Periodic; 2], [Boundary::Grounded; 2], [Boundary::Grounded; 2]];
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(0.02), faces).unwrap();
        let solver = Whimsical::new(&domain, [cells; 3]);
        let (given, void) = (Arc::clone(&solver.given), Arc::clone(&solver.void));
        let (gas, flow) = air(DragLaw::ALL[law]);
        let gas = Gas { magnus_lift: spin, ..gas };
        let flow = GasFlow { overlap, model: if model_b { GasModel::B } else { GasModel::A }, ..flow };
        let mut exchange = Exchange::new(gas, flow, Vector3::zeros(), Box::new(solver), 1e-3).unwrap();
        let mut centre: Vec<_> =
            places.iter().map(|(x, y, z)| [0.02 * x, 0.02 * y, 0.02 * z, 5e-4]).collect();
        let mut velocity: Vec<_> = places.iter().map(|(x, y, z)| Vector3::new(*y, *z, *x)).collect();
        let mut angular: Vec<_> = places.iter().map(|(x, y, z)| Vector3::new(*z, *x, *y) * 100.0).collect();
        let mut got = Vector3::zeros();
        for k in 0..6 {
            let inverse_mass = vec![1e6; centre.len()];
            let view = GrainsView {
                centre: &centre,
                velocity: &velocity,
                angular: &angular,
                inverse_mass: &inverse_mass,
            };
            exchange.exchange(&domain, &view, 1e-3, 1e-3 * f64::from(k)).unwrap();
            let solid = centre.len() as f64 * std::f64::consts::PI / 6.0 * 1e-9;
            let missing = (*void.lock().unwrap() - (0.02_f64.powi(3) - solid)).abs();
            prop_assert!(missing < 1e-14 * 0.02_f64.powi(3), "{missing:e}");
            for _ in 0..4 {
                let mut force = vec![Vector3::zeros(); centre.len()];
                exchange.add_forces(&velocity, 2.5e-4, &mut force);
                for (i, force) in force.iter().enumerate() {
                    velocity[i] += force * 1e6 * 2.5e-4;
                    (0..3).for_each(|axis| centre[i][axis] += 1e-4 * velocity[i][axis].clamp(-1.0, 1.0));
                    (1..3).for_each(|axis| centre[i][axis] = centre[i][axis].clamp(0.0, 0.02));
                }
            }
            // Order changes, grains leave; what they got stays booked.
            let mut order: Vec<u32> = (0..centre.len() as u32).rev().collect();
            if leave && order.len() > 2 {
                order.pop();
            }
            exchange.reorder(&order);
            centre = order.iter().map(|&i| centre[i as usize]).collect();
            velocity = order.iter().map(|&i| velocity[i as usize]).collect();
            angular = order.iter().map(|&i| angular[i as usize]).collect();
            got = *given.lock().unwrap() + exchange.owed();
        }
        // What grains got by the forces that are exchanged, counted apart.
        let booked = exchange.booked();
        let scale = booked.norm().max(given.lock().unwrap().norm()).max(1e-300);
        prop_assert!((got - booked).norm() < 1e-12 * scale, "{got:?} {booked:?}");
    }
}

#[test]
fn a_state_of_another_mesh_is_refused() {
    let domain = |edge: f64| {
        Domain::new(Vector3::zeros(), Vector3::repeat(edge), [[Boundary::Grounded; 2]; 3]).unwrap()
    };
    let exchange = |cells: usize| {
        let solver = Whimsical::new(&domain(0.02), [cells; 3]);
        let (gas, flow) = air(DragLaw::Stokes);
        Exchange::new(gas, flow, Vector3::zeros(), Box::new(solver), 1e-3).unwrap()
    };
    let state = exchange(3).state().unwrap();
    let error = exchange(4).restore(&state).unwrap_err().to_string();
    assert!(error.contains("27 cells") && error.contains("64"), "{error}");
}

/// Largest slip of the second half of two hundred exchanges over that of the first.
///
/// The grains are `loading` times as heavy as the gas, and the exchanges are `interval_over_response`
/// response times apart.
fn slip_that_stays(loading: f64, interval_over_response: f64, overlap: bool) -> f64 {
    let domain =
        Domain::new(Vector3::zeros(), Vector3::repeat(0.02), [[Boundary::Periodic; 2]; 3]).expect("good");
    let (count, mass, radius) = (48, 1e-6, 5e-4);
    // The gas has one velocity and a mass of its own, and takes all momentum that it is given.
    let (mass_of_gas, mut velocity_of_gas) = (count as f64 * mass / loading, Vector3::zeros());
    let lump = move |request: &FlowRequest<'_>, volumes: &[f64]| {
        let interval = request.interval_s;
        let drag: f64 = request.drag.iter().zip(volumes).map(|(drag, volume)| drag * volume).sum();
        let source: Vector3<f64> =
            request.source.iter().zip(volumes).map(|(source, volume)| source * *volume).sum();
        velocity_of_gas =
            (velocity_of_gas * mass_of_gas + source * interval) / (mass_of_gas + drag * interval);
        vec![velocity_of_gas; volumes.len()]
    };
    let (gas, flow) = air(DragLaw::Stokes);
    let flow = GasFlow { overlap, ..flow };
    let solver = ByRule::boxed(&domain, [3; 3], lump);
    let mut exchange = Exchange::new(gas, flow, Vector3::zeros(), solver, 1e-3).expect("good");
    let centre = scattered([4, 4, 3], [0.02; 3], radius);
    let mut velocity = vec![Vector3::new(1.0, 0.0, 0.0); count];
    let inverse_mass = vec![1.0 / mass; count];
    let interval = interval_over_response * mass / (6.0 * std::f64::consts::PI * 1.8e-5 * radius);
    let (mut early, mut late) = (0.0_f64, 0.0_f64);
    for k in 0..200 {
        let view =
            GrainsView { centre: &centre, velocity: &velocity, angular: &[], inverse_mass: &inverse_mass };
        exchange.exchange(&domain, &view, interval, f64::from(k) * interval).expect("good");
        let step = interval / 50.0;
        for _ in 0..50 {
            let mut force = vec![Vector3::zeros(); count];
            exchange.add_forces(&velocity, step, &mut force);
            velocity.iter_mut().zip(&force).for_each(|(v, force)| *v += force / mass * step);
        }
        let slip = (exchange.values().velocity[0] - velocity[0]).norm();
        if k < 100 { early = early.max(slip) } else { late = late.max(slip) }
    }
    late / early
}

/// The guard is one response time; five are stable still.
#[test]
fn exchanges_as_rare_as_the_guard_allows_and_rarer_are_stable() {
    for overlap in [false, true] {
        for loading in [0.1, 1.0, 10.0, 100.0] {
            for over in [0.1, 0.5, 1.0, 2.0, 5.0] {
                let stays = slip_that_stays(loading, over, overlap);
                assert!(stays < 1e-3, "{overlap} {loading} {over}: {stays:e}");
            }
        }
    }
}
