//! Case of a bed of charged grains that settles, with its far field from OpenFOAM.

use crate::settling_charged_bed::{SMOKE_EDGE_M, check_packing, shrink};
use crate::support::{Case, full_size};

/// Relative difference of two fields with tolerances of 1e-2, whose squares add.
const AGREEMENT: f64 = 1.4e-2;

#[test]
fn bed_settles_as_on_the_internal_grid() {
    let case = Case::new("coupled-settling-bed");
    let mut edge = 6e-3;
    if !full_size() {
        edge = SMOKE_EDGE_M;
        shrink(&case);
        let mesh = "foam/system/blockMeshDict";
        for (from, to) in [
            ("(0 0 0) (6 0 0) (6 6 0) (0 6 0)", "(0 0 0) (1.5 0 0) (1.5 1.5 0) (0 1.5 0)"),
            ("(0 0 10) (6 0 10) (6 6 10) (0 6 10)", "(0 0 5) (1.5 0 5) (1.5 1.5 5) (0 1.5 5)"),
            ("(12 12 20)", "(5 5 16)"),
        ] {
            case.replace(mesh, from, to);
        }
    }
    let e = |table: crate::support::NumberTable| {
        ["ex_V_per_m", "ey_V_per_m", "ez_V_per_m"].map(|column| table.column(column).to_vec())
    };
    let coupled = e(case.field(&[]));
    case.replace("scene.toml", "formats = [\"vtk\"]", "formats = [\"vtk\", \"csv\"]");
    check_packing(&case.run(&[]), edge);
    case.replace("scene.toml", "[solver]\nopenfoam_case = \"foam\"\n", "");
    let internal = e(case.field(&[]));
    let (mut difference, mut size) = (0.0_f64, 0.0);
    for (a, b) in coupled.concat().iter().zip(&internal.concat()) {
        difference += (a - b).powi(2);
        size += b * b;
    }
    assert!((difference / size).sqrt() < AGREEMENT, "{}", (difference / size).sqrt());
}
