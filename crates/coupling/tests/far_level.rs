//! p3m with its far level on a coarse mesh, against the direct sum.

use amberfield_core::{Axis, Boundary, Domain, FieldSettings, Method, Tuning, Vector3};
use amberfield_coupling::BoxSolver;
use amberfield_field::{ElectricField, FieldValues, Wanted};
use rand::{RngExt as _, SeedableRng as _};

/// Tolerance of near level and middle grid: they leave little to be seen beside the mesh's own error.
const TOLERANCE: f64 = 2e-3;
/// RMS error of E of grains of both signs: finite volumes and interpolation on a mesh of cells as large as
/// some five grains across (0.2 to 0.3 % seen).
const BOTH_SIGNS: f64 = 5e-3;
/// RMS error of E of grains of one sign, whose field is smooth and large: walls in steps of a cell (0.5 to
/// 0.8 % seen).
const ONE_SIGN: f64 = 1e-2;
/// RMS error of the potential, relative to its RMS.
const POTENTIAL: f64 = 3e-2;

/// Grains at random, none closer than a diameter, a fifth of the volume.
fn grains(domain: &Domain, count: usize) -> Vec<Vector3<f64>> {
    let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let radius = (0.15 / std::f64::consts::PI * domain.volume() / count as f64).cbrt();
    let mut positions: Vec<Vector3<f64>> = Vec::new();
    while positions.len() < count {
        let within = |axis: usize| radius..domain.extent()[axis] - radius;
        let x = domain.min() + Vector3::from_fn(|axis, _| random.random_range(within(axis)));
        let apart = |y: &Vector3<f64>| {
            let mut d: Vector3<f64> = x - y;
            for axis in Axis::ALL.into_iter().filter(|&axis| domain.is_periodic(axis)) {
                let length = domain.extent()[axis.index()];
                d[axis.index()] -= length * (d[axis.index()] / length).round();
            }
            d.norm() > 2.0 * radius
        };
        if positions.iter().all(apart) {
            positions.push(x);
        }
    }
    positions
}

/// Errors of E and of the potential over their RMS.
fn errors(faces: [[Boundary; 2]; 3], one_sign: bool) -> (f64, f64) {
    let domain =
        Domain::new(Vector3::zeros(), Vector3::new(0.012, 0.012, 0.01), faces).expect("a good scene");
    let positions = grains(&domain, 3000);
    let charges: Vec<f64> =
        (0..positions.len()).map(|i| if one_sign || i % 2 == 0 { 1e-12 } else { -1e-12 }).collect();
    let settings = FieldSettings { tolerance: TOLERANCE, tuning: Tuning::Model, ..FieldSettings::default() };
    let wanted = Wanted { potential: true, components: true };
    let solver = BoxSolver::new(&domain, [12, 12, 10]).expect("a good scene");
    let (mut ours, mut direct) = (FieldValues::default(), FieldValues::default());
    ElectricField::over_mesh(Box::new(solver), &settings, &positions, &charges)
        .expect("a good scene")
        .evaluate(&positions, &charges, wanted, &mut ours)
        .expect("a good scene");
    let settings = FieldSettings { method: Method::Direct, ..settings };
    ElectricField::new(&domain, &settings, &positions, &charges)
        .expect("a good scene")
        .evaluate(&positions, &charges, wanted, &mut direct)
        .expect("a good scene");
    for (particle, e) in ours.e.iter().enumerate() {
        let parts = &ours.components;
        let sum = parts.near[particle]
            + parts.middle[particle]
            + parts.far[particle]
            + parts.correction[particle]
            + parts.faces[particle]
            + parts.external[particle];
        assert!((sum - e).norm() < 1e-12 * e.norm());
    }
    let over = |difference: f64, of: f64| (difference / of).sqrt();
    let e = ours.e.iter().zip(&direct.e);
    let v = ours.potential.iter().zip(&direct.potential);
    (
        over(e.map(|(a, b)| (a - b).norm_squared()).sum(), direct.e.iter().map(|e| e.norm_squared()).sum()),
        over(v.map(|(a, b)| (a - b).powi(2)).sum(), direct.potential.iter().map(|v| v * v).sum()),
    )
}

fn check(faces: [[Boundary; 2]; 3], one_sign: bool, most: f64) {
    let (e, potential) = errors(faces, one_sign);
    assert!(e < most && potential < POTENTIAL, "{e:.3e} {potential:.3e}");
}

const INSULATING: Boundary = Boundary::Insulating { normal_field_v_m: 0.0 };
const MIXED: [[Boundary; 2]; 3] =
    [[Boundary::Periodic; 2], [INSULATING; 2], [Boundary::Grounded, Boundary::Potential(200.0)]];

/// The published hybrid over a mesh is the one on the internal grid: the same operator, the same gradient.
#[test]
fn kolehmainen_is_the_same_over_a_mesh_and_on_the_internal_grid() {
    let domain =
        Domain::new(Vector3::zeros(), Vector3::new(0.012, 0.012, 0.01), MIXED).expect("a good scene");
    let positions = grains(&domain, 500);
    let charges: Vec<f64> = (0..500).map(|i| if i % 3 == 0 { 1e-12 } else { -1e-12 }).collect();
    let settings = FieldSettings {
        method: Method::Kolehmainen,
        cutoff_radius_m: Some(2e-3),
        grid_cells: Some([12, 12, 10]),
        ..FieldSettings::default()
    };
    let solver = Box::new(BoxSolver::new(&domain, [12, 12, 10]).expect("a good scene"));
    let wanted = Wanted { potential: true, components: true };
    let (mut over, mut on) = (FieldValues::default(), FieldValues::default());
    let mut field = ElectricField::over_mesh(solver, &settings, &positions, &charges).expect("a good scene");
    field.evaluate(&positions, &charges, wanted, &mut over).expect("a good scene");
    assert_eq!(
        field.far_solver().map_or(0, |solver| solver.state().potential().len()),
        1440,
        "the solver's state belongs in a checkpoint"
    );
    let mut field = ElectricField::new(&domain, &settings, &positions, &charges).expect("a good scene");
    field.evaluate(&positions, &charges, wanted, &mut on).expect("a good scene");
    let scale = on.e.iter().map(Vector3::norm).fold(0.0, f64::max);
    for (a, b) in over.e.iter().zip(&on.e) {
        assert!((a - b).norm() < 1e-7 * scale, "{a} {b}");
    }
}

#[test]
fn both_signs_in_a_grounded_box() {
    check([[Boundary::Grounded; 2]; 3], false, BOTH_SIGNS);
}

#[test]
fn one_sign_in_a_grounded_box() {
    check([[Boundary::Grounded; 2]; 3], true, ONE_SIGN);
}

#[test]
fn both_signs_in_a_periodic_box() {
    check([[Boundary::Periodic; 2]; 3], false, BOTH_SIGNS);
}

#[test]
fn both_signs_between_an_electrode_and_a_grounded_wall() {
    check(MIXED, false, BOTH_SIGNS);
}

#[test]
fn one_sign_between_an_electrode_and_a_grounded_wall() {
    check(MIXED, true, ONE_SIGN);
}
