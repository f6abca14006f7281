//! Beds that a gas flows through on meshes of many kinds.

#![expect(clippy::print_stdout, reason = "how good it is, for whoever asks with --nocapture")]

use super::gas::{DENSITY, MovedGrains, NO_GRAVITY, VISCOSITY, ergun, gas, start};
use amberfield_core::{DragLaw, GasModel, Vector3};
use amberfield_gas::{Exchange, FlowSolver as _};
use amberfield_tests::Workbench;
use amberfield_tests::foam_beds::{BedMesh, EDGE_MM};
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

/// Diameter of the grains, and the spacing of a dense bed [m].
const DIAMETER: f64 = 1e-3;
const SPACING: f64 = 1.25e-3;
/// Superficial velocity [m/s].
const SUPERFICIAL: f64 = 0.1;
/// Intervals of 1 ms, in which a bed forgets how its flow began.
const INTERVALS: u32 = 25;
/// Share of the momentum that sums over cells and over grains may differ by.
const ROUND_OFF: f64 = 1e-10;
/// Share of the volume that continuity may miss in an interval: the tolerance of the pressure's solver.
const CONVERGED: f64 = 1e-7;
/// Largest RMS error of the velocity in an even bed, of its pressure gradient, and of either half of an
/// uneven one, all relative.
const MOST_RMS: f64 = 0.01;
/// Largest error of the velocity in any cell of an even bed, relative.
const MOST_WORST: f64 = 0.03;
const MOST_OF_HALF: f64 = 0.03;

/// Mesh with its flow, and the grains at rest in it.
struct Bed {
    exchange: Exchange,
    centres: Vec<Vector3<f64>>,
    volumes: Vec<f64>,
}

impl Bed {
    /// Lets the gas flow through grains at places [m] until nothing changes.
    fn new(mesh: BedMesh, places: &[[f64; 3]], diameter: f64, length: Option<f64>, ranks: u32) -> Self {
        let bench = Workbench::new("");
        let inlet = format!(
            "type interstitialInletVelocity; inletVelocity uniform (0 0 {SUPERFICIAL}); alpha alpha; value \
             uniform (0 0 {SUPERFICIAL});"
        );
        let open = "type pressureInletOutletVelocity; value uniform (0 0 0);";
        let nu = VISCOSITY / DENSITY;
        mesh.write(&bench, [&inlet, "type zeroGradient;"], [open, "type fixedValue; value uniform 0;"], nu);
        let flow = start(&bench, ranks);
        let (domain, foam) = (flow.mesh().domain().clone(), flow.mesh().clone());
        let (gas, mut settings) = gas(DragLaw::Gidaspow, GasModel::A);
        settings.smoothing_length_m = length;
        let mut exchange =
            Exchange::new(gas, settings, NO_GRAVITY, Box::new(flow), diameter).expect("a good mesh");
        let grains = MovedGrains::new(places.iter().copied(), 0.5 * diameter, 2500.0);
        for k in 0..INTERVALS {
            exchange.exchange(&domain, &grains.view(), 1e-3, f64::from(k) * 1e-3).expect("a good flow");
            grains.hold(&mut exchange, 1e-3);
        }
        // No grain moved: the gas has given what they got, to round-off.
        let (owed, booked) = (exchange.owed().norm(), exchange.booked().norm());
        assert!(owed < ROUND_OFF * booked, "{mesh:?}: {owed} of {booked}");
        let missing = exchange.values().residual;
        assert!(missing < CONVERGED, "{mesh:?}: continuity misses {missing}");
        Self { exchange, centres: foam.centres().to_vec(), volumes: foam.volumes().to_vec() }
    }

    /// Mean along z of velocity [m/s] and pressure drop [Pa/m], and the grains' share of the volume, of cells
    /// whose centres are inside.
    fn means(&self, is_inside: impl Fn(&Vector3<f64>) -> bool) -> [f64; 3] {
        let (mut sums, mut volume) = ([0.0; 3], 0.0);
        for (cell, part) in
            self.volumes.iter().enumerate().filter(|(cell, _)| is_inside(&self.centres[*cell]))
        {
            let values = self.exchange.values();
            sums[0] += part * values.velocity[cell].z;
            sums[1] -= part * values.pressure_gradient[cell].z;
            sums[2] += part * (1.0 - self.exchange.void_fraction()[cell]);
            volume += part;
        }
        sums.map(|sum| sum / volume)
    }
}

