//! Gas whose flow OpenFOAM computes, between grains that this test moves itself.

use amberfield_core::{DragLaw, Gas, GasFlow, GasModel, Vector3};
use amberfield_coupling::{Announced, RemoteFlow, SolverSettings};
use amberfield_gas::{Exchange, FlowSolver as _, GrainsView};
use amberfield_tests::Workbench;
use amberfield_tests::foam_case::{brick, write_gas_case};
use std::f64::consts::PI;
use std::time::Duration;

pub(super) const DENSITY: f64 = 1.2;
pub(super) const VISCOSITY: f64 = 1.8e-5;
const CYCLIC: (&str, &str) = ("cyclic", "type cyclic;");
pub(super) const NO_GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

pub(super) fn gas(drag: DragLaw, model: GasModel) -> (Gas, GasFlow) {
    let flow = GasFlow {
        model,
        interval_s: 1.0,
        smoothing_length_m: None,
        viscous_force: false,
        saffman_lift: false,
        overlap: false,
    };
    let gas = Gas {
        drag,
        density_kg_m3: DENSITY,
        viscosity_pa_s: VISCOSITY,
        velocity_m_s: Vector3::zeros(),
        magnus_lift: false,
        flow: Some(flow),
    };
    (gas, flow)
}

/// Starts the solver of a box with edges [mm] and a number of cells per axis, with `ranks` processes.
///
/// Each side has a kind, a condition of U and a condition of p.
pub(super) fn solver(
    edges_mm: [f64; 3],
    cells: [usize; 3],
    sides: &[[&str; 3]; 6],
    ranks: u32,
) -> (Workbench, RemoteFlow) {
    let bench = Workbench::new("");
    let velocity = brick(edges_mm, cells, &sides.map(|[kind, velocity, _]| (kind, velocity)));
    let pressure = brick(edges_mm, cells, &sides.map(|[kind, _, pressure]| (kind, pressure)));
    let viscosity = VISCOSITY / DENSITY;
    write_gas_case(&bench, &velocity.mesh, &velocity.conditions, &pressure.conditions, viscosity);
    let flow = start(&bench, ranks);
    (bench, flow)
}

pub(super) fn start(bench: &Workbench, ranks: u32) -> RemoteFlow {
    let settings = SolverSettings {
        flow: true,
        ranks,
        timeout: Duration::from_secs(60),
        far_tolerance: 1e-7,
        ..SolverSettings::started(bench.path("foam"), bench.path("solver"))
    };
    Announced::new(settings).and_then(Announced::connect).expect("the solver answers").flow()
}

/// Kind and conditions of a periodic side.
pub(super) fn cyclic() -> [&'static str; 3] {
    [CYCLIC.0, CYCLIC.1, CYCLIC.1]
}

/// MovedGrains that this test moves.
pub(super) struct MovedGrains {
    pub(super) centre: Vec<[f64; 4]>,
    pub(super) velocity: Vec<Vector3<f64>>,
    inverse_mass: Vec<f64>,
}

impl MovedGrains {
    pub(super) fn new(places: impl IntoIterator<Item = [f64; 3]>, radius: f64, density: f64) -> Self {
        let centre: Vec<_> = places.into_iter().map(|[x, y, z]| [x, y, z, radius]).collect();
        let mass = density * 4.0 / 3.0 * PI * radius.powi(3);
        Self {
            velocity: vec![Vector3::zeros(); centre.len()],
            inverse_mass: vec![1.0 / mass; centre.len()],
            centre,
        }
    }

