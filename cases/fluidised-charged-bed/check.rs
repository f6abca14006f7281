//! Case of a bubbling bed: the effect of charge on its height and its walls.

use crate::support::{Case, Curve, NumberTable, full_size, plot};

/// Radius of the grains [m].
const RADIUS_M: f64 = 5e-4;
/// Weight of a grain [N].
const WEIGHT_N: f64 = 1500.0 * 4.0 / 3.0 * std::f64::consts::PI * RADIUS_M * RADIUS_M * RADIUS_M * 9.81;
/// Distance from a wall over the radius, below which a grain counts as touching.
const TOUCHING: f64 = 1.1;

/// Size of the bed.
struct BedSize {
    /// Edges across the flow [m].
    edges_m: [f64; 2],
    /// Number of grains.
    grains: f64,
    /// Time from which on the bed bubbles [s].
    from_s: f64,
    /// Charges of a grain in the three runs [C].
    charges_c: [f64; 3],
}

/// Sets the size of the bed: the whole bed, or an eighth of it.
fn bed(case: &Case) -> BedSize {
    case.replace("scene.toml", "formats = [\"vtk\", \"png\"]", "formats = [\"csv\"]");
    if full_size() {
        return BedSize {
            edges_m: [0.04, 0.01],
            grains: 12_000.0,
            from_s: 0.2,
            charges_c: [0.0, 2e-12, 4e-12],
        };
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
    BedSize { edges_m: [0.02, 0.005], grains: 1500.0, from_s: 0.1, charges_c: [0.0, 4e-12, 8e-12] }
}

/// Mean height of the grains over time.
struct MeanHeight {
    /// Mean over the time in which the bed bubbles [mm].
    mean: f64,
    /// Standard deviation over that time [mm].
    spread: f64,
    /// Times [s] and heights [mm].
    curve: Vec<(f64, f64)>,
}

/// Mean height of the grains, from their potential energy.
fn height(history: &NumberTable, bed: &BedSize) -> MeanHeight {
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
    MeanHeight { mean, spread, curve }
}

/// Share of the grains that touch a grounded wall.
fn at_walls(grains: &NumberTable, bed: &BedSize) -> f64 {
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
        let MeanHeight { mean, spread, curve } = height(&run.history(), &bed);
        let late: Vec<f64> = run
            .frames()
            .iter()
            .filter(|frame| frame.time_s >= bed.from_s)
            .map(|frame| at_walls(&frame.grains, &bed))
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
