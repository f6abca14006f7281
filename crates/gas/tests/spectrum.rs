//! Modes of the exchange: whatever way the gas moves against the grains, from cell to cell, it is slowed
//! down.

mod common;

use amberfield_core::{Boundary, Domain, DragLaw, Gas, GasFlow, Vector3};
use amberfield_gas::{Exchange, FlowRequest, GrainsView};
use common::{ByRule, air, scattered};
use std::sync::{Arc, Mutex};

/// Edge of the box [m], and cells along it.
const EDGE: f64 = 0.02;
const CELLS: usize = 5;
const RADIUS: f64 = 5e-4;
/// Speed [m/s] at which drag is Stokes's.
const SLOW: f64 = 1e-12;
/// Diameters over which grains are smoothed: three and ten cells.
const LENGTHS: [f64; 2] = [0.012, 0.04];

/// Grains in a box of a gas whose cells know nothing of each other: all that joins them are grains.
struct Setup {
    exchange: Exchange,
    domain: Domain,
    settings: Gas,
    gas: Arc<Mutex<Vec<Vector3<f64>>>>,
    centre: Vec<[f64; 4]>,
}

fn setup(length: f64, overlap: bool) -> Setup {
    let domain =
        Domain::new(Vector3::zeros(), Vector3::repeat(EDGE), [[Boundary::Grounded; 2]; 3]).expect("good");
    // Stokes: linear, so that the answer to any flow is a sum of answers.
    let (settings, flow) = air(DragLaw::Stokes);
    let flow = GasFlow { smoothing_length_m: Some(length), overlap, ..flow };
    let gas = Arc::new(Mutex::new(vec![Vector3::zeros(); CELLS.pow(3)]));
    let velocity = Arc::clone(&gas);
    let cells = move |request: &FlowRequest<'_>, _: &[f64]| {
        let mut velocity = velocity.lock().expect("no panic");
        for (cell, u) in velocity.iter_mut().enumerate() {
            let mass = settings.density_kg_m3 * request.void_fraction[cell];
            let drag = request.drag[cell] * request.interval_s;
            *u = (*u * mass + request.source[cell] * request.interval_s) / (mass + drag);
        }
        velocity.clone()
    };
    let solver = ByRule::boxed(&domain, [CELLS; 3], cells);
    let exchange = Exchange::new(settings, flow, Vector3::zeros(), solver, 2.0 * RADIUS).expect("good");
    Setup { exchange, domain, settings, gas, centre: scattered([7, 7, 6], [EDGE; 3], RADIUS) }
}

/// Velocity that jumps from cell to cell [m/s].
fn rough(i: usize) -> Vector3<f64> {
    Vector3::new((7.1 * i as f64).sin(), (3.3 * i as f64).cos(), if i.is_multiple_of(2) { 1.0 } else { -1.0 })
}

#[test]
fn each_cells_gas_is_slowed_by_its_own_drag_and_that_of_no_other() {
    for length in LENGTHS {
        let Setup { mut exchange, domain, gas, centre, .. } = setup(length, false);
        let count = gas.lock().unwrap().len();
        let at_rest = vec![Vector3::zeros(); centre.len()];
        let heavy = vec![1e-9; centre.len()];
        let view = GrainsView { centre: &centre, velocity: &at_rest, angular: &[], inverse_mass: &heavy };
        let interval = 1e-2;
        // The first exchange asks for the flow as it is.
        exchange.exchange(&domain, &view, interval, 0.0).unwrap();
        exchange.add_forces(&at_rest, interval, &mut vec![Vector3::zeros(); centre.len()]);
        let mut step = |flow: Vec<Vector3<f64>>| {
            gas.lock().unwrap().clone_from(&flow);
            exchange.exchange(&domain, &view, interval, 0.0).unwrap();
            exchange.add_forces(&at_rest, interval, &mut vec![Vector3::zeros(); centre.len()]);
            gas.lock().unwrap().clone()
        };
        // So slow that nothing depends on the speed: the exchange is linear.
        let own = step(vec![Vector3::x() * SLOW; count]).iter().map(|u| u.x / SLOW).collect::<Vec<f64>>();
        // An even flow and a rough one decay alike, cell by cell: the spectrum is the cells' own factors.
        let rough: Vec<_> = (0..count).map(|cell| rough(cell) * SLOW).collect();
        for (cell, after) in step(rough.clone()).iter().enumerate() {
            assert!((after - rough[cell] * own[cell]).norm() < 1e-9 * SLOW, "{cell}: {after} {}", own[cell]);
        }
        let largest = own.iter().copied().fold(0.0, f64::max);
        assert!(largest < 0.999, "every cell is slowed down: {largest}");
    }
}

#[test]
fn no_motion_of_gas_against_grains_stays_whatever_they_weigh() {
    for length in LENGTHS {
        for (loading, overlap) in [(0.2, false), (1.0, false), (30.0, false), (1.0, true), (10.0, true)] {
            let Setup { mut exchange, domain, settings, gas, centre } = setup(length, overlap);
            let count = centre.len();
            let mass = loading * settings.density_kg_m3 * EDGE.powi(3) / count as f64;
            let response = mass / (6.0 * std::f64::consts::PI * settings.viscosity_pa_s * RADIUS);
            gas.lock().unwrap().iter_mut().enumerate().for_each(|(cell, u)| *u = rough(cell));
            let mut velocity: Vec<_> = (0..count).map(|i| rough(i + 3)).collect();
            let inverse_mass = vec![1.0 / mass; count];
            // The guard allows intervals of a response time.
            let interval = response;
            for k in 0..300 {
                let view = GrainsView {
                    centre: &centre,
                    velocity: &velocity,
                    angular: &[],
                    inverse_mass: &inverse_mass,
                };
                exchange.exchange(&domain, &view, interval, f64::from(k) * interval).unwrap();
                for _ in 0..20 {
                    let mut force = vec![Vector3::zeros(); count];
                    exchange.add_forces(&velocity, interval / 20.0, &mut force);
                    velocity.iter_mut().zip(&force).for_each(|(v, f)| *v += f / mass * (interval / 20.0));
                }
            }
            let mean = velocity.iter().sum::<Vector3<f64>>() / count as f64;
            let gas = gas.lock().unwrap();
            let apart = velocity.iter().chain(gas.iter()).map(|v| (v - mean).norm()).fold(0.0, f64::max);
            assert!(apart < 1e-2, "{length} {loading} {overlap}: {apart}");
        }
    }
}