/// Errors of the flow through an even bed, relative.
#[derive(Clone, Copy)]
struct Errors {
    /// RMS error of the velocity over the volume.
    rms: f64,
    /// Largest error of the velocity in any cell, at walls, inlet and outlet too.
    worst: f64,
    /// Error of the mean pressure gradient.
    slope: f64,
}

/// Measures the flow through an even bed.
fn errors(mesh: BedMesh, length: Option<f64>, ranks: u32) -> Errors {
    // Rings and spirals are even only over many grains: smaller ones, smoothed as far as the others.
    let is_round = matches!(mesh, BedMesh::Wedges | BedMesh::Pipe);
    let diameter = if is_round { 0.5 * DIAMETER } else { DIAMETER };
    let length = length.or(is_round.then_some(3.0 * DIAMETER));
    let places = mesh.fill(SPACING / DIAMETER * diameter);
    let bed = Bed::new(mesh, &places, diameter, length, ranks);
    let volume: f64 = bed.volumes.iter().sum();
    let solid = PI / 6.0 * diameter.powi(3) * places.len() as f64 / volume;
    let right = Vector3::z() * SUPERFICIAL / (1.0 - solid);
    let off = bed.exchange.values().velocity.iter().map(|u| (u - right).norm() / right.norm());
    let (mut square, mut worst) = (0.0, 0.0_f64);
    for (off, part) in off.zip(&bed.volumes) {
        square += part / volume * off * off;
        worst = worst.max(off);
    }
    let slope = bed.means(|_| true)[1] / ergun(1.0 - solid, diameter, SUPERFICIAL) - 1.0;
    Errors { rms: square.sqrt(), worst, slope }
}

/// Checks the flow through an even bed.
fn is_even(mesh: BedMesh, length: Option<f64>, ranks: u32) {
    let Errors { rms, worst, slope } = errors(mesh, length, ranks);
    let percent = [rms, worst, slope].map(|x| format!("{:.2} %", 100.0 * x));
    println!("{mesh:?}, {length:?} m, {ranks} ranks: RMS, worst, slope {percent:?}");
    assert!(rms < MOST_RMS && worst < MOST_WORST && slope.abs() < MOST_RMS, "{mesh:?}: {percent:?}");
}

macro_rules! even_beds {
    ($($name:ident: $mesh:ident;)*) => {
        $(#[test]
        fn $name() {
            for length in [None, Some(12.5e-3)] {
                is_even(BedMesh::$mesh, length, 1);
            }
        })*
    };
}

even_beds! {
    an_even_bed_has_an_even_flow_on_cubes: Cubes;
    an_even_bed_has_an_even_flow_on_cells_that_grow_along_it: GradedAlong;
    an_even_bed_has_an_even_flow_on_cells_that_grow_across_it: GradedAcross;
    an_even_bed_has_an_even_flow_on_hanging_nodes: Hanging;
    an_even_bed_has_an_even_flow_on_bent_hexahedra: Perturbed;
    an_even_bed_has_an_even_flow_on_wedges: Wedges;
    an_even_bed_has_an_even_flow_on_thin_layers: Layers;
    an_even_bed_has_an_even_flow_on_tetrahedra: Tetrahedra;
    an_even_bed_has_an_even_flow_on_polyhedra: Polyhedra;
}

/// Case of a spiral of grains, which is even over a few grains only: a smoothing of two cells.
#[test]
fn an_even_bed_has_an_even_flow_in_a_pipe() {
    for (length, ranks) in [(5e-3, 1), (12.5e-3, 2)] {
        is_even(BedMesh::Pipe, Some(length), ranks);
    }
}

#[test]
fn an_even_bed_has_an_even_flow_on_two_ranks_and_whatever_smoothing_is_asked_for() {
    for mesh in [BedMesh::Hanging, BedMesh::Tetrahedra, BedMesh::Layers] {
        is_even(mesh, Some(0.5 * DIAMETER), 2);
    }
}

