//! Case of the Madelung constant of rock salt in a periodic box.

use crate::support::{COULOMB, Case};
use amberfield_core::Vector3;
use amberfield_oracle::{ErrorNorms, MADELUNG_NACL, field_scale};

const CHARGE_C: f64 = 1e-12;
const SPACING_M: f64 = 1e-3;
const VOLUME_M3: f64 = 64e-9;
/// Error that the direct sum promises.
const DIRECT: f64 = 1e-9;
/// Tolerance of the scene, which is that of E.
const TOLERANCE: f64 = 1e-4;
/// Error of the potential. It has no tolerance of its own: its error is about that of E times the width of
/// the splitting, which is of the order of the distance of neighbours.
const POTENTIAL: f64 = 1e-3;

#[test]
fn direct_sum_gives_nine_digits_and_no_field() {
    check("direct", DIRECT, DIRECT);
}

#[test]
fn p3m_gives_it_within_its_tolerance() {
    check("p3m", TOLERANCE, POTENTIAL);
}

fn check(method: &str, field_tolerance: f64, potential_tolerance: f64) {
    let case = Case::new("madelung");
    let charges = case.table("ions.csv").column("charge_C").to_vec();
    let result = case.field(&["--method", method]);
    let unit = COULOMB * CHARGE_C / SPACING_M;
    for (charge, potential) in charges.iter().zip(result.column("potential_V")) {
        let madelung = -charge / CHARGE_C * potential / unit;
        assert!((madelung / MADELUNG_NACL - 1.0).abs() < potential_tolerance, "{method}: M = {madelung}");
    }
    let none = vec![Vector3::zeros(); charges.len()];
    let scale = field_scale(&none, &charges, VOLUME_M3, COULOMB);
    let norms = ErrorNorms::new(&result.field(), &none, scale);
    assert!(norms.relative_rms < field_tolerance, "{method}: {norms:?}");
}
