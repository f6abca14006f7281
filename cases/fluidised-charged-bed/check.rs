//! What charge does to a bubbling bed.

use crate::support::{Case, Curve, Table, full_size, plot};

/// Radius of the grains [m], their weight [N], and gaps over the radius at which they touch a wall.
const RADIUS_M: f64 = 5e-4;
const WEIGHT_N: f64 = 1500.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS_M * RADIUS_M * RADIUS_M * 9.81;
const TOUCHING: f64 = 1.1;

/// The bed, or an eighth of it.
struct Bed {
    edges_m: [f64; 2],
    grains: f64,
    /// From when on it bubbles [s].
    from_s: f64,
    charges_c: [f64; 3],
}

fn bed(case: &Case) -> Bed {
    case.replace("scene.toml", "formats = [\"vtk\", \"png\"]", "formats = [\"csv\"]");
    if full_size() {
        return Bed { edges_m: [0.04, 0.01], grains: 12_000.0, from_s: 0.2, charges_c: [0.0, 2e-12, 4e-12] };
    }
    for (from, to) in [
        ("max_m = [0.04, 0.01, 0.12]", "max_m = [0.02, 0.005, 0.06]"),
        ("max_m = [0.04, 0.01, 0.045]", "max_m = [0.02, 0.005, 0.0225]"),
        ("point_m = [0.04, 0, 0]", "point_m = [0.02, 0, 0]"),
        ("point_m = [0, 0.01, 0]", "point_m = [0, 0.005, 0]"),
        ("point_m = [0, 0, 0.12]", "point_m = [0, 0, 0.06]"),
        ("count = 12000", "count = 1500"),
        ("end_s = 1.0", "end_s = 0.3"),
    ] {
        case.replace("scene.toml", from, to);
    }
    for (from, to) in [("convertToMeters 1e-3", "convertToMeters 5e-4"), ("(16 4 48)", "(8 2 24)")] {
        case.replace("foam/system/blockMeshDict", from, to);
    }
    Bed { edges_m: [0.02, 0.005], grains: 1500.0, from_s: 0.1, charges_c: [0.0, 4e-12, 8e-12] }
}

/// Mean and standard deviation of the mean height [mm], from the time on that it bubbles.
fn height(history: &Table, bed: &Bed) -> (f64, f64, Vec<(f64, f64)>) {
    let to_mm = 1e3 / (bed.grains * WEIGHT_N);
    let curve: Vec<_> = history
        .column("time_s")
        .iter()
        .zip(history.column("gravity_J"))
        .map(|(t, j)| (*t, j * to_mm))
        .collect();
    let late: Vec<f64> = curve.iter().filter(|(t, _)| *t >= bed.from_s).map(|(_, height)| *height).collect();
    let mean = late.iter().sum::<f64>() / late.len() as f64;
    let spread = (late.iter().map(|height| (height - mean).powi(2)).sum::<f64>() / late.len() as f64).sqrt();
    (mean, spread, curve)
}

/// Share of the grains that touch a grounded wall.
fn at_walls(grains: &Table, bed: &Bed) -> f64 {
    let near = |x: f64, edge: f64| x.min(edge - x) < TOUCHING * RADIUS_M;
    let places = grains.column("x_m").iter().zip(grains.column("y_m"));
    let touching = places.filter(|(x, y)| near(**x, bed.edges_m[0]) || near(**y, bed.edges_m[1])).count();
    touching as f64 / bed.grains
}

#[test]
fn charge_calms_a_bubbling_bed_and_coats_its_walls() {
    let case = Case::new("fluidised-charged-bed");
    let bed = bed(&case);
    let (mut spreads, mut shares, mut curves) = (Vec::new(), Vec::new(), Vec::new());
    for charge in bed.charges_c {
        let set = format!("particles.generate.charge_C={{ constant = {charge:e} }}");
        let run = case.run(&["--overwrite", "--set", &set]);
        let (mean, spread, curve) = height(&run.history(), &bed);
        let late: Vec<f64> = run
            .frames()
            .iter()
            .filter(|(t, _)| *t >= bed.from_s)
            .map(|(_, grains)| at_walls(grains, &bed))
            .collect();
        let share = late.iter().sum::<f64>() / late.len() as f64;
        println!(
            "{charge:e} C: mean height {mean:.2} mm, fluctuation {spread:.2} mm, {:.1} % at walls",
            100.0 * share
        );
        spreads.push(spread);
        shares.push(share);
        curves.push(Curve { name: format!("{:.0} pC", 1e12 * charge), points: curve });
    }
    plot("fluidised-charged-bed", "height", ["t [s]", "mean height [mm]"], false, curves);
    assert!(spreads[2] < 0.6 * spreads[0], "{spreads:?}");
    assert!(shares[2] > 1.1 * shares[0], "{shares:?}");
}
