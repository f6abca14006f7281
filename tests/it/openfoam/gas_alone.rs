//! Grains alone and grains that move, in a gas on meshes of many kinds.

use super::gas::{DENSITY, MovedGrains, NO_GRAVITY, VISCOSITY, cyclic, gas, solver, start};
use amberfield_core::{DragLaw, GasModel, Vector3};
use amberfield_coupling::RemoteFlow;
use amberfield_field::far::FarMesh;
use amberfield_gas::{CellShapes, Exchange, FlowRequest, FlowSolver, FlowValues, GasError};
use amberfield_laws::drag;
use amberfield_laws::particle_reynolds::Slip;
use amberfield_tests::Workbench;
use amberfield_tests::foam_beds::{BedMesh, EDGE_MM};
use std::f64::consts::PI;
use std::sync::{Arc, Mutex};

const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);
const NU: f64 = VISCOSITY / DENSITY;
const NO_SLOPE: &str = "type zeroGradient;";
const OPEN: [&str; 2] =
    ["type pressureInletOutletVelocity; value uniform (0 0 0);", "type fixedValue; value uniform 0;"];
/// Share of the force that sums in another order may differ by.
const ROUND_OFF: f64 = 1e-11;
/// Largest error of a lone grain's terminal speed, relative.
const MOST_OF_LONE: f64 = 0.01;
/// Share of the volume that continuity may miss in an interval: the tolerance of the pressure's solver.
const CONVERGED: f64 = 1e-7;

/// A flow of OpenFOAM's, and the momentum that it gave [N·s].
#[derive(Debug)]
struct Counted {
    flow: RemoteFlow,
    asked: (f64, Vec<f64>, Vec<Vector3<f64>>),
    given: Arc<Mutex<Vector3<f64>>>,
}

impl FlowSolver for Counted {
    fn mesh(&self) -> &FarMesh {
        self.flow.mesh()
    }

    fn shapes(&self) -> &CellShapes {
        self.flow.shapes()
    }

    fn ask(&mut self, request: &FlowRequest<'_>) -> Result<(), GasError> {
        self.asked = (request.interval_s, request.drag.to_vec(), request.source.to_vec());
        self.flow.ask(request)
    }

    fn take(&mut self, values: &mut FlowValues) -> Result<(), GasError> {
        self.flow.take(values)?;
        let (interval, drag, source) = &self.asked;
        let cells = values.velocity.iter().zip(drag).zip(source).zip(self.flow.mesh().volumes());
        let force: Vector3<f64> = cells.map(|(((u, drag), source), v)| (u * *drag - source) * *v).sum();
        *self.given.lock().expect("no panic") += force * *interval;
        Ok(())
    }

    fn state(&mut self) -> Result<Vec<Vec<f64>>, GasError> {
        self.flow.state()
    }

    fn restore(&mut self, state: &[Vec<f64>]) -> Result<(), GasError> {
        self.flow.restore(state)
    }
}

/// Speed [m/s] at which a lone grain of a diameter [m] and a density [kg/m³] falls by a drag law.
pub(super) fn terminal_speed(law: DragLaw, diameter: f64, solid: f64) -> f64 {
    let weight = (solid - DENSITY) * PI / 6.0 * diameter.powi(3) * 9.81;
    let (mut slow, mut fast) = (0.0, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (slow + fast);
        if force_at(law, diameter, middle) < weight { slow = middle } else { fast = middle }
    }
    slow
}

/// Force [N] of a drag law on a lone grain of a diameter [m] at a speed [m/s].
fn force_at(law: DragLaw, diameter: f64, speed: f64) -> f64 {
    let slip = Slip { speed, void_fraction: 1.0, diameter, density: DENSITY, viscosity: VISCOSITY };
    drag::coefficient(law, &slip) * speed
}

#[test]
fn a_grain_falls_at_the_terminal_speed_of_its_drag_law() {
    let cases = [
        (DragLaw::Stokes, 2e-5),
        (DragLaw::SchillerNaumann, 1.2e-5),
        (DragLaw::SchillerNaumann, 1e-4),
        (DragLaw::SchillerNaumann, 4e-4),
        (DragLaw::SchillerNaumann, 1.55e-3),
    ];
    for (law, diameter) in cases {
        let slow = terminal_speed(law, diameter, 2500.0);
        let slip = Slip { speed: slow, void_fraction: 1.0, diameter, density: DENSITY, viscosity: VISCOSITY };
        let response = 2500.0 * PI / 6.0 * diameter.powi(3) / drag::coefficient(law, &slip);
        let edge_mm = 1500.0 * diameter * 1e3;
        let (_bench, flow) = solver([edge_mm; 3], [10; 3], &[cyclic(); 6], 1);
        let domain = flow.mesh().domain().clone();
        let (gas, settings) = gas(law, GasModel::A);
        let mut exchange =
            Exchange::new(gas, settings, GRAVITY, Box::new(flow), diameter).expect("a good mesh");
        let mut grains = MovedGrains::new([[0.3e-3 * edge_mm; 3]], 0.5 * diameter, 2500.0);
        grains.velocity[0].z = -0.9 * slow;
        let interval = 0.1 * response;
        for k in 0..70 {
            exchange
                .exchange(&domain, &grains.view(), interval, f64::from(k) * interval)
                .expect("a good flow");
            grains.go(&mut exchange, GRAVITY, interval, 10);
        }
        let found = -grains.velocity[0].z;
        assert!((found / slow - 1.0).abs() < 0.005, "{law:?} {diameter}: {found} {slow}");
    }
}

