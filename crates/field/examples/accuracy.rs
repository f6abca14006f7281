//! The accuracy table of the README: every method on every reference set, error first, then time.
//!
//! `cargo run --release -p amberfield-field --example accuracy` prints Markdown. Errors are exact: the sets'
//! fields are known to 1e-9. Times are medians over repeated evaluations on this machine, all threads.
#![expect(clippy::print_stdout, reason = "prints its table")]

use amberfield_core::constants::coulomb_constant;
use amberfield_core::{FieldSettings, Method};
use amberfield_field::{ElectricField, FieldError, FieldValues, Wanted};
use amberfield_oracle::ErrorNorms;
use amberfield_oracle::reference::{self, ReferenceSet};
use std::time::Instant;

const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// Cut-off radius of the comparison methods, in grain diameters of the sets (0.04): a usual choice.
const CUTOFF: f64 = 5.0 * 0.04;
const REPEATS: usize = 9;

struct Row {
    norms: ErrorNorms,
    microseconds_per_grain: f64,
    pairs_per_particle: f64,
}

fn measure(set: &ReferenceSet, settings: &FieldSettings) -> Result<Row, FieldError> {
    let mut field = ElectricField::new(&set.domain, settings, &set.position, &set.charge)?;
    let mut values = FieldValues::default();
    let mut seconds = Vec::new();
    for _ in 0..REPEATS {
        let start = Instant::now();
        field.evaluate(&set.position, &set.charge, Wanted::default(), &mut values)?;
        seconds.push(start.elapsed().as_secs_f64());
    }
    seconds.sort_by(f64::total_cmp);
    let k = coulomb_constant(1.0);
    Ok(Row {
        norms: ErrorNorms::new(&values.e, &set.field_si(k), set.scale() * k),
        microseconds_per_grain: seconds[REPEATS / 2] * 1e6 / set.charge.len() as f64,
        pairs_per_particle: field.statistics().pairs_per_particle,
    })
}

fn print(set: &str, asked: &str, row: Result<Row, FieldError>) {
    match row {
        Ok(row) => println!(
            "| {set} | {asked} | {:.1e} | {:.1e} | {:.1e} | {:.0} | {:.2} |",
            row.norms.relative_rms,
            row.norms.p99,
            row.norms.worst,
            row.pairs_per_particle,
            row.microseconds_per_grain
        ),
        Err(error) => println!("| {set} | {asked} | refused: {error} | | | | |"),
    }
}

fn main() {
    println!("| set | method | RMS error | p99 | worst | pairs | µs/grain |");
    println!("|---|---|---|---|---|---|---|");
    for set in reference::all() {
        for tolerance in TOLERANCES {
            let settings = FieldSettings { tolerance, ..FieldSettings::default() };
            print(set.name, &format!("p3m, tolerance {tolerance:e}"), measure(&set, &settings));
        }
        for method in [Method::Kolehmainen, Method::Cutoff, Method::Direct] {
            let cutoff_radius_m = (method != Method::Direct).then_some(CUTOFF * set.domain.extent().x);
            let settings = FieldSettings { method, cutoff_radius_m, ..FieldSettings::default() };
            print(set.name, method.name(), measure(&set, &settings));
        }
    }
}
