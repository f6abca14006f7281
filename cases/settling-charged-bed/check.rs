//! Case of a bed of charged grains that settles between grounded plates.

use crate::support::{Case, Run, full_size};
use std::f64::consts::PI;

const RADIUS_M: f64 = 1e-4;
/// Volume fraction of a loose random packing, with room for a bed that is a few grains wide and whose charges
/// hold it open.
const LOOSE: f64 = 0.52;
/// Volume fraction of a dense random packing.
const DENSE: f64 = 0.66;
/// Speed of a grain that has fallen by its own radius [m/s]; a slower grain counts as at rest.
const SLOW_M_S: f64 = 0.04;

/// Width of the bed at smoke size [m].
pub(crate) const SMOKE_EDGE_M: f64 = 1.5e-3;

#[test]
fn bed_settles_to_a_random_packing() {
    let case = Case::new("settling-charged-bed");
    let mut edge = 6e-3;
    case.replace("scene.toml", "formats = [\"vtk\"]", "formats = [\"vtk\", \"csv\"]");
    if !full_size() {
        edge = SMOKE_EDGE_M;
        shrink(&case);
    }
    check_packing(&case.run(&[]), edge);
}

/// Changes the bed to one that is a quarter as wide and half as high.
pub(crate) fn shrink(case: &Case) {
    for (from, to) in [
        ("max_m = [0.006, 0.006, 0.01]", "max_m = [0.0015, 0.0015, 0.005]"),
        ("max_m = [0.006, 0.006, 0.0075]", "max_m = [0.0015, 0.0015, 0.0036]"),
        ("point_m = [0, 0, 0.01]", "point_m = [0, 0, 0.005]"),
        ("count = 20000", "count = 600"),
        ("end_s = 0.05", "end_s = 0.04"),
    ] {
        case.replace("scene.toml", from, to);
    }
}

/// Checks that the bed rests, is as dense as a random packing, and has lost no charge.
pub(crate) fn check_packing(run: &Run<'_>, edge: f64) {
    let grains = run.last_particles();
    let heights = grains.column("z_m");
    let count = heights.len() as f64;
    let volume = count * 4.0 / 3.0 * PI * RADIUS_M.powi(3);
    let mean_height = heights.iter().sum::<f64>() / count;
    let fraction = volume / (2.0 * edge * edge * mean_height);
    assert!((LOOSE..DENSE).contains(&fraction), "volume fraction {fraction}");
    let fastest = grains.column("vz_m_s").iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(fastest < SLOW_M_S, "{fastest} m/s");
    let net: f64 = grains.column("charge_C").iter().sum();
    assert!(net.abs() < 1e-24, "net charge {net} C");
}