/// Middle of a mesh: that of its even grains which is nearest to their centre [m].
fn middle(mesh: BedMesh) -> [f64; 3] {
    let places = mesh.fill(1.25e-3);
    let centre: Vector3<f64> = places.iter().map(|place| Vector3::from(*place)).sum::<Vector3<f64>>();
    let centre = centre / places.len() as f64;
    let away = |place: &[f64; 3]| (Vector3::from(*place) - centre).norm();
    places.into_iter().min_by(|a, b| away(a).total_cmp(&away(b))).expect("there are grains")
}

#[test]
fn in_a_gas_at_rest_every_grain_has_archimedes_buoyancy() {
    for mesh in BedMesh::ALL {
        let bench = Workbench::new("");
        mesh.write(&bench, ["type fixedValue; value uniform (0 0 0);", NO_SLOPE], OPEN, NU);
        let flow = start(&bench, 1);
        let domain = flow.mesh().domain().clone();
        let (gas, settings) = gas(DragLaw::Gidaspow, GasModel::A);
        let mut exchange = Exchange::new(gas, settings, GRAVITY, Box::new(flow), 4e-3).expect("a good mesh");
        // From a fiftieth of a cell to two cells.
        let mut grains = MovedGrains::new(mesh.fill(5e-3), 5e-5, 2500.0);
        grains.centre.iter_mut().enumerate().for_each(|(i, grain)| grain[3] *= 1.0 + 39.0 * (i % 2) as f64);
        for k in 0..3 {
            exchange.exchange(&domain, &grains.view(), 1e-3, f64::from(k) * 1e-3).expect("a good flow");
            let mut force = vec![Vector3::zeros(); grains.centre.len()];
            exchange.add_forces(&grains.velocity, 1e-3, &mut force);
            for ([_, _, _, radius], force) in grains.centre.iter().zip(force) {
                let expected = -GRAVITY * (DENSITY * 4.0 / 3.0 * PI * radius.powi(3));
                let off = (force - expected).norm() / expected.norm();
                assert!(off < ROUND_OFF, "{mesh:?}, radius {radius}: {off}");
            }
        }
    }
}

/// Error of a lone grain's terminal speed, relative: from the force on it of a gas that rises at that of its
/// drag law, after so many intervals in which it rises by so much [m].
fn carried(mesh: BedMesh, diameter: f64, (intervals, rise): (u32, f64)) -> f64 {
    const SOLID: f64 = 500.0;
    let weight = (SOLID - DENSITY) * PI / 6.0 * diameter.powi(3) * 9.81;
    let slow = terminal_speed(DragLaw::Gidaspow, diameter, SOLID);
    let bench = Workbench::new("");
    let inlet = format!("type fixedValue; value uniform (0 0 {slow});");
    mesh.write(&bench, [&inlet, NO_SLOPE], OPEN, NU);
    // The gas has begun long ago.
    let rising = format!("internalField uniform (0 0 {slow});");
    bench.write("foam/0/U", bench.read("foam/0/U").replace("internalField uniform (0 0 0);", &rising));
    let flow = start(&bench, 1);
    let domain = flow.mesh().domain().clone();
    let (gas, settings) = gas(DragLaw::Gidaspow, GasModel::A);
    let mut exchange = Exchange::new(gas, settings, GRAVITY, Box::new(flow), diameter).expect("a good mesh");
    let grains = MovedGrains::new([middle(mesh)], 0.5 * diameter, SOLID);
    let interval = rise / slow;
    let mut force = Vector3::zeros();
    for k in 0..intervals {
        exchange.exchange(&domain, &grains.view(), interval, f64::from(k) * interval).expect("a good flow");
        force = grains.hold(&mut exchange, interval);
    }
    let buoyancy = DENSITY * PI / 6.0 * diameter.powi(3) * 9.81;
    // Force over speed to the power of n: between 1 for slow grains and 2 for fast ones.
    let steeper = force_at(DragLaw::Gidaspow, diameter, 1.01 * slow) / weight;
    ((force.z - buoyancy) / weight).ln() / (steeper.ln() / 1.01_f64.ln())
}

