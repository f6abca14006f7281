//! Time that an exchange takes beside the flow's: grains found in cells and their shares summed, the flow
//! taken to grains, drag. The beds are like those of `cases/goldschmidt` and `cases/fluidised-charged-bed`.
//!
//! ```text
//! cargo run --release -p amberfield-gas --example mapping
//! ```

#![expect(clippy::print_stdout, reason = "its purpose")]

#[path = "../tests/common/mod.rs"]
mod common;

use amberfield_core::{Boundary, Domain, DragLaw, Vector3};
use amberfield_gas::{Exchange, GrainsView};
use common::{ByRule, air, scattered};
use std::error::Error;

/// Exchanges, of which the fastest and the median are told.
const EXCHANGES: usize = 40;
/// Time between them [s].
const INTERVAL_S: f64 = 1e-4;

/// Bed of grains at the bottom of a box of cells.
struct Bed {
    name: &'static str,
    edges_m: [f64; 3],
    cells: [usize; 3],
    diameter_m: f64,
    /// Grains along each axis, from the bottom.
    grains: [usize; 3],
}

impl Bed {
    const fn new(
        name: &'static str,
        edges_m: [f64; 3],
        cells: [usize; 3],
        diameter_m: f64,
        grains: [usize; 3],
    ) -> Self {
        Self { name, edges_m, cells, diameter_m, grains }
    }

    /// Times of the exchanges [s], ascending.
    fn times(&self) -> Result<Vec<f64>, Box<dyn Error>> {
        let domain =
            Domain::new(Vector3::zeros(), Vector3::from(self.edges_m), [[Boundary::Grounded; 2]; 3])?;
        let (gas, flow) = air(DragLaw::Gidaspow);
        let solver = ByRule::boxed(&domain, self.cells, |_, volumes| vec![Vector3::z(); volumes.len()]);
        let mut exchange = Exchange::new(gas, flow, Vector3::zeros(), solver, self.diameter_m)?;
        let [x, y, _] = self.edges_m;
        let height = self.diameter_m * self.grains[2] as f64;
        let centre = scattered(self.grains, [x, y, height], 0.5 * self.diameter_m);
        let velocity = vec![Vector3::zeros(); centre.len()];
        let inverse_mass = vec![1e3; centre.len()];
        let view =
            GrainsView { centre: &centre, velocity: &velocity, angular: &[], inverse_mass: &inverse_mass };
        let mut times = Vec::new();
        for k in 0..EXCHANGES {
            let before = exchange.seconds().mapping;
            exchange.exchange(&domain, &view, INTERVAL_S, INTERVAL_S * k as f64)?;
            exchange.add_forces(&velocity, INTERVAL_S, &mut vec![Vector3::zeros(); centre.len()]);
            times.push(exchange.seconds().mapping - before);
        }
        times.sort_by(f64::total_cmp);
        Ok(times)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let beds = [
        Bed::new("goldschmidt", [0.015, 0.15, 0.45], [2, 30, 90], 2.5e-3, [6, 60, 69]),
        Bed::new("fluidised-charged-bed", [0.04, 0.01, 0.12], [20, 5, 60], 1e-3, [38, 9, 35]),
    ];
    for bed in beds {
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
