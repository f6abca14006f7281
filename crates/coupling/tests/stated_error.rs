//! The error that a field over a mesh states, against the truth; and few grains on fine cells.
#![expect(clippy::print_stdout, reason = "how good it is, for whoever asks with --nocapture")]

use amberfield_core::{Boundary, Domain, FieldSettings, Method, Tuning, Vector3};
use amberfield_coupling::BoxSolver;
use amberfield_field::{ElectricField, FieldValues, Wanted};
use rand::{RngExt as _, SeedableRng as _};

const EDGE: f64 = 0.01;
/// Stated over true error, at least and at most, in nine of ten scenes; and at least in all.
const MOSTLY: [f64; 2] = [0.5, 2.0];
const NEVER_BELOW: f64 = 1.0 / 3.0;
const INSULATING: Boundary = Boundary::Insulating { normal_field_v_m: 0.0 };
const GROUNDED: [[Boundary; 2]; 3] = [[Boundary::Grounded; 2]; 3];
const MIXED: [[Boundary; 2]; 3] =
    [[Boundary::Periodic; 2], [INSULATING; 2], [Boundary::Grounded, Boundary::Potential(200.0)]];
const CORNERED: [[Boundary; 2]; 3] =
    [[Boundary::Grounded; 2], [INSULATING; 2], [Boundary::Grounded, INSULATING]];

/// A scene in a cube.
struct Scene {
    grains: usize,
    cells: usize,
    one_sign: bool,
    tolerance: f64,
    faces: [[Boundary; 2]; 3],
}

/// True and stated error of E, relative.
struct Errors {
    truth: f64,
    stated: f64,
}

impl Scene {
    fn errors(&self) -> Errors {
        let domain = Domain::new(Vector3::zeros(), Vector3::repeat(EDGE), self.faces).expect("a good box");
        let mut random = rand_chacha::ChaCha8Rng::seed_from_u64(7);
        let radius = 0.4 * EDGE / 3000.0_f64.cbrt();
        let mut positions: Vec<Vector3<f64>> = Vec::new();
        while positions.len() < self.grains {
            let x = Vector3::from_fn(|_, _| random.random_range(radius..EDGE - radius));
            if positions.iter().all(|y| (x - y).norm() > 2.0 * radius) {
                positions.push(x);
            }
        }
        let sign = |grain: usize| if self.one_sign || grain.is_multiple_of(2) { 1e-12 } else { -1e-12 };
        let charges: Vec<f64> = (0..self.grains).map(sign).collect();
        let tolerance = self.tolerance;
        let settings = FieldSettings { tolerance, tuning: Tuning::Model, ..FieldSettings::default() };
        let solver = Box::new(BoxSolver::new(&domain, [self.cells; 3]).expect("a good box"));
        let (mut ours, mut exact) = (FieldValues::default(), FieldValues::default());
        let mut field =
            ElectricField::over_mesh(solver, &settings, &positions, &charges).expect("a good scene");
        field.evaluate(&positions, &charges, Wanted::default(), &mut ours).expect("finite");
        let direct = FieldSettings { method: Method::Direct, ..settings };
        ElectricField::new(&domain, &direct, &positions, &charges)
            .expect("a good scene")
            .evaluate(&positions, &charges, Wanted::default(), &mut exact)
            .expect("finite");
        let squares: f64 = ours.e.iter().zip(&exact.e).map(|(a, b)| (a - b).norm_squared()).sum();
        let all: f64 = exact.e.iter().map(|e| e.norm_squared()).sum();
        let stated = field.error_measured().expect("grains are charged").relative_rms;
        let errors = Errors { truth: (squares / all).sqrt(), stated };
        println!(
            "{} grains, {} cells, one sign {}, tolerance {tolerance:e}: {:.2e}, stated {stated:.2e}",
            self.grains, self.cells, self.one_sign, errors.truth
        );
        errors
    }
}

#[test]
fn stated_error_is_the_error() {
    let scene =
        |grains, cells, one_sign, tolerance, faces| Scene { grains, cells, one_sign, tolerance, faces };
    let scenes = [
        scene(10, 20, false, 1e-2, GROUNDED),
        scene(10, 20, true, 1e-2, GROUNDED),
        scene(50, 10, false, 1e-2, GROUNDED),
        scene(50, 20, false, 1e-3, GROUNDED),
        scene(500, 12, false, 1e-2, GROUNDED),
        scene(500, 16, true, 1e-2, MIXED),
        scene(2000, 12, false, 1e-2, GROUNDED),
        scene(2000, 12, true, 1e-2, GROUNDED),
        scene(2000, 16, true, 1e-2, GROUNDED),
        scene(2000, 12, true, 2e-3, CORNERED),
    ];
    let ratios = scenes.map(|scene| {
        let Errors { truth, stated } = scene.errors();
        stated / truth
    });
    let off = ratios.iter().filter(|ratio| !(MOSTLY[0]..=MOSTLY[1]).contains(*ratio)).count();
    assert!(off <= 1 && ratios.iter().all(|ratio| *ratio > NEVER_BELOW), "{ratios:?}");
}

/// Each grain's part in the mesh is larger beside the others' fields, the finer the cells are.
#[test]
fn few_grains_on_fine_cells_err_within_the_tolerance_that_was_asked() {
    for (cells, tolerance) in [(8, 1e-2), (16, 1e-2), (28, 1e-2), (28, 3e-3)] {
        let scene = Scene { grains: 50, cells, one_sign: false, tolerance, faces: GROUNDED };
        let Errors { truth, .. } = scene.errors();
        assert!(truth <= tolerance, "{cells} cells, {tolerance:e}: {truth:e}");
    }
}