#[test]
fn a_lone_grain_is_carried_at_its_terminal_speed_on_any_mesh() {
    let mut missed = Vec::new();
    for mesh in BedMesh::ALL {
        for diameter in [2.5e-4, 8e-4, 1.6e-3] {
            // The gas passes twice.
            let off = carried(mesh, diameter, (13, 3e-3));
            println!("{mesh:?}, {diameter} m: {:.2} %", 100.0 * off);
            if off.abs() > MOST_OF_LONE {
                missed.push((mesh, diameter, off));
            }
        }
    }
    assert!(missed.is_empty(), "{missed:?}");
}

#[test]
fn a_lone_grain_is_carried_in_cells_of_a_tenth_of_its_diameter() {
    let off = carried(BedMesh::FineInside, 1.2e-3, (12, 1e-3));
    println!("{:.2} %", 100.0 * off);
    assert!(off.abs() < MOST_OF_LONE, "{off}");
}

/// Writes a jet into the inlet's middle, 8 mm wide, with a slow gas around it, and returns the condition.
fn jet(bench: &Workbench) -> String {
    const POINTS: usize = 81;
    let (mut points, mut speeds) = (String::new(), String::new());
    for i in 0..POINTS * POINTS {
        let [x, y] =
            [i % POINTS, i / POINTS].map(|k| 1e-3 * EDGE_MM * (2.0 * k as f64 / (POINTS - 1) as f64 - 1.0));
        let inside = x.hypot(y) < 4e-3 || (x - 1e-2).hypot(y - 1e-2) < 4e-3;
        points += &format!("({x:e} {y:e} 0)\n");
        speeds += &format!("(0 0 {})\n", if inside { 1.0 } else { 0.1 });
    }
    let count = POINTS * POINTS;
    std::fs::create_dir_all(bench.path("foam/constant/boundaryData/inlet/0")).expect("a folder");
    bench.write("foam/constant/boundaryData/inlet/points", format!("{count}\n(\n{points})\n"));
    bench.write("foam/constant/boundaryData/inlet/0/U", format!("{count}\n(\n{speeds})\n"));
    "type timeVaryingMappedFixedValue; setAverage off; offset (0 0 0); mapMethod nearest; value uniform (0 0 \
     0.1);"
        .to_owned()
}

#[test]
fn a_jet_into_moving_grains_keeps_momentum_and_mass_on_any_mesh() {
    for (seed, mesh) in BedMesh::ALL.into_iter().enumerate() {
        let bench = Workbench::new("");
        let inlet = jet(&bench);
        mesh.write(&bench, [&inlet, NO_SLOPE], OPEN, NU);
        let flow = start(&bench, 1 + seed as u32 % 2);
        let domain = flow.mesh().domain().clone();
        let given = Arc::new(Mutex::new(Vector3::zeros()));
        let counted = Counted { flow, asked: (0.0, Vec::new(), Vec::new()), given: Arc::clone(&given) };
        let model = if seed % 3 == 0 { GasModel::B } else { GasModel::A };
        let (gas, settings) = gas(DragLaw::ALL[seed % DragLaw::ALL.len()], model);
        let mut exchange =
            Exchange::new(gas, settings, NO_GRAVITY, Box::new(counted), 1e-3).expect("a good mesh");
        let inside = mesh.fill(2e-3).into_iter().filter(|place| (5e-3..15e-3).contains(&place[2]));
        let mut grains = MovedGrains::new(inside, 0.5e-3, 500.0);
        for (i, v) in grains.velocity.iter_mut().enumerate() {
            let k = (i + 100 * seed) as f64;
            *v = Vector3::new(0.1 * (1.7 * k).sin(), 0.1 * (2.3 * k).cos(), 0.4 * (3.1 * k).sin());
        }
        let (interval, mut missing) = (2e-4, 0.0_f64);
        for k in 0..12 {
            exchange
                .exchange(&domain, &grains.view(), interval, f64::from(k) * interval)
                .expect("a good flow");
            missing = missing.max(exchange.values().residual);
            grains.go(&mut exchange, NO_GRAVITY, interval, 4);
        }
        let booked = exchange.booked();
        let off = (*given.lock().expect("no panic") + exchange.owed() - booked).norm() / booked.norm();
        println!("{mesh:?}: momentum {off:.1e}, continuity {missing:.1e}");
        assert!(off < ROUND_OFF, "{mesh:?}: {off}");
        assert!(missing < CONVERGED, "{mesh:?}: {missing}");
    }
}
