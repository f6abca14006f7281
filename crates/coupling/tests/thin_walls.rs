//! p3m over a mesh with sheets in it, against exact fields: what a wall hides is hidden, what it mirrors is
//! mirrored, and around its rim the field is a half plane's.

use amberfield_core::{Boundary, Domain, FieldSettings, Method, Permittivity, Tuning, Vector3};
use amberfield_coupling::BoxSolver;
use amberfield_field::far::{Condition, FarMeshParts};
use amberfield_field::{ElectricField, FieldValues, Wanted};
use amberfield_oracle::GroundedHalfPlane;

const EDGE: f64 = 0.01;
const RADIUS: f64 = 1e-4;
const CHARGE: f64 = 1e-12;
/// Cells along an edge: cells of 2.5 and 1.9 diameters.
const CELLS: [usize; 2] = [20, 26];
/// Error beside a sheet over the field of a grain that touches it (0.3 to 1.4 % seen).
const OWN_SIDE: f64 = 0.02;
/// Field behind a divider over that before it (0.05 to 0.6 % seen).
const SHIELDED: f64 = 0.01;
/// Error around a rim over the field of a grain that touches a plane (0.1 to 1.1 % seen; 2.1 % at one probe
/// that is half a cell from another rim cell).
const AT_RIM: f64 = 0.025;

fn settings() -> FieldSettings {
    FieldSettings { tolerance: 5e-3, tuning: Tuning::Model, ..FieldSettings::default() }
}

/// E in a grounded cube with a sheet of a condition where `is_sheet` holds of a face's centre.
fn over_sheet(
    cells: usize,
    is_sheet: impl Fn(&Vector3<f64>) -> bool,
    condition: Condition,
    positions: &[Vector3<f64>],
    charges: &[f64],
) -> Vec<Vector3<f64>> {
    let faces = [[Boundary::Grounded; 2]; 3];
    let domain = Domain::new(Vector3::zeros(), Vector3::repeat(EDGE), faces).expect("a good box");
    let parts = FarMeshParts::of_box(&domain, [cells; 3]).expect("a good box");
    let solver = BoxSolver::over(parts.with_sheet(is_sheet, condition)).expect("a good mesh");
    let mut values = FieldValues::default();
    ElectricField::over_mesh(Box::new(solver), &settings(), positions, charges)
        .expect("a good scene")
        .evaluate(positions, charges, Wanted::default(), &mut values)
        .expect("finite values");
    values.e
}

fn is_in_the_middle(x: &Vector3<f64>) -> bool {
    (x.x - 0.5 * EDGE).abs() < 1e-9
}

#[test]
fn divider_hides_one_half_from_the_other_and_mirrors_each() {
    let insulating = Boundary::Insulating { normal_field_v_m: 0.0 };
    let kinds = [(Boundary::Grounded, Condition::Potential(0.0)), (insulating, Condition::Slope(0.0))];
    for (face, condition) in kinds {
        let y = 0.5 * EDGE + 0.1 * RADIUS;
        let at = |x: f64, y: f64| Vector3::new(0.5 * EDGE + RADIUS * x, y, 0.45 * EDGE);
        let own = [at(-1.0, y), at(-1.0, y + 2.2 * RADIUS), at(-5.0, y)];
        let behind = [at(1.0, y), at(5.0, y), at(1.0, y + 3.0 * RADIUS), at(20.0, y)];
        let positions = [&own[..], &behind].concat();
        let mut charges = vec![0.0; positions.len()];
        charges[0] = CHARGE;

        let (min, max) = (Vector3::zeros(), Vector3::new(0.5 * EDGE, EDGE, EDGE));
        let sides = [[Boundary::Grounded, face], [Boundary::Grounded; 2], [Boundary::Grounded; 2]];
        let half = Domain::new(min, max, sides).expect("a good box");
        let direct = FieldSettings { method: Method::Direct, ..settings() };
        let mut exact = FieldValues::default();
        ElectricField::new(&half, &direct, &own, &charges[..own.len()])
            .expect("a good scene")
            .evaluate(&own, &charges[..own.len()], Wanted::default(), &mut exact)
            .expect("finite values");

        let scale = Permittivity::VACUUM.coulomb() * CHARGE / (4.0 * RADIUS * RADIUS);
        for cells in CELLS {
            let e = over_sheet(cells, is_in_the_middle, condition, &positions, &charges);
            for (e, exact) in e.iter().zip(&exact.e) {
                let error = (e - exact).norm() / scale;
                assert!(error < OWN_SIDE, "{face:?}, {cells} cells: {error}");
            }
            for e in &e[own.len()..] {
                let share = e.norm() / scale;
                assert!(share < SHIELDED, "{face:?}, {cells} cells: {share}");
            }
        }
    }
}

#[test]
fn field_around_a_rim_is_that_of_a_half_plane() {
    let coulomb = Permittivity::VACUUM.coulomb();
    // In radii: into the sheet from its rim, and above it.
    let places = [[1.0, 1.0], [3.0, 1.2], [-1.0, 0.7], [-3.0, 1.0]];
    for ([into, above], cells) in places.into_iter().zip(CELLS.into_iter().cycle()) {
        let from_rim = Vector3::new(above, 0.0, -into) * RADIUS;
        let charge = Vector3::new(0.5 * EDGE, 0.45 * EDGE, 0.5 * EDGE) + from_rim;
        let beside = [[3.0, 2.0, 0.0], [-above - 4.0, 0.0, 0.0], [2.0, 1.0, 3.0], [-12.0, 0.0, 2.5]];
        let mut positions = vec![charge];
        positions.extend(beside.map(|beside| charge + RADIUS * Vector3::from(beside)));
        let mut charges = vec![0.0; positions.len()];
        charges[0] = CHARGE;

        let rim = Vector3::new(0.5 * EDGE, 0.0, 0.5 * EDGE);
        let half = GroundedHalfPlane { charge: coulomb * CHARGE, at: charge - rim };
        let scale = coulomb * CHARGE / (4.0 * RADIUS * RADIUS);
        let is_sheet = |x: &Vector3<f64>| is_in_the_middle(x) && x.z < 0.5 * EDGE;
        let e = over_sheet(cells, is_sheet, Condition::Potential(0.0), &positions, &charges);
        for (x, e) in positions.iter().zip(&e) {
            let error = (e - half.field(&(x - rim))).norm() / scale;
            assert!(error < AT_RIM, "{into} {above}, {cells} cells, at {x}: {error}");
        }
    }
}
