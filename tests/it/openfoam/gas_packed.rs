//! A bed packed at random, in the geometry of a public case.

#![expect(clippy::print_stdout, reason = "how good it is, for whoever asks with --nocapture")]

use super::gas::{MovedGrains, NO_GRAVITY, ergun_of, gas, start};
use amberfield_core::{DragLaw, Gas, GasModel};
use amberfield_gas::{Exchange, FlowSolver as _};
use amberfield_tests::Workbench;
use amberfield_tests::foam_beds::BedMesh;
use amberfield_tests::packing::Packing;

/// Gas [kg/m³, Pa s], grains [m] and bed [m] of CFDEMcoupling's tutorial cfdemSolverPiso/ErgunTestMPI; the
/// velocity [m/s] is one of its ten.
const DENSITY: f64 = 10.0;
const VISCOSITY: f64 = 1.5e-3;
const DIAMETER: f64 = 1e-3;
const RADIUS: f64 = 13.8e-3;
const HEIGHT: f64 = 15.6e-3;
const COUNT: usize = 10_000;
const SUPERFICIAL: f64 = 8e-3;
/// Height of a layer of cells, and layers below the last but one of the bed [m].
const LAYER: f64 = 55.3e-3 / 24.0;
const LAYERS: usize = 5;
/// Intervals of 1 ms, in which the flow becomes steady.
const INTERVALS: u32 = 8;
/// Largest error of the bed's pressure gradient, and of that of any layer, relative.
const MOST: f64 = 0.05;
const MOST_OF_LAYER: f64 = 0.1;

/// Pressure gradient of layers of cells over what Ergun's equation says of each cell, minus 1: of each
/// layer, and of all together.
pub(super) fn errors() -> ([f64; LAYERS], f64) {
    let packing = Packing::new(COUNT, DIAMETER, RADIUS, HEIGHT);
    println!("deepest overlap {:.4} diameters", packing.overlap);
    let places = packing.places.iter().map(|[x, y, z]| [x + RADIUS, y + RADIUS, *z]);
    let bench = Workbench::new("");
    let inlet = format!(
        "type interstitialInletVelocity; inletVelocity uniform (0 0 {SUPERFICIAL}); alpha alpha; value \
         uniform (0 0 {SUPERFICIAL});"
    );
    let open = "type pressureInletOutletVelocity; value uniform (0 0 0);";
    BedMesh::ErgunTest.write(
        &bench,
        [&inlet, "type zeroGradient;"],
        [open, "type fixedValue; value uniform 0;"],
        VISCOSITY / DENSITY,
    );
    let flow = start(&bench, 1);
    let mesh = flow.mesh().clone();
    let (air, settings) = gas(DragLaw::Gidaspow, GasModel::A);
    let gas = Gas { density_kg_m3: DENSITY, viscosity_pa_s: VISCOSITY, ..air };
    let mut exchange =
        Exchange::new(gas, settings, NO_GRAVITY, Box::new(flow), DIAMETER).expect("a good mesh");
    let grains = MovedGrains::new(places, 0.5 * DIAMETER, 2000.0);
    for k in 0..INTERVALS {
        exchange.exchange(mesh.domain(), &grains.view(), 1e-3, f64::from(k) * 1e-3).expect("a good flow");
        grains.hold(&mut exchange, 1e-3);
    }
    let (mut found, mut right) = ([0.0; LAYERS], [0.0; LAYERS]);
    for (cell, volume) in mesh.volumes().iter().enumerate() {
        let layer = (mesh.centres()[cell].z / LAYER) as usize;
        if layer < LAYERS {
            let (void, values) = (exchange.void_fraction()[cell], exchange.values());
            let speed = values.velocity[cell].z;
            found[layer] -= volume * values.pressure_gradient[cell].z;
            right[layer] += volume * ergun_of([VISCOSITY, DENSITY], void, DIAMETER, void * speed);
        }
    }
    let of_layers = std::array::from_fn(|layer| found[layer] / right[layer] - 1.0);
    (of_layers, found.iter().sum::<f64>() / right.iter().sum::<f64>() - 1.0)
}

#[test]
fn a_packed_bed_has_erguns_pressure_gradient_with_each_cells_void_fraction() {
    let (of_layers, of_all) = errors();
    let percent = of_layers.map(|x| format!("{:.2} %", 100.0 * x));
    println!("layers from below {percent:?}, all {:.2} %", 100.0 * of_all);
    assert!(of_all.abs() < MOST, "{of_all}");
    assert!(of_layers.iter().all(|off| off.abs() < MOST_OF_LAYER), "{percent:?}");
}