    pub(super) fn view(&self) -> GrainsView<'_> {
        GrainsView {
            centre: &self.centre,
            velocity: &self.velocity,
            angular: &[],
            inverse_mass: &self.inverse_mass,
        }
    }

    /// Moves the grains through an interval [s] between exchanges, in `steps` steps.
    pub(super) fn go(&mut self, exchange: &mut Exchange, gravity: Vector3<f64>, interval: f64, steps: usize) {
        let step = interval / steps as f64;
        for _ in 0..steps {
            let mut force = vec![Vector3::zeros(); self.centre.len()];
            exchange.add_forces(&self.velocity, step, &mut force);
            for (i, force) in force.iter().enumerate() {
                self.velocity[i] += (force * self.inverse_mass[i] + gravity) * step;
                (0..3).for_each(|axis| self.centre[i][axis] += self.velocity[i][axis] * step);
            }
        }
    }

    /// Holds the grains at their places for an interval [s]; returns the force on all of them [N].
    pub(super) fn hold(&self, exchange: &mut Exchange, interval: f64) -> Vector3<f64> {
        let mut force = vec![Vector3::zeros(); self.centre.len()];
        exchange.add_forces(&self.velocity, interval, &mut force);
        force.iter().sum()
    }

    fn momentum(&self) -> Vector3<f64> {
        self.velocity.iter().zip(&self.inverse_mass).map(|(v, inverse_mass)| v / *inverse_mass).sum()
    }
}

/// Places [m] of a cubic lattice with a spacing [m].
fn lattice(counts: [usize; 3], spacing: f64) -> impl Iterator<Item = [f64; 3]> {
    let at = move |i: usize| (i as f64 + 0.5) * spacing;
    let [x, y, z] = counts;
    (0..x * y * z).map(move |i| [at(i % x), at(i / x % y), at(i / (x * y))])
}

/// Ergun's pressure drop of air [Pa/m] for a void fraction, a diameter [m] and a superficial velocity [m/s].
pub(super) fn ergun(void: f64, diameter: f64, superficial: f64) -> f64 {
    ergun_of([VISCOSITY, DENSITY], void, diameter, superficial)
}

/// Ergun's pressure drop [Pa/m] of a gas of a viscosity [Pa s] and a density [kg/m³].
pub(super) fn ergun_of([viscosity, density]: [f64; 2], void: f64, diameter: f64, superficial: f64) -> f64 {
    let solid = 1.0 - void;
    150.0 * viscosity * solid * solid * superficial / (void.powi(3) * diameter * diameter)
        + 1.75 * density * solid * superficial * superficial / (void.powi(3) * diameter)
}

#[test]
fn fixed_bed_has_erguns_pressure_drop() {
    let sides = [
        cyclic(),
        cyclic(),
        cyclic(),
        cyclic(),
        ["patch", "type fixedValue; value uniform (0 0 0.8);", "type zeroGradient;"],
        ["patch", "type zeroGradient;", "type fixedValue; value uniform 0;"],
    ];
    for model in [GasModel::A, GasModel::B] {
        let (_bench, flow) = solver([8.0, 8.0, 16.0], [4, 4, 8], &sides, 1);
        let domain = flow.mesh().domain().clone();
        let (gas, settings) = gas(DragLaw::Gidaspow, model);
        let mut exchange =
            Exchange::new(gas, settings, NO_GRAVITY, Box::new(flow), 1e-3).expect("a good mesh");
        let grains = MovedGrains::new(lattice([8, 8, 16], 1e-3), 0.5e-3, 2500.0);
        for k in 0..60 {
            exchange.exchange(&domain, &grains.view(), 1e-3, f64::from(k) * 1e-3).expect("a good flow");
            grains.hold(&mut exchange, 1e-3);
        }
        let cell = 4 * 16 + 5;
        let void = exchange.void_fraction()[cell];
        let values = exchange.values();
        let superficial = void * values.velocity[cell].z;
        let (found, expected) = (-values.pressure_gradient[cell].z, ergun(void, 1e-3, superficial));
        println!(
            "model {model:?}: void {void:.4}, U {superficial:.4} m/s, {found:.2} Pa/m, Ergun {expected:.2} \
             Pa/m"
        );
        assert!((void - (1.0 - PI / 6.0)).abs() < 1e-3, "{void}");
        assert!((found / expected - 1.0).abs() < 0.01, "{model:?}: {found} {expected}");
        assert!(values.residual < 1e-7, "{}", values.residual);
    }
}