/// Errors of the pressure gradient in the dense and the sparse half of a bed, over what the drag law says of
/// each; the sparse half lies along an axis from the other.
fn halves(mesh: BedMesh, axis: usize) -> [f64; 2] {
    let edge = 1e-3 * EDGE_MM;
    let lattice = |spacing: f64| {
        let count = (edge / spacing).round() as usize;
        let at = move |i: usize| (i as f64 + 0.5) * spacing;
        (0..count.pow(3)).map(move |i| [at(i % count), at(i / count % count), at(i / count / count)])
    };
    // Grains that touch below half of the edge, half as many above.
    let dense = lattice(DIAMETER).filter(|place| place[axis] < 0.5 * edge);
    let places: Vec<_> = dense.chain(lattice(SPACING).filter(|place| place[axis] > 0.5 * edge)).collect();
    let bed = Bed::new(mesh, &places, DIAMETER, None, 1);
    // Away from where one goes over into the other.
    [0.0..0.2, 0.8..1.0].map(|share| {
        let [velocity, drop, solid] = bed.means(|place| share.contains(&(place[axis] / edge)));
        drop / ergun(1.0 - solid, DIAMETER, velocity * (1.0 - solid)) - 1.0
    })
}

const OF_HALVES: [BedMesh; 5] =
    [BedMesh::Cubes, BedMesh::GradedAcross, BedMesh::Hanging, BedMesh::Tetrahedra, BedMesh::Polyhedra];

#[test]
fn dense_and_sparse_halves_each_have_their_own_drop() {
    for mesh in OF_HALVES {
        for axis in [2, 0] {
            let off = halves(mesh, axis);
            let percent = off.map(|x| format!("{:.2} %", 100.0 * x));
            println!("{mesh:?}, axis {axis}: {percent:?}");
            assert!(off.iter().all(|off| off.abs() < MOST_OF_HALF), "{mesh:?}, {axis}: {percent:?}");
        }
    }
}

/// Writes docs/reports/gas.md anew.
#[test]
#[ignore = "writes a page of the documents, where it is asked for"]
fn write_report() {
    let percent = |x: f64| format!("{:.2} %", 100.0 * x).replace("-0.00", "0.00");
    let mut rows = String::new();
    for mesh in BedMesh::ALL {
        let (about, before) = told(mesh);
        let default = errors(mesh, if mesh == BedMesh::Pipe { Some(5e-3) } else { None }, 1);
        let wide = errors(mesh, Some(12.5e-3), 1);
        let [rms, worst, slope, wide, widest] =
            [default.rms, default.worst, default.slope, wide.rms, wide.worst].map(percent);
        writeln!(rows, "| {about} | {before} | {rms} | {worst} | {slope} | {wide} | {widest} |").unwrap();
    }
    let mut of_halves = String::new();
    for mesh in OF_HALVES {
        let ([dense, sparse], [left, right]) = (halves(mesh, 2), halves(mesh, 0));
        let [dense, sparse, left, right] = [dense, sparse, left, right].map(percent);
        writeln!(of_halves, "| {} | {dense} | {sparse} | {left} | {right} |", told(mesh).0).unwrap();
    }
    let (of_layers, of_all) = super::gas_packed::errors();
    let lowest = of_layers.iter().copied().fold(f64::INFINITY, f64::min);
    let highest = of_layers.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let packed = [of_all, lowest, highest].map(|x| format!("{:+.1} %", 100.0 * x));
    let packed = format!("| {} |\n", packed.join(" | "));
    let page = include_str!("gas_report.txt");
    let page = page.replace("ROWS\n", &rows).replace("HALVES\n", &of_halves).replace("PACKED\n", &packed);
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/reports/gas.md");
    std::fs::write(path, page).unwrap();
}

/// Words for a mesh, and the RMS error of the velocity on such a mesh up to protocol 5, as it was found then.
fn told(mesh: BedMesh) -> (&'static str, &'static str) {
    match mesh {
        BedMesh::Cubes => ("cubes", "1 %"),
        BedMesh::GradedAlong => ("cuboids that grow 8 : 1 along the flow", "69 to 75 %"),
        BedMesh::GradedAcross => ("cuboids that grow 8 : 1 across the flow", "69 to 75 %"),
        BedMesh::Hanging => ("cubes, a quarter of the box one level finer", "39 %"),
        BedMesh::Perturbed => ("hexahedra, corners moved by 20 %", "not measured"),
        BedMesh::Wedges => ("a sector, with wedges at its axis", "not measured"),
        BedMesh::Layers => ("thin layers at all walls, 12 : 1", "not measured"),
        BedMesh::Tetrahedra => ("tetrahedra", "23 to 35 %"),
        BedMesh::Polyhedra => ("polyhedra (polyDualMesh)", "not measured"),
        BedMesh::Pipe => ("an O-grid in a pipe", "48 to 82 %"),
        BedMesh::FineInside => ("cuboids that shrink towards the middle", "not measured"),
        BedMesh::ErgunTest => ("an O-grid of CFDEMcoupling's", "not measured"),
    }
}
