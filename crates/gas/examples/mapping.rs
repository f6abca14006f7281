//! Time that an exchange takes beside the flow's: grains found in cells and their shares summed, the flow
//! taken to grains, drag. The beds are like those of `cases/goldschmidt` and `cases/fluidised-charged-bed`.
//!
//! ```text
//! cargo run --release -p amberfield-gas --example mapping
//! ```

#![expect(clippy::print_stdout, reason = "its purpose")]

use amberfield_core::{Boundary, Domain, DragLaw, Gas, GasFlow, GasModel, Vector3};
use amberfield_field::far::{FarMesh, FarMeshParts};
use amberfield_gas::{CellShapes, Exchange, FlowRequest, FlowSolver, FlowValues, GasError, GrainsView};
use std::error::Error;

/// Exchanges, of which the fastest and the median are told.
const EXCHANGES: usize = 40;

/// A gas that rises evenly whatever grains do.
#[derive(Debug)]
struct Even {
    mesh: FarMesh,
    shapes: CellShapes,
}

impl FlowSolver for Even {
    fn mesh(&self) -> &FarMesh {
        &self.mesh
    }

    fn shapes(&self) -> &CellShapes {
        &self.shapes
    }

    fn ask(&mut self, _: &FlowRequest<'_>) -> Result<(), GasError> {
        Ok(())
    }

    fn take(&mut self, values: &mut FlowValues) -> Result<(), GasError> {
        values.velocity = vec![Vector3::z(); self.mesh.cell_count()];
        values.pressure_gradient = vec![-Vector3::z(); self.mesh.cell_count()];
        Ok(())
    }

    fn state(&mut self) -> Result<Vec<Vec<f64>>, GasError> {
        Ok(Vec::new())
    }

    fn restore(&mut self, _: &[Vec<f64>]) -> Result<(), GasError> {
        Ok(())
    }
}

/// Bed of grains in a box of cells.
struct Bed {
    name: &'static str,
    edges_m: [f64; 3],
    cells: [usize; 3],
    diameter_m: f64,
    /// Grains along each axis, from the bottom.
    grains: [usize; 3],
}

const BEDS: [Bed; 2] = [
    Bed {
        name: "goldschmidt",
        edges_m: [0.015, 0.15, 0.45],
        cells: [2, 30, 90],
        diameter_m: 2.5e-3,
        grains: [6, 60, 69],
    },
    Bed {
        name: "fluidised-charged-bed",
        edges_m: [0.04, 0.01, 0.12],
        cells: [20, 5, 60],
        diameter_m: 1e-3,
        grains: [38, 9, 35],
    },
];

impl Bed {
    /// Positions and radii of grains in layers, each moved a little [m].
    fn grains(&self) -> Vec<[f64; 4]> {
        let [x, y, z] = self.grains;
        let along = |axis: usize, k: usize, i: usize| {
            let moved = ([0.37, 0.53, 0.71][axis] * i as f64).fract();
            let length = if axis == 2 { self.diameter_m * z as f64 } else { self.edges_m[axis] };
            let step = (length - self.diameter_m) / self.grains[axis] as f64;
            0.5 * self.diameter_m + step * (k as f64 + moved)
        };
        let one = |i: usize| {
            let at = [i % x, i / x % y, i / (x * y)];
            [along(0, at[0], i), along(1, at[1], i), along(2, at[2], i), 0.5 * self.diameter_m]
        };
        (0..x * y * z).map(one).collect()
    }

    /// Times of the exchanges [s], ascending.
    fn times(&self) -> Result<Vec<f64>, Box<dyn Error>> {
        let domain =
            Domain::new(Vector3::zeros(), Vector3::from(self.edges_m), [[Boundary::Grounded; 2]; 3])?;
        let mesh = FarMesh::new(FarMeshParts::of_box(&domain, self.cells)?)?;
        let shapes = CellShapes::of_planes(&mesh)?;
        let flow = GasFlow {
            model: GasModel::A,
            interval_s: 1e-4,
            smoothing_length_m: None,
            viscous_force: false,
            saffman_lift: false,
            overlap: false,
        };
        let gas = Gas {
            drag: DragLaw::Gidaspow,
            density_kg_m3: 1.2,
            viscosity_pa_s: 1.8e-5,
            velocity_m_s: Vector3::zeros(),
            magnus_lift: false,
            flow: Some(flow),
        };
        let solver = Box::new(Even { mesh, shapes });
        let mut exchange = Exchange::new(gas, flow, Vector3::zeros(), solver, self.diameter_m)?;
        let centre = self.grains();
        let velocity = vec![Vector3::zeros(); centre.len()];
        let inverse_mass = vec![1e3; centre.len()];
        let view =
            GrainsView { centre: &centre, velocity: &velocity, angular: &[], inverse_mass: &inverse_mass };
        let mut times = Vec::new();
        for k in 0..EXCHANGES {
            let before = exchange.seconds().mapping;
            exchange.exchange(&domain, &view, flow.interval_s, flow.interval_s * k as f64)?;
            exchange.add_forces(&velocity, flow.interval_s, &mut vec![Vector3::zeros(); centre.len()]);
            times.push(exchange.seconds().mapping - before);
        }
        times.sort_by(f64::total_cmp);
        Ok(times)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    for bed in BEDS {
        let times = bed.times()?;
        let [least, median] = [times[0], times[EXCHANGES / 2]].map(|seconds| 1e3 * seconds);
        let [grains, cells] = [bed.grains, bed.cells].map(|counts| counts.iter().product::<usize>());
        println!(
            "{}: {grains} grains, {cells} cells, {least:.1} ms an exchange, median {median:.1}",
            bed.name
        );
    }
    Ok(())
}