#[test]
fn a_bed_lifts_off_at_erguns_least_velocity() {
    const DIAMETER: f64 = 1e-3;
    const SOLIDS: f64 = 1500.0;
    let void = 1.0 - PI / 6.0;
    let weight = (1.0 - void) * (SOLIDS - DENSITY) * 9.81;
    let (mut slow, mut fast) = (0.0, 10.0);
    for _ in 0..100 {
        let middle = 0.5 * (slow + fast);
        if ergun(void, DIAMETER, middle) < weight { slow = middle } else { fast = middle }
    }
    let gravity = Vector3::new(0.0, 0.0, -9.81);
    let rises = |over: f64| {
        let inlet = format!("type fixedValue; value uniform (0 0 {});", over * slow);
        let sides = [
            cyclic(),
            cyclic(),
            cyclic(),
            cyclic(),
            ["patch", &inlet, "type zeroGradient;"],
            ["patch", "type zeroGradient;", "type fixedValue; value uniform 0;"],
        ];
        let (_bench, flow) = solver([8.0, 8.0, 160.0], [4, 4, 80], &sides, 1);
        let domain = flow.mesh().domain().clone();
        let (gas, settings) = gas(DragLaw::Gidaspow, GasModel::A);
        let mut exchange =
            Exchange::new(gas, settings, gravity, Box::new(flow), DIAMETER).expect("a good mesh");
        // Free gas lies below and above the bed of 120 layers. Its ends, which smoothing spreads over two and
        // a half layers, resist less.
        let places = lattice([8, 8, 120], DIAMETER).map(|[x, y, z]| [x, y, z + 20e-3]);
        let grains = MovedGrains::new(places, 0.5 * DIAMETER, SOLIDS);
        let mut force = Vector3::zeros();
        for k in 0..60 {
            exchange.exchange(&domain, &grains.view(), 1e-3, f64::from(k) * 1e-3).expect("a good flow");
            force = grains.hold(&mut exchange, 1e-3);
        }
        let weight = 9.81 * grains.inverse_mass.iter().map(|inverse| 1.0 / inverse).sum::<f64>();
        println!(
            "{over} of the least velocity {slow:.4} m/s: the gas carries {:.4} of the bed",
            force.z / weight
        );
        force.z > weight
    };
    assert!(!rises(0.95) && rises(1.05));
}

#[test]
fn grains_and_gas_keep_their_momentum() {
    let (_bench, flow) = solver([10.0; 3], [5; 3], &[cyclic(); 6], 1);
    let mesh = flow.mesh().clone();
    let (gas, settings) = gas(DragLaw::Gidaspow, GasModel::A);
    let mut exchange = Exchange::new(gas, settings, NO_GRAVITY, Box::new(flow), 1e-3).expect("a good mesh");
    let mut grains = MovedGrains::new(lattice([7, 6, 5], 1.4e-3), 0.5e-3, 100.0);
    for (i, v) in grains.velocity.iter_mut().enumerate() {
        let k = i as f64;
        *v = Vector3::new(0.3 + 0.2 * (1.7 * k).sin(), 0.2 * (2.3 * k).cos(), 0.1 * (3.1 * k).sin());
    }
    let start = grains.momentum();
    let of_gas = |exchange: &Exchange| -> Vector3<f64> {
        let cells = exchange.values().velocity.iter().zip(exchange.void_fraction()).zip(mesh.volumes());
        cells.map(|((u, void), volume)| u * (DENSITY * void * volume)).sum()
    };
    let interval = 2e-4;
    for k in 0..50 {
        exchange
            .exchange(mesh.domain(), &grains.view(), interval, f64::from(k) * interval)
            .expect("a good flow");
        grains.go(&mut exchange, NO_GRAVITY, interval, 7);
    }
    let (now, gas) = (grains.momentum(), of_gas(&exchange));
    let missing = (now + gas - exchange.owed() - start).norm() / (now - start).norm();
    println!(
        "grains lost {:?}, gas got {:?}, missing {missing:.1e} of it",
        (start - now).as_slice(),
        gas.as_slice()
    );
    assert!((now - start).norm() > 0.02 * start.norm());
    assert!(missing < 1e-10, "{missing}");
}

