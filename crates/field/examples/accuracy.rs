//! The accuracy table of the README: the measured error of every method on every reference set.
//!
//! `cargo run --release -p amberfield-field --example accuracy` prints it as Markdown. Errors are exact:
//! the sets' fields are known to 1e-9. Parameters come from the cost model, so that the table is the same
//! everywhere.
#![expect(clippy::print_stdout, reason = "prints its table")]

use amberfield_core::{FieldSettings, Method, Permittivity, Tuning};
use amberfield_field::{ElectricField, FieldError, FieldValues, Wanted};
use amberfield_oracle::ErrorNorms;
use amberfield_oracle::reference::{self, ReferenceSet};

const TOLERANCES: [f64; 6] = [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6];
/// Cut-off radius of the comparison methods: five grain diameters, a usual choice; the sets' grains have
/// 0.04.
const CUTOFF: f64 = 5.0 * 0.04;

/// Relative RMS error of E over all particles of a set.
fn error(set: &ReferenceSet, settings: &FieldSettings) -> Result<f64, FieldError> {
    let mut field = ElectricField::new(&set.domain, settings, &set.position, &set.charge)?;
    let mut values = FieldValues::default();
    field.evaluate(&set.position, &set.charge, Wanted::default(), &mut values)?;
    let k = Permittivity::VACUUM.coulomb();
    Ok(ErrorNorms::new(&values.e, &set.field_si(k), set.scale() * k).relative_rms)
}

fn cell(error: Result<f64, FieldError>) -> String {
    error.map_or_else(|refused| refused.to_string(), |error| format!("{error:.1e}"))
}

fn main() {
    println!("| set | 1e-1 | 1e-2 | 1e-3 | 1e-4 | 1e-5 | 1e-6 | `kolehmainen` | `cutoff` | `direct` |");
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for set in reference::all().into_iter().filter(|set| !set.name.contains("nacl")) {
        let p3m = TOLERANCES.map(|tolerance| FieldSettings {
            tolerance,
            tuning: Tuning::Model,
            ..FieldSettings::default()
        });
        let others = [Method::Kolehmainen, Method::Cutoff, Method::Direct].map(|method| FieldSettings {
            method,
            cutoff_radius_m: (method != Method::Direct).then_some(CUTOFF),
            ..FieldSettings::default()
        });
        let cells: Vec<String> =
            p3m.iter().chain(&others).map(|settings| cell(error(&set, settings))).collect();
        println!("| {} | {} |", set.name, cells.join(" | "));
    }
}