/// Velocities [m/s] of a cloud of grains after two hundred exchanges with the gas of a box in which it falls.
///
/// With `parted`, the second half of the flow is computed by another process.
fn stirred(ranks: u32, parted: bool) -> Vec<Vector3<f64>> {
    let wall = ["wall", "type noSlip;", "type zeroGradient;"];
    let (bench, flow) = solver([10.0; 3], [6; 3], &[cyclic(), cyclic(), wall, wall, wall, wall], ranks);
    let domain = flow.mesh().domain().clone();
    let (gas, settings) = gas(DragLaw::DiFelice, GasModel::A);
    let settings = GasFlow { viscous_force: true, saffman_lift: true, ..settings };
    let begin = |flow| Exchange::new(gas, settings, NO_GRAVITY, Box::new(flow), 1e-3).expect("a good mesh");
    let mut exchange = begin(flow);
    let mut grains = MovedGrains::new(lattice([5, 5, 4], 2e-3), 0.4e-3, 500.0);
    for (i, v) in grains.velocity.iter_mut().enumerate() {
        *v = Vector3::new(0.5, 0.1 * (1.3 * i as f64).sin(), 0.0);
    }
    let interval = 2e-4;
    for k in 0..40 {
        if k == 20 && parted {
            let state = exchange.state().expect("a solver");
            drop(exchange);
            exchange = begin(start(&bench, ranks));
            exchange.restore(&state).expect("its own state");
        }
        exchange.exchange(&domain, &grains.view(), interval, f64::from(k) * interval).expect("a good flow");
        grains.go(&mut exchange, NO_GRAVITY, interval, 5);
    }
    grains.velocity
}

#[test]
fn a_flow_goes_on_bit_for_bit_in_another_process_and_is_the_same_with_two_ranks() {
    let whole = stirred(1, false);
    assert_eq!(stirred(1, true), whole);
    let two = stirred(2, false);
    assert_eq!(stirred(2, true), two);
    let apart = whole.iter().zip(&two).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
    println!("two ranks differ by {apart:.1e} m/s");
    assert!(apart < 1e-6, "{apart}");
}

#[test]
fn between_plates_a_gas_flows_through_grains_at_rest_as_brinkmans() {
    // Stokes drag of a uniform lattice: −ε G + ε μ u\" − K u = 0 with u = 0 at the plates.
    const DROP: f64 = 0.05;
    const RADIUS: f64 = 1e-6;
    let wall = ["wall", "type noSlip;", "type zeroGradient;"];
    let pressure = format!("type fixedValue; value uniform {:e};", DROP * 10e-3 / DENSITY);
    let open = "type pressureInletOutletVelocity; value uniform (0 0 0);";
    let sides = [
        ["patch", open, &pressure],
        ["patch", open, "type fixedValue; value uniform 0;"],
        cyclic(),
        cyclic(),
        wall,
        wall,
    ];
    let (_bench, flow) = solver([10.0, 2.0, 8.0], [5, 1, 32], &sides, 1);
    let mesh = flow.mesh().clone();
    let (gas, settings) = gas(DragLaw::Stokes, GasModel::A);
    let settings = GasFlow { smoothing_length_m: Some(1.5e-3), ..settings };
    let mut exchange = Exchange::new(gas, settings, NO_GRAVITY, Box::new(flow), 1e-4).expect("a good mesh");
    let grains = MovedGrains::new(lattice([20, 4, 16], 0.5e-3), RADIUS, 2500.0);
    for k in 0..400 {
        exchange.exchange(mesh.domain(), &grains.view(), 5e-3, f64::from(k) * 5e-3).expect("a good flow");
        grains.hold(&mut exchange, 5e-3);
    }
    let resistance = 6.0 * PI * VISCOSITY * RADIUS / 0.5e-3_f64.powi(3);
    let rate = (resistance / VISCOSITY).sqrt();
    let profile = |z: f64| DROP / resistance * (1.0 - (rate * (z - 4e-3)).cosh() / (rate * 4e-3).cosh());
    let (mut missed, mut most) = (0.0_f64, 0.0_f64);
    for (u, centre) in exchange.values().velocity.iter().zip(mesh.centres()) {
        let expected = profile(centre.z);
        missed = missed.max((u.x - expected).abs());
        most = most.max(expected);
    }
    println!("λH {:.2}, largest speed {most:.4} m/s, missed by {:.2e} of it", rate * 8e-3, missed / most);
    assert!(missed < 0.01 * most, "{missed} {most}");
}
